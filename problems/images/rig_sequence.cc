#include "rigel/problems/images/rig_sequence.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <limits>
#include <map>
#include <set>

#include "rigel/core/enum_names.h"
#include "rigel/core/median.h"
#include "rigel/problems/images/frame_stamps.h"
#include "rigel/problems/images/image_pattern.h"
#include "rigel/problems/images/view_overlap.h"
#include "rigel/problems/io/directory.h"
#include "rigel/problems/io/name_order.h"
#include "rigel/problems/io/parse_number.h"
#include "rigel/problems/io/printable.h"
#include "rigel/problems/io/rig_file.h"
#include "rigel/problems/io/text_lines.h"

namespace rigel {
namespace {

namespace fs = std::filesystem;

constexpr EnumName<FrameOrder> kOrderNames[] = {
    {FrameOrder::kName, "name"}, {FrameOrder::kIndex, "order"}, {FrameOrder::kTime, "time"}};

// Nanoseconds: time stamps are whole numbers of them.
constexpr int64_t kSecond = 1'000'000'000;

using Images = std::map<std::string, std::string>;  // frame, path

// Reads the sequence of one rig file; the functions return false with a message in *error.
class Reader {
 public:
  Reader(const RigSequenceOptions& options, const RigFile& file, fs::path folder,
         std::string* error)
      : options_(options), file_(file), folder_(std::move(folder)), error_(error) {}

  bool Read(ImageSequence* sequence) {
    sequence_ = sequence;
    for (const RigCamera& camera : file_.rig.cameras) sequence->cameras.push_back({camera, {}});
    sequence->forward = file_.forward;
    return FindPairs() && FindAll() && MakeFrames() && AddMasks() && AddNotes();
  }

 private:
  bool Fail(const std::string& message) {
    *error_ = message;
    return false;
  }

  int num_cameras() const { return file_.rig.size(); }
  std::string Name(size_t camera) const { return Printable(file_.camera_names[camera]); }
  void Note(const std::string& note) { sequence_->notes.push_back(note); }

  bool FindPairs() {
    auto* const pairs = &sequence_->camera_pairs;
    if (!ParseCameraPairs(options_.camera_pairs, file_.rig, file_.camera_names, pairs, error_)) {
      return false;
    }
    std::string setting = "camera_pairs", names;
    for (const auto& [i, j] : *pairs) {
      setting += " " + std::to_string(i) + "-" + std::to_string(j);
      names += (names.empty() ? "" : ", ") + Name(i) + "-" + Name(j);
    }
    sequence_->settings.push_back(setting);
    if (num_cameras() == 1) return true;
    Note(pairs->empty() ? "each camera is matched with itself only"
                        : "cameras that are matched with each other" +
                              std::string(options_.camera_pairs == "overlap"
                                              ? ", as their fields of view overlap: "
                                              : ": ") +
                              names);
    return true;
  }

  // The pattern of a camera, whose name is `camera`.
  std::string Pattern(size_t k, const std::string& camera) const {
    std::string pattern = options_.images;
    if (pattern.empty()) {
      // Joining leaves an absolute path as it is.
      pattern = (folder_ / file_.camera_images[k]).string();
    }
    return FillField(pattern, kCameraField, camera);
  }

  bool Find(bool by_number) {
    images_.assign(num_cameras(), Images());
    for (int k = 0; k < num_cameras(); ++k) {
      const std::string camera = by_number ? std::to_string(k) : file_.camera_names[k];
      for (int other = 0; other < k; ++other) {
        const std::string name = by_number ? std::to_string(other) : file_.camera_names[other];
        if (Pattern(k, camera) == Pattern(other, name)) {
          return Fail("cameras " + std::to_string(other) + " and " + std::to_string(k) + " (" +
                      Name(k) + ") have the same images, expected names or patterns that differ");
        }
      }
      if (!FindImages(Pattern(k, camera), &images_[k], error_)) return false;
    }
    return true;
  }

