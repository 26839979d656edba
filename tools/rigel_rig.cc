// rigel_rig: rig files from the calibrations of other tools.
#include <algorithm>
#include <iostream>
#include <optional>
#include <string>
#include <vector>

#include <gflags/gflags.h>

#include "rigel/core/body_axes.h"
#include "rigel/problems/io/match_file.h"
#include "rigel/problems/io/parse_number.h"
#include "rigel/problems/rigs/rig_check.h"
#include "rigel/problems/rigs/rig_formats.h"
#include "rigel/problems/rigs/rig_table.h"
#include "rigel/tools/outputs.h"
#include "rigel/tools/tool.h"

DEFINE_string(calibration, "", "the calibration: a file, or a folder that has it");
DEFINE_string(format, "auto",
              "rigel, kalibr, openvins, orbslam3, euroc, colmap, kitti, kitti_raw, "
              "kitti_rectified, nuscenes or argoverse2. auto: told from the file");
DEFINE_string(output, "", "write the rig to this file (JSON, docs/formats.md); - is stdout");
DEFINE_string(size, "",
              "width and height of all images, as 1241x376, where the format does not state them: "
              "kitti, and older files of orbslam3. Of nuscenes 1600x900 if it is not given");
DEFINE_int32(index, 0, "which rig of a file that has several (colmap, nuscenes), from 0");
DEFINE_string(colmap_cameras, "", "with colmap: cameras.txt, by default the one beside the rig");
DEFINE_string(cameras, "", "take these cameras only, names with commas between, in this order");
DEFINE_string(name, "", "name of the rig; by default that of the file");
DEFINE_string(down, "",
              "down in the body frame: +x, -x, ... -z or three numbers x,y,z. By default as the "
              "format has it, else the tools take it from the cameras");
DEFINE_string(forward, "", "where the vehicle's front is, written as --down");
DEFINE_double(ground_m, 0, "how far the ground is below the body's origin, metres");

