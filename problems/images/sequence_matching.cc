#include "rigel/problems/images/sequence_matching.h"

#include <algorithm>
#include <exception>
#include <filesystem>
#include <map>
#include <memory>
#include <mutex>
#include <set>
#include <utility>

#include "rigel/core/parallel.h"
#include "rigel/problems/images/feature_matching.h"
#include "rigel/problems/images/landmark_tracks.h"
#include "rigel/problems/images/match_directory.h"
#include "rigel/problems/io/directory.h"
#include "rigel/problems/io/exception_message.h"
#include "rigel/problems/io/match_file.h"
#include "rigel/problems/io/match_header.h"
#include "rigel/problems/io/printable.h"

namespace rigel {
namespace {

namespace fs = std::filesystem;

// What is known of a frame's images.
struct FrameFeatures {
  std::vector<ImageFeatures> images;  // one a camera, without a size where it has no image
  std::vector<Match> same_time;       // between its cameras, where landmarks are asked for
};

// The features of a frame while pairs need them: extracted at the first use, released after the
// last.
class SharedFeatures {
 public:
  void AddUse() { ++uses_; }

  // Null if an image cannot be used. Each use ends with Release().
  std::shared_ptr<const FrameFeatures> Get(const SequenceMatchingOptions& options,
                                           const ImageSequence& sequence, int frame) {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (features_ != nullptr || !missing_.empty() || !errors_.empty()) return features_;
    auto features = std::make_shared<FrameFeatures>();
    features->images.resize(sequence.cameras.size());
    const ImageFrame* const there = sequence.frames.Find(frame);
    for (size_t k = 0; k < sequence.cameras.size(); ++k) {
      std::string error;
      const std::string image =
          there != nullptr ? there->images[k] : sequence.image_path(frame, static_cast<int>(k));
      if (image.empty()) continue;
      const std::string mask = there == nullptr || there->masks.empty() ? "" : there->masks[k];
      if (!ExtractFeatures(options.features, sequence.cameras[k], image, mask, &features->images[k],
                           &error)) {
        (Exists(image) ? errors_ : missing_).push_back(error);
      }
    }
    if (!missing_.empty() || !errors_.empty()) return features_;
    if (options.landmarks) {
      for (const auto& [i, j] : sequence.camera_pairs) {
        AppendMatches(options.features, i, features->images[i], j, features->images[j],
                      &features->same_time);
      }
    }
    features_ = std::move(features);
    return features_;
  }

  void Release() {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (--uses_ == 0) features_ = nullptr;
  }

  const std::vector<std::string>& missing() const { return missing_; }
  const std::vector<std::string>& errors() const { return errors_; }