  bool FindAll() {
    for (int k = 0; k < num_cameras(); ++k) {
      if (options_.images.empty() && file_.camera_images[k].empty()) {
        return Fail("--images is missing, and the rig file has no 'images' of camera " + Name(k) +
                    ": name a pattern, as '{camera}/{frame}.jpg'");
      }
    }
    if (num_cameras() > 1 && !options_.images.empty() &&
        options_.images.find(kCameraField) == std::string::npos) {
      return Fail("--images: " + Quoted(options_.images) +
                  " has no {camera}, expected it where the cameras' images differ");
    }
    const auto none = [](const Images& images) { return images.empty(); };
    if (!Find(false)) return false;
    if (std::all_of(images_.begin(), images_.end(), none)) {
      if (!Find(true)) return false;
      by_number_ = !std::all_of(images_.begin(), images_.end(), none);
    }
    for (int k = 0; k < num_cameras(); ++k) {
      if (!images_[k].empty()) continue;
      const std::string camera = by_number_ ? std::to_string(k) : file_.camera_names[k];
      return Fail("camera " + Name(k) + ": no image fits '" + Printable(Pattern(k, camera)) + "'");
    }
    return true;
  }

  bool MakeFrames() {
    switch (options_.order) {
      case FrameOrder::kName:
        MakeFramesByName();
        return true;
      case FrameOrder::kIndex:
        MakeFramesByIndex();
        return true;
      case FrameOrder::kTime:
        return MakeFramesByTime();
    }
    return false;
  }

  // Adds a frame of the images with these keys, empty where a camera has none.
  ImageFrame* AddFrame(const std::vector<std::string>& keys) {
    ImageFrame frame;
    for (size_t k = 0; k < keys.size(); ++k) {
      frame.images.push_back(keys[k].empty() ? "" : images_[k].at(keys[k]));
    }
    if (keys_.empty()) {
      const auto first = std::find_if(keys.begin(), keys.end(),
                                      [](const std::string& key) { return !key.empty(); });
      sequence_->settings.push_back("frame 0 " + Quoted(*first));
    }
    keys_.push_back(keys);
    sequence_->frames.push_back(std::move(frame));
    return &sequence_->frames[sequence_->frames.size() - 1];
  }

  void MakeFramesByName() {
    std::set<std::string> all;
    for (const Images& images : images_) {
      for (const auto& [frame, path] : images) all.insert(frame);
    }
    std::vector<std::string> names(all.begin(), all.end());
    SortByNumbers(&names);
    for (const std::string& name : names) {
      std::vector<std::string> keys;
      for (const Images& images : images_) keys.push_back(images.count(name) > 0 ? name : "");
      AddFrame(keys);
    }
  }

  void MakeFramesByIndex() {
    std::vector<std::vector<std::string>> names(num_cameras());
    size_t most = 0;
    for (int k = 0; k < num_cameras(); ++k) {
      for (const auto& [frame, path] : images_[k]) names[k].push_back(frame);
      SortByNumbers(&names[k]);
      most = std::max(most, names[k].size());
    }
    for (size_t index = 0; index < most; ++index) {
      std::vector<std::string> keys;
      for (const auto& of_camera : names) {
        keys.push_back(index < of_camera.size() ? of_camera[index] : "");
      }
      AddFrame(keys);
    }
  }

  // A number of time units, with or without decimals, in nanoseconds. What is finer is cut off.
  bool ParseTime(std::string_view text, int64_t* time) const {
    const size_t point = std::min(text.find('.'), text.size());
    const int64_t unit = options_.time_unit_ns;
    int64_t whole;
    if (!ParseInteger(text.substr(0, point), int64_t{0}, &whole) ||
        whole > std::numeric_limits<int64_t>::max() / unit - 1) {
      return false;
    }
    *time = whole * unit;
    int64_t place = unit;
    for (size_t k = point + 1; k < text.size(); ++k) {
      if (text[k] < '0' || text[k] > '9') return false;
      place /= 10;
      *time += place * (text[k] - '0');
    }
    return point != text.size() - 1;
  }

