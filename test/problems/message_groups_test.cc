#include "rigel/problems/message_groups.h"

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

}  // namespace
}  // namespace rigel
