#include "rigel/problems/io/track_file.h"

#include <algorithm>
#include <array>
#include <map>
#include <set>
#include <tuple>
#include <utility>

#include "rigel/problems/io/header_lines.h"
#include "rigel/problems/io/input_file.h"
#include "rigel/problems/io/match_file.h"
#include "rigel/problems/io/match_file_words.h"
#include "rigel/problems/io/match_text.h"
#include "rigel/problems/io/parse_number.h"
#include "rigel/problems/io/printable.h"
#include "rigel/problems/io/whole_file.h"

namespace rigel {
namespace {

using match_file::kAnyColumns;
using match_file::Keyword;

enum KeywordId {
  kFormat,
  kCamera,
  kCameraSigma,
  kCameraTime,
  kFrame,
  kTruth,
  kGravity,
  kGravitySigma,
  kDistance,
  kNoise,
  kSequence,
  kObservations,
  kNumKeywords,
};

constexpr std::array<Keyword, kNumKeywords> kKeywords = {{
    {"format", "format rigtracks 1", 3},
    match_file::kCameraLine,
    match_file::kCameraSigmaLine,
    match_file::kCameraTimeLine,
    {"frame", "frame F [TIME]", kAnyColumns, true},
    {"truth", "truth F QW QX QY QZ TX TY TZ", 9, true},
    {"gravity", "gravity F GX GY GZ", 5, true},
    {"gravity_sigma_deg", "gravity_sigma_deg S", 2},
    {"distance", "distance F G D SIGMA", 5, true},
    {"noise_px", "noise_px S", 2},
    {"sequence", "sequence NAME", 2},
    {"observations", "observations N", 2},
}};

// "0 0 0 0 0\n": bounds what `observations N` can truthfully announce.
constexpr size_t kMinRowBytes = 10;
constexpr size_t kRowColumns = 5;  // of a row without a sigma

class Parser final : private HeaderLines {
 public:
  Parser(std::string_view text, const std::string& name, std::string* error)
      : HeaderLines(kKeywords.data(), kNumKeywords, "a track file", text, name, error) {
    tracks_.name = name;
  }

  bool Parse(Tracks* tracks) {
    if (!ReadHeader() || !cameras_.Finish(kKeywords[kObservations].name, this, &tracks_.rig) ||
        !FinishFrames() || !ParseRows()) {
      return false;
    }
    *tracks = std::move(tracks_);
    return true;
  }

 private:
  // A line about a frame, which may be before that of the frame.
  struct Named {
    int64_t line;
    int frame;
    size_t column;
  };

  // Reads the frame of a line that names each frame once: a new entry of *frames.
  bool NewFrame(std::map<int, TrackFrame>* frames, TrackFrame** frame) {
    int number;
    if (!Integer(1, 0, &number)) return false;
    const auto [known, is_new] = frames->emplace(number, TrackFrame());
    if (!is_new) {
      return Fail(std::string(Column(0)) + " " + std::to_string(number) +
                  " for the second time, expected once");
    }
    known->second.number = number;
    *frame = &known->second;
    return frames == &frames_ || Name(1, number);
  }

  bool Name(size_t column, int number) {
    named_.push_back({line(), number, column});
    return true;
  }

  bool Frame() {
    TrackFrame* frame;
    constexpr size_t kColumns = 3;  // words of the line with a time
    if (num_columns() != kColumns - 1 && !CheckColumns(kColumns)) return false;
    if (!NewFrame(&frames_, &frame)) return false;
    double time;
    if (num_columns() < kColumns) return true;
    if (!Number(2, &time)) return false;
    frame->time = time;
    return true;
  }

  bool Truth() {
    TrackFrame* frame;
    Pose pose;
    if (!NewFrame(&truths_, &frame) || !RotationAndVector(2, &pose)) return false;
    frame->world_from_body = pose;
    return true;
  }

