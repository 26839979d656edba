// KITTI's layout: calib.txt, times.txt, poses and the name of an image, in this order.
#include "rigel/problems/images/kitti_sequence.h"
#include "rigel/problems/io/kitti_poses.h"
#include "rigel/test/fuzz/fuzz.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using rigel::fuzz::Require;
  static const rigel::fuzz::Folder folder;
  const std::vector<std::string> parts = rigel::fuzz::Parts(data, size);
  const char* const names[] = {"sequences/00/calib.txt", "sequences/00/times.txt", "poses/00.txt"};
  std::error_code ignored;
  for (size_t k = 0; k < std::size(names); ++k) {
    if (k < parts.size()) {
      folder.Write(names[k], parts[k]);
    } else {
      std::filesystem::remove(folder.Path(names[k]), ignored);
    }
  }
  std::string image = "000002.png";
  if (parts.size() > 3) {
    image = parts[3].substr(0, 32);
    const bool plain = image.find_first_of(std::string("/\0", 2)) == std::string::npos;
    if (!plain || image.empty() || image == "." || image == "..") image = "000002.png";
  }
  for (const char* camera : {"image_0/", "image_1/"}) {
    const std::string path = "sequences/00/" + std::string(camera);
    std::filesystem::remove_all(folder.Path(path), ignored);
    folder.Write(path + image, "");
  }

  rigel::ImageSequence sequence;
  std::string error;
  if (rigel::ReadKittiSequence(folder.Path(""), "00", &sequence, &error)) {
    Require(sequence.cameras.size() == 2 && sequence.frames.size() > 0, "cameras and frames");
    rigel::Rig rig;
    for (const rigel::ImageCamera& camera : sequence.cameras) rig.cameras.push_back(camera.camera);
    Require(rig.IsValid(&error), "what was read is valid: " + error);
    for (const rigel::ImageFrame& frame : sequence.frames) {
      if (frame.world_from_body) Require(frame.world_from_body->AllFinite(), "finite poses");
    }
    for (const std::string& note : sequence.notes) rigel::fuzz::RequireMessage(note);
  } else {
    rigel::fuzz::RequireMessage(error);
  }
  if (parts.size() > 2) {
    std::vector<rigel::Pose> poses;
    if (rigel::ReadKittiPoses(folder.Path(names[2]), &poses, &error)) {
      for (const rigel::Pose& pose : poses) Require(pose.AllFinite(), "finite poses");
    } else {
      rigel::fuzz::RequireMessage(error);
    }
  }
  return 0;
}
