// What a rig takes of COLMAP's text models: cameras.txt and images.txt.
//
// Source: COLMAP's doc/format.rst and doc/cameras.rst.
#ifndef RIGEL_PROBLEMS_RIGS_COLMAP_MODEL_H_
#define RIGEL_PROBLEMS_RIGS_COLMAP_MODEL_H_

#include <map>
#include <string>
#include <vector>

#include "rigel/core/camera.h"

namespace rigel {

// A lens by COLMAP's name of its model, in capitals, with the principal point in Rigel's pixels.
// Throws std::exception with what was expected.
Camera ColmapLens(const std::string& model, const std::vector<double>& parameters);

// The lenses of cameras.txt by their CAMERA_ID. False with a message of one line if it is no such.
bool ReadColmapCameras(const std::string& path, std::map<int, Camera>* cameras, std::string* error);

// The first image of each camera in images.txt. Lines are IMAGE_ID QW QX QY QZ TX TY TZ CAMERA_ID
// NAME, each followed by one of points. False with a message of one line if it is no such.
bool ReadColmapImages(const std::string& path, std::map<int, std::string>* images,
                      std::string* error);

}  // namespace rigel

#endif  // RIGEL_PROBLEMS_RIGS_COLMAP_MODEL_H_