namespace rigel {
namespace {

constexpr char kUsage[] =
    "rigel_rig: shows the calibration of a rig, and writes it as a rig file.\n"
    "\n"
    "  rigel_rig --calibration=camchain-imucam.yaml --output=rig.json\n"
    "\n"
    "Reads\n"
    "  kalibr           camchain.yaml, camchain-imucam.yaml\n"
    "  openvins         kalibr_imucam_chain.yaml\n"
    "  orbslam3         settings (YAML) of one camera or two, and older ones\n"
    "  euroc            folder mav0, or one sensor.yaml\n"
    "  colmap           rig_config.json or rigs.txt, with cameras.txt beside it\n"
    "  kitti            calib.txt with P0: to P3:\n"
    "  kitti_raw        calib_cam_to_cam.txt, images that are not rectified\n"
    "  kitti_rectified  the same file, rectified images\n"
    "  nuscenes         calibrated_sensor.json, with sensor.json beside it\n"
    "  argoverse2       intrinsics.csv and egovehicle_SE3_sensor.csv (from .feather)\n"
    "  rigel            rig files\n"
    "The table has for each camera its horizontal field of view, where it looks, in degrees to "
    "the\n"
    "right of forward and up, its roll clockwise, and its position in the body frame. What looks\n"
    "wrong is said on stderr: inverted poses, quaternions x y z w, millimetres.\n"
    "rigel_plot.py rig.json draws the rig.\n";

bool SizeFromFlag(std::optional<ImageSize>* size, std::string* error) {
  if (FLAGS_size.empty()) return true;
  const size_t cross = std::min(FLAGS_size.find('x'), FLAGS_size.size());
  ImageSize read;
  const std::string_view text = FLAGS_size;
  if (cross == text.size() || !ParseInteger(text.substr(0, cross), 1, &read.width) ||
      !ParseInteger(text.substr(cross + 1), 1, &read.height)) {
    return WrongValue("size", FLAGS_size, "width and height, as 1241x376", error);
  }
  *size = read;
  return true;
}

bool AxisFromFlag(const char* flag, const std::string& text, std::optional<Eigen::Vector3d>* axis,
                  std::string* error) {
  if (text.empty()) return true;
  Eigen::Vector3d direction;
  if (!ParseDirection(text, &direction)) {
    return WrongValue(flag, text, "+x, -x, ... -z or three numbers x,y,z", error);
  }
  *axis = direction;
  return true;
}

// What flags say of the rig.
struct Settings {
  CalibrationOptions options;
  std::optional<Eigen::Vector3d> down, forward;
};

bool SettingsFromFlags(Settings* settings, std::string* error) {
  if (FLAGS_calibration.empty()) return Refuse("--calibration is missing: name a file", error);
  if (FLAGS_format != "auto" && !IsRigFormat(FLAGS_format)) {
    return WrongValue("format", FLAGS_format, "auto, " + RigFormatNames(), error);
  }
  if (FLAGS_index < 0) return Refuse("--index: expected a number from 0", error);
  settings->options.index = FLAGS_index;
  settings->options.cameras = FLAGS_colmap_cameras;
  return SizeFromFlag(&settings->options.size, error) &&
         AxisFromFlag("down", FLAGS_down, &settings->down, error) &&
         AxisFromFlag("forward", FLAGS_forward, &settings->forward, error) &&
         OutputsAreNoInputs({{"output", FLAGS_output}}, {FLAGS_calibration, FLAGS_colmap_cameras},
                            error);
}

// Takes the cameras that --cameras names.
bool ChooseCameras(RigFile* file, std::string* error) {
  if (FLAGS_cameras.empty()) return true;
  RigFile chosen = *file;
  chosen.rig.cameras.clear();
  chosen.camera_names.clear();
  chosen.camera_images.clear();
  for (const std::string& name : SplitCommas(FLAGS_cameras)) {
    const auto found = std::find(file->camera_names.begin(), file->camera_names.end(), name);
    if (found == file->camera_names.end()) {
      *error = PrintablePath(FLAGS_calibration) + ": no camera " + PrintablePath(name) +
               ", expected one of";
      for (const std::string& known : file->camera_names) *error += " " + PrintablePath(known);
      return false;
    }
    const auto k = found - file->camera_names.begin();
    chosen.rig.cameras.push_back(file->rig.cameras[k]);
    chosen.camera_names.push_back(name);
    chosen.camera_images.push_back(file->camera_images[k]);
  }
  *file = chosen;
  return true;
}

// The rig as the flags have it.
bool ReadRig(const Settings& settings, const std::string& format, Calibration* calibration,
             std::string* error) {
  if (!ReadRigCalibration(FLAGS_calibration, format, settings.options, calibration, error) ||
      !ChooseCameras(&calibration->rig, error)) {
    return false;
  }
  RigFile* rig = &calibration->rig;
  if (!FLAGS_name.empty()) rig->name = FLAGS_name;
  if (settings.down) {
    rig->down = settings.down;
    rig->forward.reset();  // it belonged to another down
  }
  if (settings.forward) rig->forward = settings.forward;
  if (IsGiven("ground_m")) rig->ground_m = FLAGS_ground_m;
  return true;
}

int Run() {
  Settings settings;
  std::string error;
  if (!SettingsFromFlags(&settings, &error)) return UsageError(error);
  std::string format = FLAGS_format;
  if (format == "auto" && !DetectRigFormat(FLAGS_calibration, &format, &error)) {
    return Failure(error);
  }
  Calibration calibration;
  if (!ReadRig(settings, format, &calibration, &error)) return Failure(error);
  const RigFile& rig = calibration.rig;
  BodyAxes axes;
  if (!ResolveBodyAxes(rig.rig, rig.down, rig.forward, &axes, &error)) {
    return Failure(PrintablePath(FLAGS_calibration) + ": " + error);
  }
  const bool said = rig.down && rig.forward;
  const std::string table = "format " + format + ", body: " + calibration.body + "; down " +
                            DirectionText(axes.down) + ", forward " + DirectionText(axes.forward) +
                            (said ? "" : " (from the cameras)") + "\n" + RigTable(rig, axes);
  bool ok = PrintTable(table, {{"output", FLAGS_output}});
  for (const std::string& note : calibration.notes) std::cerr << note << "\n";
  for (const std::string& warning : RigWarnings(rig, HasQuaternions(format))) {
    std::cerr << "warning: " << warning << "\n";
  }
  ok = WriteOutput(FLAGS_output, RigFileText(rig)) && ok;
  if (ok && !FLAGS_output.empty() && !IsStdout(FLAGS_output)) {
    std::cerr << "wrote " << PrintablePath(FLAGS_output) << "\n";
  }
  return ExitCode(ok);
}

}  // namespace
}  // namespace rigel

int main(int argc, char** argv) {
  return rigel::RunProgram(argc, argv, rigel::kUsage, &rigel::Run);
}