  bool Gravity() {
    TrackFrame* frame;
    return NewFrame(&gravities_, &frame) && Direction(&frame->gravity, 2);
  }

  bool Distance() {
    TrackDistance d;
    if (!Integer(1, 0, &d.frame1) || !Integer(2, 0, &d.frame2)) return false;
    if (d.frame1 == d.frame2) return FailColumn(2, "another frame than F");
    if (!HeaderLines::Distance(3, &d.distance, &d.sigma)) return false;
    tracks_.distances.push_back(d);
    return Name(1, d.frame1) && Name(2, d.frame2);
  }

  bool HeaderLine(int id) override {
    switch (id) {
      case kCamera:
        return cameras_.ReadCamera(this);
      case kCameraSigma:
        return cameras_.ReadSigma(this);
      case kCameraTime:
        return cameras_.ReadTime(this);
      case kFrame:
        return Frame();
      case kTruth:
        return Truth();
      case kGravity:
        return Gravity();
      case kGravitySigma:
        return SigmaDeg(&tracks_.gravity_sigma);
      case kDistance:
        return Distance();
      case kNoise:
        return Positive(&tracks_.noise_px);
      case kSequence:
        return Sequence(&tracks_.sequence);
      case kObservations:
        return Integer(1, 0, &num_rows_);
      default:
        return false;
    }
  }

  bool FinishFrames() {
    for (const Named& named : named_) {
      if (frames_.count(named.frame) > 0) continue;
      return FailAt(named.line, "frame '" + std::to_string(named.frame) +
                                    "', expected one of a line '" +
                                    std::string(kKeywords[kFrame].usage) + "'");
    }
    for (auto& [number, frame] : frames_) {
      const auto truth = truths_.find(number), gravity = gravities_.find(number);
      if (truth != truths_.end()) frame.world_from_body = truth->second.world_from_body;
      if (gravity != gravities_.end()) frame.gravity = gravity->second.gravity;
      tracks_.frames.push_back(frame);
    }
    return true;
  }

  bool ParseRows() {
    SetUsage("LANDMARK FRAME CAMERA U V [SIGMA]");
    const size_t num_rows = static_cast<size_t>(num_rows_);
    std::vector<Observation>& rows = tracks_.observations;
    rows.reserve(std::min(num_rows, BytesLeft() / kMinRowBytes + 1));
    while (NextLine()) {
      if (!CheckRow(rows.size(), num_rows) || !ReadRow()) return false;
    }
    return CheckNumRows(rows.size(), num_rows) && CheckDistinct();
  }

  bool ReadRow() {
    std::vector<Observation>& rows = tracks_.observations;
    Observation row;
    const bool has_sigma = num_columns() == kRowColumns + 1;
    if (!has_sigma && !CheckColumns(kRowColumns)) return false;
    if (!rows.empty() && rows[0].sigma.has_value() != has_sigma) {
      return Fail(has_sigma ? "a SIGMA, expected none as in the first row"
                            : "no SIGMA, expected one as in the first row");
    }
    if (!ParseInteger(Column(0), INT64_MIN, &row.landmark)) {
      return FailColumn(0, "an integer of 64 bits");
    }
    if (!Integer(1, 0, &row.frame) || !Integer(2, 0, &row.camera)) return false;
    if (frames_.count(row.frame) == 0) return FailColumn(1, "a declared frame");
    if (row.camera >= tracks_.rig.size()) {
      return FailColumn(2,
                        "a declared camera (0 to " + std::to_string(tracks_.rig.size() - 1) + ")");
    }
    if (!Vector(3, &row.pixel)) return false;
    double sigma;
    if (has_sigma) {
      if (!PositiveNumber(kRowColumns, &sigma)) return false;
      row.sigma = sigma;
    }
    rows.push_back(row);
    return true;
  }

