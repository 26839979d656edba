#include "rigel/problems/rigs/kalibr_lens.h"

#include <algorithm>
#include <vector>

#include "rigel/problems/io/printable.h"
#include "rigel/problems/rigs/calibration_text.h"
#include "rigel/problems/rigs/yaml_text.h"

namespace rigel {
namespace {

struct Lens {
  const char* camera_model;
  const char* distortion_model;
  size_t num_intrinsics, num_coefficients;
  CameraModel model;
};
constexpr Lens kLenses[] = {{"pinhole", "radtan", 4, 4, CameraModel::kOpencv},
                            {"pinhole", "radtan", 4, 5, CameraModel::kFullOpencv},
                            {"pinhole", "equidistant", 4, 4, CameraModel::kOpencvFisheye},
                            {"pinhole", "fov", 4, 1, CameraModel::kFov},
                            {"pinhole", "none", 4, 0, CameraModel::kPinhole},
                            {"omni", "radtan", 5, 4, CameraModel::kOmni},
                            {"omni", "none", 5, 0, CameraModel::kOmni},
                            {"ds", "none", 6, 0, CameraModel::kDoubleSphere},
                            {"eucm", "none", 6, 0, CameraModel::kEucm}};

}  // namespace

Camera KalibrLens(const YAML::Node& camera, const std::string& coefficients) {
  const std::string model = YamlWord(camera, "camera_model");
  // Coefficients without a model would be left out.
  const bool has_distortion = HasKey(camera, "distortion_model") || HasKey(camera, coefficients);
  std::string distortion = has_distortion ? YamlWord(camera, "distortion_model") : "none";
  if (distortion == "radial-tangential") distortion = "radtan";
  std::vector<double> d;
  if (distortion != "none") d = YamlNumbers(camera, coefficients);
  const Lens* known = nullptr;  // of the names, and of as many coefficients if there is one
  for (const Lens& lens : kLenses) {
    if (model != lens.camera_model || distortion != lens.distortion_model) continue;
    if (known == nullptr || lens.num_coefficients == d.size()) known = &lens;
  }
  if (known == nullptr) {
    throw LineError(YamlLine(YamlMember(camera, "camera_model")),
                    "camera_model " + Quoted(model) + " with distortion_model " +
                        Quoted(distortion) +
                        ", expected pinhole with radtan, equidistant, fov or none, omni with "
                        "radtan or none, ds or eucm with none");
  }
  if (known->num_coefficients > 0) d = YamlNumbers(camera, coefficients, known->num_coefficients);
  std::vector<double> p = YamlNumbers(camera, "intrinsics", known->num_intrinsics);

  Camera lens;
  lens.model = known->model;
  const bool perspective =
      lens.model == CameraModel::kOpencv || lens.model == CameraModel::kFullOpencv;
  if (perspective && std::all_of(d.begin(), d.end(), [](double x) { return x == 0; })) {
    lens.model = CameraModel::kPinhole;  // estimates of pinholes are faster
  } else {
    p.insert(p.end(), d.begin(), d.end());
  }
  p.resize(Camera::kMostParameters);  // omni without distortion has zeros there
  std::copy(p.begin(), p.end(), lens.parameters);
  std::string what;
  if (!lens.IsValid(&what)) throw LineError(YamlLine(YamlMember(camera, "intrinsics")), what);
  const std::vector<double> size = YamlNumbers(camera, "resolution", 2);
  const int line = YamlLine(YamlMember(camera, "resolution"));
  lens.width = PixelsOf(size[0], "resolution", line);
  lens.height = PixelsOf(size[1], "resolution", line);
  return lens;
}

}  // namespace rigel
