#include "rigel/problems/rigs/colmap_model.h"

#include <algorithm>
#include <cctype>
#include <stdexcept>
#include <string_view>

#include "rigel/problems/io/parse_number.h"
#include "rigel/problems/io/printable.h"
#include "rigel/problems/rigs/calibration_text.h"

namespace rigel {
namespace {

constexpr double kPixelOrigin = 0.5;  // COLMAP's coordinates are larger

int IdOf(std::string_view word, const char* what, int line) {
  int id;
  if (!ParseInteger(word, 0, &id)) {
    throw LineError(line, std::string(what) + " is " + Quoted(word) + ", expected a number from 0");
  }
  return id;
}

}  // namespace

Camera ColmapLens(const std::string& model, const std::vector<double>& parameters) {
  std::string name = model;
  for (char& c : name) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  Camera camera;
  if (!ParseCameraModel(name, &camera.model) || camera.model > CameraModel::kFov ||
      name != CameraModelName(camera.model)) {
    throw std::runtime_error("camera model " + Quoted(model) +
                             " is not read, expected one of COLMAP's from SIMPLE_PINHOLE to FOV");
  }
  const auto count = static_cast<size_t>(NumCameraParameters(camera.model));
  if (parameters.size() != count) {
    throw std::runtime_error(model + " with " + std::to_string(parameters.size()) +
                             " parameters, expected " + std::to_string(count) + ": " +
                             CameraParameterNames(camera.model));
  }
  std::copy(parameters.begin(), parameters.end(), camera.parameters);
  // f cx cy .. or fx fy cx cy ..
  const bool one_focal = std::string_view(CameraParameterNames(camera.model)).substr(0, 2) == "f ";
  double* const principal_point = camera.parameters + (one_focal ? 1 : 2);
  principal_point[0] -= kPixelOrigin;
  principal_point[1] -= kPixelOrigin;
  std::string what;
  if (!camera.IsValid(&what)) throw std::runtime_error(what);
  return camera;
}

bool ReadColmapCameras(const std::string& path, std::map<int, Camera>* cameras,
                       std::string* error) {
  const auto parse = [&](const std::string& text) {
    for (const TextLine& line : LinesOf(text)) {
      const std::vector<std::string_view> words = SplitAtBlanks(line.text);
      constexpr size_t kFirstParameter = 4;  // the place of its word
      if (words.size() < kFirstParameter) {
        throw LineError(line.number, "expected CAMERA_ID MODEL WIDTH HEIGHT PARAMETERS");
      }
      const int id = IdOf(words[0], "CAMERA_ID", line.number);
      const std::vector<double> numbers =
          NumbersOf({words.begin() + 2, words.end()}, "camera " + std::to_string(id), line.number);
      try {
        Camera camera = ColmapLens(std::string(words[1]), {numbers.begin() + 2, numbers.end()});
        camera.width = PixelsOf(numbers[0], "WIDTH", line.number);
        camera.height = PixelsOf(numbers[1], "HEIGHT", line.number);
        if (!cameras->emplace(id, camera).second) throw std::runtime_error("is there twice");
      } catch (const std::exception& exception) {
        throw LineError(line.number, "camera " + std::to_string(id) + ": " + exception.what());
      }
    }
    if (cameras->empty()) throw LineError(0, "no camera, expected COLMAP's cameras.txt");
  };
  return ReadWith(path, parse, error);
}

bool ReadColmapImages(const std::string& path, std::map<int, std::string>* images,
                      std::string* error) {
  std::vector<TextLine> lines;
  // Not ReadWith(): the file has the points of all images and may be larger.
  if (!ReadTextLines(path, &lines, error)) return false;
  for (const TextLine& line : lines) {
    constexpr size_t kWords = 10;  // lines of points have a multiple of 3
    const std::vector<std::string_view> words = SplitAtBlanks(line.text);
    if (words.size() != kWords) continue;
    int id;
    if (!ParseInteger(words[8], 0, &id)) {
      *error = Where(path, line) + ": CAMERA_ID is " + Quoted(words[8]) + ", expected a number";
      return false;
    }
    images->emplace(id, words[9]);
  }
  return true;
}

}  // namespace rigel
