// EuRoC's layout: sensor.yaml of camera 0, data.csv of both cameras, the ground truth, in this
// order.
#include "rigel/problems/images/euroc_sequence.h"
#include "rigel/test/fuzz/fuzz.h"

namespace {

constexpr char kSensor[] =
    "T_BS:\n  cols: 4\n  rows: 4\n"
    "  data: [1.0, 0.0, 0.0, 0.1, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0]\n"
    "resolution: [752, 480]\ncamera_model: pinhole\nintrinsics: [458.0, 457.0, 367.0, 248.0]\n"
    "distortion_model: radial-tangential\ndistortion_coefficients: [-0.3, 0.07, 0.0002, 1e-05]\n";

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using rigel::fuzz::Require;
  static const rigel::fuzz::Folder folder;
  const std::vector<std::string> parts = rigel::fuzz::Parts(data, size);
  const std::string images = parts.size() > 1 ? parts[1] : "10,a.png\n20,b.png\n";
  folder.Write("mav0/cam0/sensor.yaml", parts[0]);
  folder.Write("mav0/cam1/sensor.yaml", kSensor);
  folder.Write("mav0/cam0/data.csv", images);
  folder.Write("mav0/cam1/data.csv", images);
  const std::string truth = "mav0/state_groundtruth_estimate0/data.csv";
  std::error_code ignored;
  std::filesystem::remove(folder.Path(truth), ignored);
  if (parts.size() > 2) folder.Write(truth, parts[2]);

  rigel::ImageSequence sequence;
  std::string error;
  if (!rigel::ReadEurocSequence(folder.Path(""), rigel::EurocOptions(), &sequence, &error)) {
    rigel::fuzz::RequireMessage(error);
    return 0;
  }
  Require(!sequence.cameras.empty() && sequence.frames.size() > 0, "cameras and frames");
  rigel::Rig rig;
  for (const rigel::ImageCamera& camera : sequence.cameras) rig.cameras.push_back(camera.camera);
  Require(rig.IsValid(&error), "what was read is valid: " + error);
  for (const rigel::ImageFrame& frame : sequence.frames) {
    Require(frame.images.size() == sequence.cameras.size(), "an image a camera");
    if (frame.world_from_body) Require(frame.world_from_body->AllFinite(), "finite poses");
  }
  for (const std::string& note : sequence.notes) rigel::fuzz::RequireMessage(note);
  return 0;
}
