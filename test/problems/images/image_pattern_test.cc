// Patterns of image paths: what fits, what is refused.
#include "rigel/problems/images/image_pattern.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "rigel/test/problems/images/plane_scene.h"
#include "rigel/test/problems/io/match_file_text.h"

namespace rigel {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

class ImagePattern : public testing::Test {
 protected:
  void Touch(const std::string& name) { WriteFile(directory_ / name, ""); }

  // "FRAME=PATH BELOW THE DIRECTORY" of each image.
  std::vector<std::string> Find(const std::string& pattern) {
    std::map<std::string, std::string> images;
    std::string error;
    EXPECT_TRUE(FindImages(directory_ / pattern, &images, &error)) << error;
    std::vector<std::string> found;
    for (const auto& [frame, path] : images) {
      found.push_back(frame + "=" + path.substr(directory_.path().size() + 1));
    }
    return found;
  }

  TempDir directory_;
};

TEST_F(ImagePattern, FrameIsWhatStandsInItsPlace) {
  for (const char* name : {"a/1.jpg", "a/02.jpg", "a/x.png", "a/.jpg", "b/9.jpg"}) Touch(name);
  EXPECT_THAT(Find("a/{frame}.jpg"), ElementsAre("02=a/02.jpg", "1=a/1.jpg"));
  EXPECT_THAT(Find("a/{frame}"),
              ElementsAre(".jpg=a/.jpg", "02.jpg=a/02.jpg", "1.jpg=a/1.jpg", "x.png=a/x.png"));
  EXPECT_THAT(Find("c/{frame}.jpg"), IsEmpty());
}

TEST_F(ImagePattern, AFolderMeansItsImages) {
  for (const char* name : {"a/1.5.JPG", "a/2.png", "a/times.txt", "a/list", "a/b/3.png"}) {
    Touch(name);
  }
  EXPECT_THAT(Find("a"), ElementsAre("1.5=a/1.5.JPG", "2=a/2.png"));
  EXPECT_THAT(Find("a/"), ElementsAre("1.5=a/1.5.JPG", "2=a/2.png"));
}

TEST_F(ImagePattern, StarsAreAnyTextAndFieldsMayRepeat) {
  Touch("log-7__FRONT__17.jpg");
  Touch("log-7__REAR__18.jpg");
  EXPECT_THAT(Find("*__FRONT__{frame}.jpg"), ElementsAre("17=log-7__FRONT__17.jpg"));
  Touch("0001/front_0001.png");
  Touch("0002/front_0003.png");
  EXPECT_THAT(Find("{frame}/front_{frame}.png"), ElementsAre("0001=0001/front_0001.png"));
  Touch("5-5.png");
  Touch("5-6.png");
  EXPECT_THAT(Find("{frame}-{frame}.png"), ElementsAre("5=5-5.png"));
}

TEST_F(ImagePattern, TwoImagesOfAFrameAreRefused) {
  Touch("1.jpg");
  Touch("1.png");
  std::map<std::string, std::string> images;
  std::string error;
  EXPECT_FALSE(FindImages(directory_.path(), &images, &error));
  EXPECT_THAT(error, AllOf(HasSubstr("1.png: a second image of frame '1', expected only"),
                           HasSubstr("1.jpg")));
}

TEST(FillField, FillsAllPlaces) {
  EXPECT_EQ(FillField("{camera}/{frame}_{camera}.png", kCameraField, "front"),
            "front/{frame}_front.png");
  EXPECT_EQ(FillField("{camera}", kCameraField, "{camera}2"), "{camera}2");
}

}  // namespace
}  // namespace rigel
