// How a sensor is turned against the body, as a user says it.
#ifndef RIGEL_PROBLEMS_SENSORS_MOUNTING_H_
#define RIGEL_PROBLEMS_SENSORS_MOUNTING_H_

#include <string>

#include <Eigen/Core>

namespace rigel {

// Four numbers are a unit quaternion w x y z, nine the rows of a rotation matrix. They are parted
// by commas or blanks. `text` has them or is the path of a file that has them, with comments after
// '#'. False with a message of one line if it is neither, or no rotation within 1e-3.
bool ReadMounting(const std::string& text, Eigen::Matrix3d* rotation, std::string* error);

}  // namespace rigel

#endif  // RIGEL_PROBLEMS_SENSORS_MOUNTING_H_
