// Track files: any bytes either parse to tracks, which then survive being written and read again,
// or give a one-line message.
#include "rigel/problems/io/track_file.h"
#include "rigel/test/fuzz/fuzz.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using rigel::fuzz::Require;
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  rigel::Tracks tracks, again;
  std::string error;
  if (!rigel::ParseTracks(text, "fuzz", &tracks, &error)) {
    rigel::fuzz::RequireMessage(error);
    return 0;
  }
  Require(tracks.rig.IsValid(&error), "the rig that was read is valid: " + error);
  for (const rigel::Observation& row : tracks.observations) {
    Require(row.camera < tracks.rig.size(), "cameras of rows are there");
  }
  Require(rigel::ParseTracks(rigel::FormatTracks(tracks), "again", &again, &error),
          "what was written can be read: " + error);
  Require(again.frames.size() == tracks.frames.size() &&
              again.distances.size() == tracks.distances.size() &&
              again.observations.size() == tracks.observations.size(),
          "all frames, distances and rows come back");
  for (size_t k = 0; k < tracks.observations.size(); ++k) {
    const rigel::Observation &a = tracks.observations[k], &b = again.observations[k];
    Require(a.landmark == b.landmark && a.frame == b.frame && a.camera == b.camera &&
                a.pixel == b.pixel && a.sigma == b.sigma,
            "rows come back as they were");
  }
  return 0;
}
