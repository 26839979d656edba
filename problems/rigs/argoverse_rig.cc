#include "rigel/problems/rigs/argoverse_rig.h"

#include <algorithm>
#include <filesystem>
#include <map>
#include <utility>
#include <vector>

#include "rigel/problems/io/directory.h"
#include "rigel/problems/io/printable.h"
#include "rigel/problems/rigs/calibration_text.h"

namespace rigel {
namespace {

namespace fs = std::filesystem;

// A row of a table: the sensor and the numbers of the columns that were asked for.
struct Row {
  std::string sensor;
  std::vector<double> numbers;
  int line;
};

std::string Unquoted(std::string_view cell) {
  const bool quoted = cell.size() >= 2 && cell.front() == '"' && cell.back() == '"';
  return std::string(quoted ? cell.substr(1, cell.size() - 2) : cell);
}

std::vector<Row> ParseTable(const std::string& text, const std::vector<std::string>& names) {
  const std::vector<TextLine> lines = LinesOf(text);
  std::vector<std::string> header;
  if (!lines.empty()) {
    for (const std::string_view cell : SplitAtCommas(lines[0].text)) {
      header.push_back(Unquoted(cell));
    }
  }
  const auto place_of = [&](const std::string& name) {
    const auto found = std::find(header.begin(), header.end(), name);
    if (found == header.end()) {
      throw LineError(lines.empty() ? 0 : lines[0].number,
                      "no column " + name + ", expected a first line with the names of columns");
    }
    return found - header.begin();
  };
  const auto sensor = place_of("sensor_name");
  std::vector<Row> rows;
  for (size_t k = 1; k < lines.size(); ++k) {
    const std::vector<std::string_view> cells = SplitAtCommas(lines[k].text);
    if (cells.size() != header.size()) {
      throw LineError(lines[k].number, std::to_string(cells.size()) + " cells, expected " +
                                           std::to_string(header.size()));
    }
    Row row{Unquoted(cells[sensor]), {}, lines[k].number};
    for (const std::string& name : names) {
      row.numbers.push_back(NumberOf(cells[place_of(name)], name, row.line));
    }
    rows.push_back(std::move(row));
  }
  return rows;
}

}  // namespace

bool ReadArgoverseRig(const std::string& path, const CalibrationOptions& /*options*/,
                      Calibration* calibration, std::string* error) {
  fs::path folder = IsDirectory(path) ? fs::path(path) : fs::path(path).parent_path();
  if (IsDirectory(folder / "calibration")) folder /= "calibration";
  std::map<std::string, Pose> poses;  // of all sensors, also lidars
  const auto parse_poses = [&](const std::string& text) {
    for (const Row& row : ParseTable(text, {"qw", "qx", "qy", "qz", "tx_m", "ty_m", "tz_m"})) {
      const std::vector<double>& n = row.numbers;
      poses[row.sensor] =
          PoseOfQuaternion({n[0], n[1], n[2], n[3]}, {n[4], n[5], n[6]}, row.sensor, row.line);
    }
  };
  const std::string pose_path = (folder / "egovehicle_SE3_sensor.csv").string();
  if (!ReadWith(pose_path, parse_poses, error)) return false;

  const auto parse_cameras = [&](const std::string& text) {
    const std::vector<Row> rows =
        ParseTable(text, {"fx_px", "fy_px", "cx_px", "cy_px", "width_px", "height_px"});
    if (rows.empty()) throw LineError(0, "no camera, expected a row a camera");
    for (const Row& row : rows) {
      const std::vector<double>& n = row.numbers;
      const auto pose = poses.find(row.sensor);
      if (pose == poses.end()) {
        throw LineError(row.line, Quoted(row.sensor) + " has no row in " + pose_path);
      }
      const Camera lens =
          Camera::Pinhole(n[0], n[1], n[2], n[3], PixelsOf(n[4], "width_px", row.line),
                          PixelsOf(n[5], "height_px", row.line));
      AddCamera(row.sensor, lens, pose->second, &calibration->rig);
    }
  };
  if (!ReadWith((folder / "intrinsics.csv").string(), parse_cameras, error)) return false;
  calibration->body = "the ego vehicle, x forward, y left, z up";
  calibration->rig.down = -Eigen::Vector3d::UnitZ();
  calibration->rig.forward = Eigen::Vector3d::UnitX();
  calibration->notes.emplace_back("k1, k2, k3 are left out: the images are undistorted");
  return true;
}

}  // namespace rigel