 private:
  std::mutex mutex_;
  int uses_ = 0;
  std::shared_ptr<const FrameFeatures> features_;
  std::vector<std::string> missing_, errors_;
};

// "Down" in the body frame; its pose is known.
Eigen::Vector3d Gravity(const ImageSequence& sequence, const ImageFrame& frame) {
  return frame.world_from_body->R.transpose() * sequence.world_down;
}

// All of a pair but its matches and the sizes of the images.
FramePair MakePair(const ImageSequence& sequence, const FrameIndices& indices) {
  // Both are there: their images were read.
  const ImageFrame& frame1 = sequence.frames[indices.frame1];
  const ImageFrame& frame2 = sequence.frames[indices.frame2];
  FramePair pair;
  pair.sequence = sequence.name;
  for (const ImageCamera& camera : sequence.cameras) pair.rig.cameras.push_back(camera.camera);
  pair.prior.forward = sequence.forward;
  if (frame1.time && frame2.time) {
    pair.time1 = frame1.time;
    pair.time2 = frame2.time;
  }
  if (frame1.world_from_body && frame2.world_from_body) {
    pair.truth = frame2.world_from_body->Inverse() * *frame1.world_from_body;
    pair.prior.gravity1 = Gravity(sequence, frame1);
    pair.prior.gravity2 = Gravity(sequence, frame2);
  }
  return pair;
}

// False with a message if the images of a camera differ in size.
bool AddMatches(const SequenceMatchingOptions& options,
                const std::vector<std::pair<int, int>>& camera_pairs,
                const FrameFeatures& features1, const FrameFeatures& features2, FramePair* pair,
                std::string* error) {
  for (int k = 0; k < pair->rig.size(); ++k) {
    const ImageFeatures &image1 = features1.images[k], &image2 = features2.images[k];
    if (image1.width == 0 || image2.width == 0) continue;
    if (image1.width != image2.width || image1.height != image2.height) {
      *error = "the images of camera " + std::to_string(k) + " differ in size";
      return false;
    }
    pair->rig.cameras[k].intrinsics.width = image1.width;
    pair->rig.cameras[k].intrinsics.height = image1.height;
  }
  const std::set<std::pair<int, int>> matched(camera_pairs.begin(), camera_pairs.end());
  for (int i = 0; i < pair->rig.size(); ++i) {
    for (int j = 0; j < pair->rig.size(); ++j) {
      if (i != j && matched.count({std::min(i, j), std::max(i, j)}) == 0) continue;
      AppendMatches(options.features, i, features1.images[i], j, features2.images[j],
                    &pair->matches);
    }
  }
  if (options.landmarks) {
    pair->columns.landmark =
        LandmarkNumbers(pair->matches, features1.same_time, features2.same_time);
  }
  return true;
}

// Those pairs of the range of which a frame is there; *num_pairs is the number of all.
bool ListPairs(const SequenceMatchingOptions& options, const ImageSequence& sequence,
               std::vector<FrameIndices>* pairs, int* num_pairs, std::string* error) {
  const int num_frames = static_cast<int>(sequence.frames.size());
  const std::string has = "sequence " + Printable(sequence.name) + " has " +
                          std::to_string(num_frames) + (num_frames == 1 ? " frame" : " frames") +
                          ", 0 to " + std::to_string(num_frames - 1);
  const int last = options.last < 0 ? num_frames - 1 : options.last;
  for (const int frame : {options.first, last}) {
    if (frame >= num_frames) {
      *error = "frame " + std::to_string(frame) + " is not there: " + has;
      return false;
    }
  }
  *num_pairs = (last - options.first) / options.stride;
  for (const int frame : sequence.frames.numbers()) {
    if (*num_pairs < 1) break;
    if (frame < options.first || (frame - options.first) % options.stride != 0) continue;
    const int before = frame - options.stride, after = frame + options.stride;
    if (before >= options.first && frame <= last &&
        (pairs->empty() || pairs->back().frame1 < before)) {
      pairs->push_back({before, frame});
    }
    if (after <= last) pairs->push_back({frame, after});
  }
  if (pairs->empty()) *error = "no pair of frames in the range: " + has;
  return !pairs->empty();
}

// Notes the ends of the range without an image, and how many of its pairs have none; `num_pairs` of
// them have some.
void NoteMissingImages(const SequenceMatchingOptions& options, const ImageSequence& sequence,
                       size_t num_pairs, SequenceMatchingSummary* summary) {
  const int end = options.first + summary->num_pairs * options.stride;
  for (const auto& [frame, which] : {std::pair(options.first, "first"), std::pair(end, "last")}) {
    const ImageFrame* const there = sequence.frames.Find(frame);
    if (there != nullptr && std::any_of(there->images.begin(), there->images.end(), Exists)) {
      continue;
    }
    summary->notes.push_back("frame " + std::to_string(frame) + ", the " + which +
                             " of the range, has no images");
  }
  const int without = summary->num_pairs - static_cast<int>(num_pairs);
  if (without > 0) {
    summary->notes.push_back(std::to_string(without) + (without == 1 ? " pair" : " pairs") +
                             " of the range have no image at all");
  }
}

// Matches pairs of frames and writes their files. Match() may run on several threads, each pair
// once.
class PairMatcher {
 public:
  PairMatcher(const SequenceMatchingOptions& options, const ImageSequence& sequence,
              std::string directory, const std::vector<FrameIndices>& pairs)
      : options_(options),
        sequence_(sequence),
        directory_(std::move(directory)),
        pairs_(pairs),
        errors_(pairs.size()),
        written_(pairs.size(), 0) {
    for (const FrameIndices& pair : pairs) {
      frames_[pair.frame1].AddUse();
      frames_[pair.frame2].AddUse();
    }
  }

  void Match(int k) {
    const FrameIndices& indices = pairs_[k];
    const std::string path = (fs::path(directory_) / indices.FileName()).string();
    // No exception may leave a thread, not even that of an image too large for the memory.
    try {
      written_[k] = Write(indices, path, &errors_[k]) ? 1 : 0;
    } catch (const std::exception& exception) {
      errors_[k] = Printable(path) + ": not written: " + ExceptionMessage(exception);
    }
    frames_.at(indices.frame1).Release();
    frames_.at(indices.frame2).Release();
  }

  // What was written and what failed; after the last Match().
  void Report(SequenceMatchingSummary* summary) const {
    for (const auto& [number, frame] : frames_) {
      summary->missing.insert(summary->missing.end(), frame.missing().begin(),
                              frame.missing().end());
      summary->errors.insert(summary->errors.end(), frame.errors().begin(), frame.errors().end());
    }
    for (size_t k = 0; k < pairs_.size(); ++k) {
      summary->written += written_[k];
      if (!errors_[k].empty()) summary->errors.push_back(errors_[k]);
    }
  }

