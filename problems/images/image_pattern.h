// Patterns of the paths of images: "{camera}/{frame}.jpg".
#ifndef RIGEL_PROBLEMS_IMAGES_IMAGE_PATTERN_H_
#define RIGEL_PROBLEMS_IMAGES_IMAGE_PATTERN_H_

#include <map>
#include <string>

namespace rigel {

// {camera} stands for a camera, {frame} for a text of at least one character that says the frame.
// Both may be in several places. In the part of the path where {frame} is first, between two
// slashes, "*" stands for any text. A pattern without {frame} is a folder, which stands for the
// files in it that are named as images: {frame} is their name before the last point.
inline constexpr char kCameraField[] = "{camera}";
inline constexpr char kFrameField[] = "{frame}";

// `text` with `value` in all places of `field`.
std::string FillField(std::string text, const std::string& field, const std::string& value);

// The paths of the files that fit a pattern without {camera}, by their frames. A folder that is not
// there has none. False with a message if a folder cannot be listed, or if two files of one frame
// fit.
bool FindImages(const std::string& pattern, std::map<std::string, std::string>* images,
                std::string* error);

}  // namespace rigel

#endif  // RIGEL_PROBLEMS_IMAGES_IMAGE_PATTERN_H_