  bool MakeFramesByTime() {
    std::vector<Stamps> stamps(num_cameras());
    std::vector<std::map<int64_t, std::string>> keys(num_cameras());
    for (int k = 0; k < num_cameras(); ++k) {
      const double offset = file_.rig.cameras[k].time_offset;
      for (const auto& [frame, path] : images_[k]) {
        int64_t time;
        if (!ParseTime(frame, &time)) {
          return Fail(Printable(path) + ": {frame} is " + Quoted(frame) +
                      ", expected a time stamp (--frames=time)");
        }
        time -= std::llround(offset * kSecond);
        const auto [known, is_new] = keys[k].emplace(time, frame);
        if (!is_new) {
          return Fail(Printable(path) + ": the time stamp " + std::to_string(time) +
                      " occurs twice");
        }
      }
      for (const auto& [time, frame] : keys[k]) stamps[k].push_back(time);
    }
    const StampFrames grouped = GroupStamps(stamps, options_.sync_tolerance_ms);
    std::vector<std::vector<int64_t>> late(num_cameras());
    for (const StampFrame& frame : grouped.frames) {
      std::vector<std::string> names;
      for (int k = 0; k < num_cameras(); ++k) {
        const int index = frame.images[k];
        names.push_back(index < 0 ? "" : keys[k].at(stamps[k][index]));
        if (index >= 0) late[k].push_back(stamps[k][index] - frame.time);
      }
      AddFrame(names)->time = static_cast<double>(frame.time) / kSecond;
    }
    if (grouped.largest == 0) return true;
    sequence_->settings.push_back(grouped.setting);
    Note("time stamps of a frame differ by up to " + Milliseconds(grouped.largest) + ", within " +
         grouped.within);
    for (int k = 0; k < num_cameras(); ++k) {
      const int64_t median = MedianInPlace(&late[k]);
      if (std::abs(median) < kLate) continue;
      Note("camera " + Name(k) + " fires " + Milliseconds(median) +
           " after the others (median): that belongs to its 'time_offset' in the rig file");
    }
    return true;
  }

  // Masks by the pattern; an image without a mask has none.
  bool AddMasks() {
    if (options_.masks.empty()) return true;
    if (num_cameras() > 1 && options_.masks.find(kCameraField) == std::string::npos) {
      return Fail("--masks: " + Quoted(options_.masks) +
                  " has no {camera}, expected it where the cameras' masks differ");
    }
    std::vector<size_t> with(num_cameras(), 0), all(num_cameras(), 0);
    for (size_t index = 0; index < keys_.size(); ++index) {
      ImageFrame& frame = sequence_->frames[index];
      for (int k = 0; k < num_cameras(); ++k) {
        const std::string& key = keys_[index][k];
        const std::string camera = by_number_ ? std::to_string(k) : file_.camera_names[k];
        const std::string mask =
            FillField(FillField(options_.masks, kCameraField, camera), kFrameField, key);
        const bool is_there = !key.empty() && Exists(mask);
        frame.masks.push_back(is_there ? mask : "");
        if (!key.empty()) ++all[k];
        if (is_there) ++with[k];
      }
    }
    if (std::all_of(with.begin(), with.end(), [](size_t n) { return n == 0; })) {
      return Fail("--masks: no file fits '" + Printable(options_.masks) + "'");
    }
    for (int k = 0; k < num_cameras(); ++k) {
      if (with[k] == all[k]) continue;
      Note("camera " + Name(k) + ": " + std::to_string(all[k] - with[k]) + " of " +
           std::to_string(all[k]) + " images have no mask");
    }
    sequence_->settings.emplace_back("masks yes");
    return true;
  }

  // Which cameras lack images, and whether times are missing.
  bool AddNotes() {
    const auto& cameras = file_.rig.cameras;
    if (options_.order != FrameOrder::kTime &&
        std::any_of(cameras.begin(), cameras.end(),
                    [](const RigCamera& camera) { return camera.time_offset != 0; })) {
      Note(
          "the rig file has time offsets of cameras, but the frames have no times: without times "
          "(--frames=time) no motion can be estimated");
    }
    for (int k = 0; k < num_cameras(); ++k) {
      size_t missing = 0;
      std::string first;
      for (size_t index = 0; index < keys_.size(); ++index) {
        if (!keys_[index][k].empty()) continue;
        if (++missing == 1) first = std::to_string(index);
      }
      if (missing == 0) continue;
      Note("camera " + Name(k) + " has no image of " + std::to_string(missing) + " of " +
           std::to_string(keys_.size()) + " frames, the first is frame " + first +
           "; they are matched without it" +
           (options_.order == FrameOrder::kTime && 2 * missing >= keys_.size()
                ? ". If it fires at other times, raise the tolerance or state its time_offset"
                : ""));
    }
    return true;
  }

