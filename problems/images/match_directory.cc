#include "rigel/problems/images/match_directory.h"

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <system_error>

#include "rigel/problems/io/csv.h"
#include "rigel/problems/io/directory.h"
#include "rigel/problems/io/match_file.h"
#include "rigel/problems/io/printable.h"
#include "rigel/problems/io/text_lines.h"
#include "rigel/problems/io/whole_file.h"

namespace rigel {
namespace {

namespace fs = std::filesystem;

constexpr char kSettingsName[] = "rigel_match.settings";

std::string NumbersText(const std::vector<double>& numbers) {
  std::string text;
  for (const double number : numbers) text += " " + CsvNumber(number);
  return text + "\n";
}

// The parameters from number `first` on.
std::string LensNumbers(const Camera& c, int first) {
  return NumbersText({c.parameters + first, c.parameters + NumCameraParameters(c.model)});
}

// The settings that all files of a directory must share: the options, and the calibration and
// contents of the data set, which may change between two runs. The path of the data set is not
// included.
std::string SettingsText(const SequenceMatchingOptions& options, const ImageSequence& sequence) {
  std::string text = "sequence " + sequence.name + "\nstride " + std::to_string(options.stride) +
                     "\nfeatures " + FeatureTypeName(options.features.type) + "\nmax_features " +
                     std::to_string(options.features.max_features) + "\nratio " +
                     CsvNumber(options.features.ratio) + "\n" + options.header_settings;
  const auto any = [&](const auto& has) {
    return std::any_of(sequence.frames.begin(), sequence.frames.end(), has) ? "yes\n" : "no\n";
  };
  text += std::string("truth ") +
          any([](const ImageFrame& frame) { return frame.world_from_body.has_value(); });
  text +=
      std::string("times ") + any([](const ImageFrame& frame) { return frame.time.has_value(); });
  for (const std::string& setting : sequence.settings) text += setting + "\n";
  if (options.landmarks) text += "landmarks yes\n";
  for (size_t k = 0; k < sequence.cameras.size(); ++k) {
    const RigCamera& camera = sequence.cameras[k].camera;
    const Camera& c = camera.intrinsics;
    const Eigen::Matrix3d& Q = camera.Q;
    const std::string name = "camera " + std::to_string(k);
    if (c.model == CameraModel::kPinhole) {
      text += name + " focal" + NumbersText({c.fx(), c.fy()});
      text += name + " centre" + NumbersText({c.cx(), c.cy()});
    } else {
      text += name + " " + CameraModelName(c.model) + LensNumbers(c, 0);
    }
    for (int row = 0; row < 3; ++row) {
      text += name + " row " + std::to_string(row) +
              NumbersText({Q(row, 0), Q(row, 1), Q(row, 2), camera.s[row]});
    }
    if (sequence.cameras[k].lens) {
      constexpr int kFirst = 4;  // of the parameters of the distortion, after fx fy cx cy
      text += name + " distortion" + LensNumbers(*sequence.cameras[k].lens, kFirst);
    }
  }
  return text;
}

bool SameSettings(const fs::path& path, const std::string& text, std::string* error) {
  std::vector<TextLine> lines;
  if (!ReadTextLines(path.string(), &lines, error)) {
    *error += "; without it --resume cannot know what the match files beside it were made with";
    return false;
  }
  size_t begin = 0;
  for (size_t k = 0; begin < text.size() || k < lines.size(); ++k) {
    const size_t end = std::min(text.find('\n', begin), text.size());
    const std::string now = text.substr(begin, end - begin);
    if (k >= lines.size() || lines[k].text != now) {
      *error = Printable(path.string()) + ": the match files beside it were made with " +
               (k < lines.size() ? Quoted(lines[k].text) : "other settings") + ", this run has " +
               (now.empty() ? "no such line" : Quoted(now)) + "; name another directory";
      return false;
    }
    begin = std::min(end + 1, text.size());
  }
  return true;
}

}  // namespace

std::string FrameIndices::FileName() const {
  char name[64];
  std::snprintf(name, sizeof(name), "%06d-%06d.matches", frame1, frame2);
  return name;
}

bool PrepareDirectory(const SequenceMatchingOptions& options, const ImageSequence& sequence,
                      const std::vector<FrameIndices>& pairs, const std::string& directory,
                      std::set<std::string>* kept, std::string* error) {
  std::error_code code;
  fs::create_directories(directory, code);
  if (code) {
    *error = Printable(directory) + ": cannot be made: " + code.message();
    return false;
  }
  std::set<std::string> own, there, others;
  for (const FrameIndices& indices : pairs) own.insert(indices.FileName());
  const auto add = [&](const std::string& name, bool is_directory) {
    if (is_directory || !IsMatchFileName(name)) return;
    (own.count(name) > 0 ? there : others).insert(name);
  };
  if (!ListDirectory(directory, add, error)) return false;
  const auto holds = [&](const std::set<std::string>& names) {
    return Printable(directory) + ": holds " + Printable(*names.begin()) +
           (names.size() > 1 ? " and " + std::to_string(names.size() - 1) + " more" : "");
  };
  if (!others.empty()) {
    *error = holds(others) +
             ", which would be read as if it were of this run; empty the directory or name another";
    return false;
  }
  if (!there.empty() && !options.resume) {
    *error = holds(there) + "; --resume continues that run, or name another directory";
    return false;
  }
  const fs::path settings = fs::path(directory) / kSettingsName;
  const std::string text = SettingsText(options, sequence);
  if (!there.empty()) {
    if (!SameSettings(settings, text, error)) return false;
  } else if (!WriteWholeFile(settings.string(), text, error)) {
    return false;
  }
  RemoveLeftOvers(directory, [](const std::string& name) {
    return IsMatchFileName(name) || name == kSettingsName;
  });
  for (const std::string& name : there) {
    FramePair ignored;
    std::string broken;
    if (ReadMatchFile((fs::path(directory) / name).string(), &ignored, &broken)) {
      kept->insert(name);
    }
  }
  return true;
}

}  // namespace rigel
