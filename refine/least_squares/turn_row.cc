#include "rigel/refine/least_squares/turn_row.h"

#include <Eigen/Cholesky>

#include "rigel/core/pose.h"

namespace rigel {

bool MakeTurnRow(const Eigen::Matrix3d& A, const RowPoint& point1, const RowPoint& point2,
                 const Eigen::Matrix3d& R, double sigma, TurnRow* row) {
  const Eigen::Matrix3d RA = R * A;
  const Eigen::Vector3d d1 = RA * point1.p, d2 = A * point2.p;
  const double n1 = d1.norm(), n2 = d2.norm();
  const Eigen::Vector3d y = d1 / n1, x = d2 / n2;
  if (!(x.dot(y) > 0)) return false;
  const Eigen::Matrix<double, 3, 2> B = TangentBasis(x);
  const Eigen::Matrix<double, 2, 3> across = B.transpose() - (B.transpose() * y) * y.transpose();
  const Eigen::Matrix2d by_pixel1 = across * RA * point1.J / n1;
  const Eigen::Matrix2d by_pixel2 = B.transpose() * A * point2.J / n2;
  const Eigen::Matrix2d S =
      sigma * sigma * (by_pixel1 * by_pixel1.transpose() + by_pixel2 * by_pixel2.transpose());
  const Eigen::LLT<Eigen::Matrix2d> llt(S);
  if (llt.info() != Eigen::Success) return false;
  row->z = llt.matrixL().solve(Eigen::Vector2d(B.transpose() * y));
  row->by_turn = llt.matrixL().solve(Eigen::Matrix<double, 2, 3>(-B.transpose() * Skew(y)));
  row->by_shift = llt.matrixL().solve(across);
  return row->z.allFinite();
}

}  // namespace rigel