  // Nanoseconds: at 30 m/s a car moves 3 cm meanwhile.
  static constexpr int64_t kLate = 1'000'000;

  const RigSequenceOptions& options_;
  const RigFile& file_;
  const fs::path folder_;
  std::string* const error_;
  ImageSequence* sequence_ = nullptr;
  std::vector<Images> images_;                  // of each camera
  std::vector<std::vector<std::string>> keys_;  // {frame} of each frame and camera; empty: none
  bool by_number_ = false;                      // {camera} is the number
};

// The camera of that name, or else number; -1 if there is none.
int FindCamera(std::string_view text, const std::vector<std::string>& names) {
  const auto found = std::find(names.begin(), names.end(), text);
  if (found != names.end()) return static_cast<int>(found - names.begin());
  int number;
  const bool is_number = ParseInteger(text, 0, &number) && number < static_cast<int>(names.size());
  return is_number ? number : -1;
}

}  // namespace

bool ParseFrameOrder(std::string_view name, FrameOrder* order) {
  return FindValue(kOrderNames, name, order);
}

std::string SequenceName(std::string text) {
  for (char& c : text) {
    if (c <= ' ' || c > '~') c = '_';
  }
  return text;
}

bool ParseCameraPairs(const std::string& text, const Rig& rig,
                      const std::vector<std::string>& names,
                      std::vector<std::pair<int, int>>* pairs, std::string* error) {
  pairs->clear();
  if (text == "none") return true;
  if (text == "overlap") {
    *pairs = OverlappingCameras(rig);
    return true;
  }
  std::set<std::pair<int, int>> found;
  if (text == "all") {
    for (int i = 0; i < rig.size(); ++i) {
      for (int j = i + 1; j < rig.size(); ++j) found.emplace(i, j);
    }
  } else {
    for (const std::string_view pair : SplitAtCommas(text)) {
      // A name may have a "-" of its own.
      bool is_pair = false;
      for (size_t at = pair.find('-'); at != std::string_view::npos && !is_pair;
           at = pair.find('-', at + 1)) {
        const int i = FindCamera(pair.substr(0, at), names);
        const int j = FindCamera(pair.substr(at + 1), names);
        is_pair = i >= 0 && j >= 0 && i != j;
        if (is_pair) found.emplace(std::min(i, j), std::max(i, j));
      }
      if (is_pair) continue;
      *error = "--camera_pairs: " + Quoted(pair) +
               ", expected overlap, all, none, or pairs of names or numbers of two cameras, as 0-1";
      return false;
    }
  }
  pairs->assign(found.begin(), found.end());
  return true;
}

bool RigSequenceOptions::IsValid(std::string* error) const {
  if (time_unit_ns < 1 || time_unit_ns > kSecond) {
    *error = "time_unit_ns: expected 1 to 1000000000";
    return false;
  }
  return IsSyncTolerance(sync_tolerance_ms, error);
}

bool ReadRigSequence(const std::string& rig_file, const RigSequenceOptions& options,
                     ImageSequence* sequence, std::string* error) {
  if (!options.IsValid(error)) return false;
  RigFile file;
  if (!ReadRigFile(rig_file, &file, error)) return false;
  ImageSequence result;
  const fs::path path(rig_file);
  const std::string name = !file.name.empty() ? file.name : path.stem().string();
  result.name = SequenceName(!options.name.empty() ? options.name : name);
  if (!Reader(options, file, path.parent_path(), error).Read(&result)) return false;
  *sequence = std::move(result);
  return true;
}

}  // namespace rigel
