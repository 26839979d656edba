// Rigs: camera lines of a match file, and a pair in which every two cameras have a match.
#include "rigel/problems/io/match_file.h"
#include "rigel/refine/estimate_motion.h"
#include "rigel/test/fuzz/fuzz.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using rigel::fuzz::Require;
  const std::string lines(reinterpret_cast<const char*>(data), size);
  rigel::FramePair pair;
  std::string error;
  if (!rigel::ParseMatches("format rigmatch 1\n" + lines + "\nmatches 0\n", "fuzz", &pair,
                           &error)) {
    rigel::fuzz::RequireMessage(error);
    return 0;
  }
  Require(pair.IsValid(&error), "what was read is valid: " + error);
  for (int k = 0; k < 24 && pair.rig.size() > 0; ++k) {
    rigel::Match match;
    match.camera1 = k % pair.rig.size();
    match.camera2 = k % 3 == 0 ? k / 3 % pair.rig.size() : match.camera1;
    match.pixel1 = {37.0 * k, 300.0 - 11.0 * k};
    match.pixel2 = {35.0 * k + 4.0, 290.0 - 10.0 * k};
    pair.matches.push_back(match);
  }
  rigel::EstimateOptions options;
  options.solver = "5pt+1";
  options.ransac.max_iterations = 30;
  const rigel::MotionEstimate estimate = rigel::EstimateMotion(options, pair);
  if (estimate.HasMotion()) Require(estimate.pose.AllFinite(), "a finite motion");
  return 0;
}