 private:
  // False without a message if the images of a frame cannot be used: the frame has it.
  bool Write(const FrameIndices& indices, const std::string& path, std::string* error) {
    const auto features1 = frames_.at(indices.frame1).Get(options_, sequence_, indices.frame1);
    const auto features2 = frames_.at(indices.frame2).Get(options_, sequence_, indices.frame2);
    if (features1 == nullptr || features2 == nullptr) return false;
    FramePair pair = MakePair(sequence_, indices);
    std::string what;
    if (!AddMatches(options_, sequence_.camera_pairs, *features1, *features2, &pair, &what)) {
      *error = Printable(path) + ": not written: " + what;
      return false;
    }
    return options_.header_lines ? WriteMatchFile(path, pair, options_.header_lines(pair), error)
                                 : WriteMatchFile(path, pair, error);
  }

  const SequenceMatchingOptions& options_;
  const ImageSequence& sequence_;
  const std::string directory_;
  const std::vector<FrameIndices>& pairs_;
  std::map<int, SharedFeatures> frames_;
  std::vector<std::string> errors_;
  std::vector<char> written_;
};

}  // namespace

bool SequenceMatchingOptions::IsValid(std::string* error) const {
  if (!features.IsValid(error)) return false;
  if (first < 0) {
    *error = "first: expected 0 or more";
    return false;
  }
  if (stride < 1) {
    *error = "stride: expected at least 1";
    return false;
  }
  if (last >= 0 && last - first < stride) {
    *error = "last: expected at least first + stride";
    return false;
  }
  return true;
}

bool MatchSequence(const SequenceMatchingOptions& options, const ImageSequence& sequence,
                   const std::string& directory, const std::function<void(int)>& begin,
                   const std::function<void()>& step, SequenceMatchingSummary* summary,
                   std::string* error) {
  *summary = SequenceMatchingSummary();
  if (!options.IsValid(error)) return false;
  std::vector<FrameIndices> pairs;
  std::set<std::string> kept;
  if (!ListPairs(options, sequence, &pairs, &summary->num_pairs, error) ||
      !PrepareDirectory(options, sequence, pairs, directory, &kept, error)) {
    return false;
  }
  NoteMissingImages(options, sequence, pairs.size(), summary);
  pairs.erase(std::remove_if(pairs.begin(), pairs.end(),
                             [&](const FrameIndices& p) { return kept.count(p.FileName()) > 0; }),
              pairs.end());
  summary->kept = static_cast<int>(kept.size());
  const int todo = static_cast<int>(pairs.size());
  begin(todo);

  PairMatcher matcher(options, sequence, directory, pairs);
  // Pairs that one thread takes in turn. Neighbours share a frame: on two threads, the second would
  // wait until the first has extracted it.
  constexpr int kMaxRun = 8;
  const int threads = std::max(options.num_threads, 1);
  const int run = std::clamp((todo + threads - 1) / threads, 1, kMaxRun);
  ParallelFor((todo + run - 1) / run, threads, [&](int r) {
    for (int k = r * run; k < std::min((r + 1) * run, todo); ++k) {
      matcher.Match(k);
      step();
    }
  });
  matcher.Report(summary);
  return true;
}

bool WriteTracks(const SequenceMatchingOptions& options, const ImageSequence& sequence,
                 const std::string& directory, const std::string& path, TracksSummary* summary,
                 std::string* error) {
  *summary = TracksSummary();
  std::vector<FrameIndices> pairs;
  int ignored;
  if (!ListPairs(options, sequence, &pairs, &ignored, error)) return false;
  Tracks tracks;
  TrackBuilder builder;
  std::set<int> frames;
  int last = -1;
  for (const FrameIndices& indices : pairs) {
    const std::string file = (fs::path(directory) / indices.FileName()).string();
    if (!Exists(file)) continue;  // an image of it could not be used
    FramePair pair;
    if (!ReadMatchFile(file, &pair, error)) return false;
    if (last >= 0) builder.Forget(last);
    last = indices.frame1;
    AddPairToTracks(pair, indices.frame1, indices.frame2, &builder);
    frames.insert({indices.frame1, indices.frame2});
    tracks.sequence = pair.sequence;
    tracks.rig = pair.rig;
  }
  if (frames.empty()) {
    *error = Printable(path) + ": not written: there is no match file to make tracks of";
    return false;
  }
  for (const int number : frames) {
    const ImageFrame& frame = sequence.frames[number];
    TrackFrame track_frame{number, frame.time, frame.world_from_body, {}};
    if (frame.world_from_body) track_frame.gravity = Gravity(sequence, frame);
    tracks.frames.push_back(track_frame);
  }
  tracks.observations = builder.Observations();
  summary->observations = tracks.observations.size();
  if (!tracks.observations.empty()) summary->landmarks = tracks.observations.back().landmark + 1;
  return WriteTrackFile(path, tracks, error);
}

}  // namespace rigel
