#include "rigel/problems/io/message_groups.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace rigel {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

TEST(MessageGroups, EqualMessagesAreOneLineWithACount) {
  const std::vector<std::string> files = {"d/0.matches", "d/1.matches", "d/2.matches",
                                          "d/3.matches"};
  EXPECT_THAT(GroupMessages({"d/0.matches: no axis; add one", "d/1.matches:7: U is 'x'",
                             "d/2.matches: no axis; add one", "d/3.matches: no axis; add one",
                             "d/3.matches:7: U is 'x'"},
                            files),
              ElementsAre("d/0.matches: no axis; add one (3 files alike)",
                          "d/1.matches:7: U is 'x'", "d/3.matches:7: U is 'x'"));
  EXPECT_THAT(GroupMessages({}, files), IsEmpty());
}

TEST(MessageGroups, ANameIsOneOfTheFilesWhateverIsInIt) {
  // Colons in a name, a name that begins another, a control character, which is printed as such.
  EXPECT_THAT(GroupMessages({"a: b.matches: x: y", "a: x: y", "c\\x07.matches: x: y"},
                            {"a", "a: b.matches", "c\a.matches"}),
              ElementsAre("a: b.matches: x: y (3 files alike)"));
  // No file: nothing is taken off.
  EXPECT_THAT(GroupMessages({"k: x", "l: x", "k: x"}, {"a"}),
              ElementsAre("k: x (2 files alike)", "l: x"));
}

// A drive has as many messages of a kind as it has numbers of matches.
TEST(MessageGroups, CountsMakeNoOtherMessage) {
  const std::vector<std::string> files = {"d/0", "d/1", "d/2", "d/3"};
  EXPECT_THAT(
      GroupMessages({"d/0: 4pt: 16 of 200 matches agree", "d/1: 4pt: 7 of 180 matches agree",
                     "d/2: 3pt: 7 of 180 matches agree", "d/3: x4 is 0.5, expected 1"},
                    files),
      ElementsAre("d/0: 4pt: 16 of 200 matches agree (2 files alike but for the numbers)",
                  "d/2: 3pt: 7 of 180 matches agree", "d/3: x4 is 0.5, expected 1"));
}

}  // namespace
}  // namespace rigel
