#include "rigel/core/rays.h"

namespace rigel {

Ray MakeRay(const RigCamera& camera, const Pixel& pixel) {
  return {(camera.Q * AlongRay(camera.intrinsics, pixel)).normalized(), camera.s};
}

RayPair MakeRayPair(const Rig& rig, const Match& match) {
  return {MakeRay(rig.cameras[match.camera1], match.pixel1),
          MakeRay(rig.cameras[match.camera2], match.pixel2)};
}

}  // namespace rigel
