// The residual of a match of one camera under a rotation alone: both components of its pixels.
#ifndef RIGEL_REFINE_LEAST_SQUARES_TURN_ROW_H_
#define RIGEL_REFINE_LEAST_SQUARES_TURN_ROW_H_

#include <Eigen/Core>

#include "rigel/core/eigen_types.h"
#include "rigel/core/row_point.h"

namespace rigel {

// Where the rotation takes the ray of time 1, less the ray of time 2: in the plane across the
// latter, over the standard deviations that the noise of both pixels gives it.
struct TurnRow {
  Eigen::Vector2d z;
  UnalignedMatrix<2, 3> by_turn;   // by d of R <- Exp(d) R
  UnalignedMatrix<2, 3> by_shift;  // by the motion of the camera over the depth of the point
};

// `A` takes the points of rows of the camera to directions in the body frame (GroupedMatches), R is
// the rotation of the body, `sigma` the noise of a pixel coordinate, pixels. False if the rays are
// more than 90 degrees apart, or a derivative is lost.
bool MakeTurnRow(const Eigen::Matrix3d& A, const RowPoint& point1, const RowPoint& point2,
                 const Eigen::Matrix3d& R, double sigma, TurnRow* row);

}  // namespace rigel

#endif  // RIGEL_REFINE_LEAST_SQUARES_TURN_ROW_H_
