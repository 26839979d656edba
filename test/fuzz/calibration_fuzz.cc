// Calibrations of other tools: the bytes are a file of each format, with the parts after the first
// as the files beside it.
#include "rigel/problems/rigs/rig_check.h"
#include "rigel/problems/rigs/rig_formats.h"
#include "rigel/problems/rigs/rig_table.h"
#include "rigel/test/fuzz/fuzz.h"

namespace {

using rigel::fuzz::Require;

// A rig that was read is valid, can be shown and judged, and reads back from its file.
void Use(const rigel::Calibration& calibration) {
  std::string error;
  const rigel::RigFile& rig = calibration.rig;
  Require(rig.rig.IsValid(&error), "what was read is valid: " + error);
  Require(rig.camera_names.size() == rig.rig.cameras.size(), "each camera has a name");
  Require(rig.camera_images.size() == rig.rig.cameras.size(), "each camera has its images");
  rigel::RigFile again;
  Require(rigel::ParseRigFile(rigel::RigFileText(rig), "again", &again, &error),
          "what is written can be read: " + error);
  for (const std::string& warning : rigel::RigWarnings(rig, true)) {
    rigel::fuzz::RequireMessage(warning);
  }
  rigel::BodyAxes axes;
  if (rigel::ResolveBodyAxes(rig.rig, rig.down, rig.forward, &axes, &error)) {
    rigel::RigTable(rig, axes);
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  static const rigel::fuzz::Folder folder;
  const std::vector<std::string> parts = rigel::fuzz::Parts(data, size);
  const std::string second = parts.size() > 1 ? parts[1] : "";
  folder.Write("file", parts[0]);
  folder.Write("cameras.txt", second);
  folder.Write("images.txt", parts.size() > 2 ? parts[2] : "");
  folder.Write("sensor.json", second);
  folder.Write("intrinsics.csv", parts[0]);
  folder.Write("egovehicle_SE3_sensor.csv", second);

  std::string format, error;
  if (!rigel::DetectRigFormat(folder.Path("file"), &format, &error)) {
    rigel::fuzz::RequireMessage(error);
  }
  rigel::CalibrationOptions options;
  options.size = rigel::ImageSize{640, 480};
  for (const char* name : {"rigel", "kalibr", "orbslam3", "euroc", "colmap", "kitti", "kitti_raw",
                           "kitti_rectified", "nuscenes", "argoverse2"}) {
    rigel::Calibration calibration;
    if (rigel::ReadRigCalibration(folder.Path("file"), name, options, &calibration, &error)) {
      Use(calibration);
    } else {
      rigel::fuzz::RequireMessage(error);
    }
  }
  return 0;
}