  // A landmark is at one place of an image.
  bool CheckDistinct() {
    std::vector<std::tuple<int64_t, int, int>> keys;
    keys.reserve(tracks_.observations.size());
    for (const Observation& o : tracks_.observations)
      keys.emplace_back(o.landmark, o.frame, o.camera);
    std::sort(keys.begin(), keys.end());
    const auto twice = std::adjacent_find(keys.begin(), keys.end());
    if (twice == keys.end()) return true;
    const auto [landmark, frame, camera] = *twice;
    return Fail("landmark " + std::to_string(landmark) + " is twice in the image of camera " +
                std::to_string(camera) + " in frame " + std::to_string(frame) + ", expected once");
  }

  Tracks tracks_;
  CameraLines cameras_;
  std::map<int, TrackFrame> frames_, truths_, gravities_;  // what each kind of line says
  std::vector<Named> named_;
  int num_rows_ = 0;
};

}  // namespace

bool ParseTracks(std::string_view text, const std::string& name, Tracks* tracks,
                 std::string* error) {
  return Parser(text, name, error).Parse(tracks);
}

bool ReadTrackFile(const std::string& path, Tracks* tracks, std::string* error) {
  InputBytes bytes;
  return ReadInputFile(path, &bytes, error) &&
         ParseTracks(bytes.text(), InputName(path), tracks, error);
}

std::string FormatTracks(const Tracks& tracks) {
  // Bytes to reserve, both of them: a file that has more grows as it is written.
  constexpr size_t kHeaderBytes = 4096;
  constexpr size_t kUsualRowBytes = 40;
  MatchText f(kHeaderBytes + kUsualRowBytes * tracks.observations.size());
  f.Word(kKeywords[kFormat].usage).EndLine();
  CameraLines::Write(tracks.rig, &f);
  for (const TrackFrame& frame : tracks.frames) {
    f.Word(kKeywords[kFrame].name).Number(frame.number);
    if (frame.time) f.Number(*frame.time);
    f.EndLine();
  }
  for (const TrackFrame& frame : tracks.frames) {
    if (!frame.world_from_body) continue;
    f.Word(kKeywords[kTruth].name).Number(frame.number);
    f.Quaternion(frame.world_from_body->R).Vector(frame.world_from_body->t).EndLine();
  }
  for (const TrackFrame& frame : tracks.frames) {
    if (!frame.gravity) continue;
    f.Word(kKeywords[kGravity].name).Number(frame.number).Vector(*frame.gravity).EndLine();
  }
  if (tracks.gravity_sigma) {
    f.Word(kKeywords[kGravitySigma].name).SigmaDeg(*tracks.gravity_sigma).EndLine();
  }
  for (const TrackDistance& d : tracks.distances) {
    f.Word(kKeywords[kDistance].name).Number(d.frame1).Number(d.frame2);
    f.Number(d.distance).Number(d.sigma).EndLine();
  }
  if (tracks.noise_px) f.Word(kKeywords[kNoise].name).Number(*tracks.noise_px).EndLine();
  if (!tracks.sequence.empty()) {
    f.Word(kKeywords[kSequence].name).Word(tracks.sequence).EndLine();
  }
  f.Word(kKeywords[kObservations].name).Number(tracks.observations.size()).EndLine();
  const bool has_sigmas = std::all_of(tracks.observations.begin(), tracks.observations.end(),
                                      [](const Observation& o) { return o.sigma.has_value(); });
  for (const Observation& o : tracks.observations) {
    f.Number(o.landmark).Number(o.frame).Number(o.camera).Vector(o.pixel);
    if (has_sigmas) f.Number(*o.sigma);
    f.EndLine();
  }
  return f.Take();
}

bool WriteTrackFile(const std::string& path, const Tracks& tracks, std::string* error) {
  const std::string text = FormatTracks(tracks);
  Tracks ignored;
  return ParseTracks(text, path + ": not written, it could not be read back", &ignored, error) &&
         WriteWholeFile(path, MatchFileBytes(path, text), error);
}

}  // namespace rigel
