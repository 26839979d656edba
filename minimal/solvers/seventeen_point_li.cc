#include "rigel/minimal/solvers/seventeen_point_li.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <Eigen/Geometry>
#include <Eigen/SVD>

#include "rigel/core/cheirality.h"

namespace rigel {
namespace {

// Matches: each is one linear equation for the 18 entries of two matrices, known but for a factor.
constexpr int kSampleSize = 17;
// Below this fraction of the largest, a pivot is zero by the structure of the rig or the motion.
constexpr double kZeroByStructure = 1e-10;

// Columns of a tall matrix, reduced by Householder reflections; rows beyond kRows are folded into
// the triangle of those before.
template <int kCols>
class TallMatrix {
 public:
  static constexpr int kRows = 2 * kCols;

  // The next row, to be filled as at(row, 0..kCols-1).
  int AddRow() {
    if (rows_ == kRows) {
      for (int c = 0; c < kCols; ++c) Reflect(c, c, kCols);
      rows_ = kCols;
    }
    return rows_++;
  }
  double& at(int row, int column) { return columns_[column][row]; }
  double at(int row, int column) const { return columns_[column][row]; }
  int rows() const { return rows_; }

  // Column-pivoted QR of the columns [begin, end) from row `top` on; columns after `end` are
  // reflected too. `order` receives the columns as they were taken. Returns the rank.
  int Reduce(int top, int begin, int end, double negligible, int* order) {
    for (int c = begin; c < end; ++c) order[c] = c;
    double first = 0.0;
    int rank = 0;
    for (int c = begin; c < end && top + rank < rows_; ++c, ++rank) {
      double best = -1.0;
      int pivot = c;
      for (int k = c; k < end; ++k) {
        double norm2 = 0.0;
        for (int r = top + rank; r < rows_; ++r) norm2 += columns_[k][r] * columns_[k][r];
        if (norm2 > best) {
          best = norm2;
          pivot = k;
        }
      }
      if (rank == 0) first = best;
      if (!(best > negligible * negligible * first)) break;
      if (pivot != c) {
        std::swap_ranges(columns_[c], columns_[c] + rows_, columns_[pivot]);
        std::swap(order[c], order[pivot]);
      }
      Reflect(top + rank, c, kCols);
    }
    return rank;
  }

 private:
  // Makes column c zero below row `top` and applies the reflection to columns c + 1 .. end.
  void Reflect(int top, int c, int end) {
    double v[kRows];
    double norm2 = 0.0;
    for (int r = top; r < rows_; ++r) {
      v[r] = columns_[c][r];
      norm2 += v[r] * v[r];
    }
    if (!(norm2 > 0.0)) return;
    const double alpha = v[top] > 0 ? -std::sqrt(norm2) : std::sqrt(norm2);
    const double scale = 1.0 / (norm2 - alpha * v[top]);
    v[top] -= alpha;
    columns_[c][top] = alpha;
    for (int r = top + 1; r < rows_; ++r) columns_[c][r] = 0.0;
    for (int k = c + 1; k < end; ++k) {
      double dot = 0.0;
      for (int r = top; r < rows_; ++r) dot += v[r] * columns_[k][r];
      dot *= scale;
      for (int r = top; r < rows_; ++r) columns_[k][r] -= dot * v[r];
    }
  }

  int rows_ = 0;
  double columns_[kCols][kRows];
};

// The 9 x 9 triangle T of the columns from 9 on, its rows from `top` on.
class Triangle {
 public:
  Triangle(const TallMatrix<18>& a, int top) : a_(a), top_(top) {}

  double operator()(int r, int c) const { return a_.at(top_ + r, 9 + c); }
  int rows() const { return std::min(9, a_.rows() - top_); }

  // v with v[8] = 1 for which all rows but the last vanish.
  void NullVector(double* v) const {
    v[8] = 1.0;
    for (int r = 7; r >= 0; --r) {
      double sum = 0.0;
      for (int c = r + 1; c < 9; ++c) sum += (*this)(r, c) * v[c];
      v[r] = -sum / (*this)(r, r);
    }
  }

  // v <- (T'T)^-1 v.
  void SolveNormalEquations(double* v) const {
    for (int r = 0; r < 9; ++r) {
      double sum = v[r];
      for (int k = 0; k < r; ++k) sum -= (*this)(k, r) * v[k];
      v[r] = sum / (*this)(r, r);
    }
    for (int r = 8; r >= 0; --r) {
      double sum = v[r];
      for (int c = r + 1; c < 9; ++c) sum -= (*this)(r, c) * v[c];
      v[r] = sum / (*this)(r, r);
    }
  }

 private:
  const TallMatrix<18>& a_;
  int top_;
};

void Normalize(double (&v)[9]) {
  double norm2 = 0.0;
  for (double x : v) norm2 += x * x;
  const double inv = 1.0 / std::sqrt(norm2);
  for (double& x : v) x *= inv;
}

// The right singular vector of the smallest singular value of T, whose columns are in the given
// order: inverse iteration. Its entries are those of E, row by row.
bool SmallestSingularVector(const Triangle& T, const int* order, Eigen::Matrix3d* E) {
  // Relative to the first pivot: the last one is zero but for rounding, and the null vector exact.
  constexpr double kZeroPivot = 1e-13;
  // Each divides the error by the square of the ratio of the two least singular values.
  constexpr int kIterations = 4;
  double v[9];
  T.NullVector(v);
  if (T.rows() == 9 && std::abs(T(8, 8)) > kZeroPivot * std::abs(T(0, 0))) {
    for (int iteration = 0; iteration < kIterations; ++iteration) {
      Normalize(v);
      T.SolveNormalEquations(v);
    }
  }
  for (int c = 0; c < 9; ++c) {
    const int entry = order[9 + c] - 9;
    (*E)(entry / 3, entry % 3) = v[c];
  }
  const double norm = E->norm();
  *E /= norm;
  return norm > 0.0 && E->allFinite();
}

// t of the rotation R by least squares; its direction only if `central` or the rank says so.
// Returns the root of the sum of squared residuals, infinity if there is no t.
double SolveTranslation(const PreparedMatches& matches, const int* sample, int sample_size,
                        bool central, const Eigen::Matrix3d& R, Solution* solution) {
  TallMatrix<4> a;
  Eigen::Vector3d arm = Eigen::Vector3d::Zero();
  for (int m = 0; m < sample_size; ++m) {
    const Ray& ray1 = matches.rays(sample[m]).ray1;
    const Ray& ray2 = matches.rays(sample[m]).ray2;
    const Eigen::Vector3d n = (R * ray1.x).cross(ray2.x);
    const Eigen::Vector3d s = ray2.s - R * ray1.s;
    arm += s / sample_size;
    const int row = a.AddRow();
    for (int c = 0; c < 3; ++c) a.at(row, c) = n[c];
    a.at(row, 3) = n.dot(s);
  }
  int order[4];
  const int rank = a.Reduce(0, 0, 3, kZeroByStructure, order);
  if (rank < 2) return std::numeric_limits<double>::infinity();
  double residual2 = 0.0;
  for (int r = rank; r < a.rows(); ++r) residual2 += a.at(r, 3) * a.at(r, 3);
  solution->R = R;
  solution->has_scale = rank == 3 && !central;
  // Without scale the null vector (of the best rank 2 part) instead.
  double v[3] = {0.0, 0.0, 1.0};
  if (solution->has_scale) v[2] = a.at(2, 3) / a.at(2, 2);
  for (int r = 1; r >= 0; --r) {
    double sum = solution->has_scale ? a.at(r, 3) : 0.0;
    for (int c = r + 1; c < 3; ++c) sum -= a.at(r, c) * v[c];
    v[r] = sum / a.at(r, r);
  }
  for (int c = 0; c < 3; ++c) solution->t[order[c]] = v[c];
  if (!solution->has_scale) {
    const Eigen::Vector3d b = solution->t.normalized();
    int votes = 0;
    solution->t = arm + b;
    for (int m = 0; m < sample_size; ++m) {
      votes += CheiralityVote(*solution, matches.rays(sample[m]));
    }
    if (votes < 0) solution->t = arm - b;
  }
  return std::sqrt(residual2);
}

}  // namespace

int Solve17ptLi(const PreparedMatches& matches, const int* sample, Solutions* solutions) {
  return Solve17ptLi(matches, sample, kSampleSize, solutions);
}

int Solve17ptLi(const PreparedMatches& matches, const int* sample, int sample_size,
                Solutions* solutions) {
  solutions->clear();
  if (sample_size < kSampleSize) return 0;
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();
  for (int m = 0; m < sample_size; ++m) {
    const RayPair& rays = matches.rays(sample[m]);
    origin += rays.ray1.s + rays.ray2.s;
  }
  origin /= 2.0 * sample_size;

  TallMatrix<18> a;  // columns: R, then E, both row by row
  double largest_moment = 0.0;
  for (int m = 0; m < sample_size; ++m) {
    const RayPair& rays = matches.rays(sample[m]);
    const Eigen::Vector3d& x = rays.ray1.x;
    const Eigen::Vector3d& y = rays.ray2.x;
    const Eigen::Vector3d p = (rays.ray1.s - origin).cross(x);
    const Eigen::Vector3d q = (rays.ray2.s - origin).cross(y);
    largest_moment = std::max({largest_moment, p.squaredNorm(), q.squaredNorm()});
    const int row = a.AddRow();
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) {
        a.at(row, 3 * i + j) = y[i] * p[j] + q[i] * x[j];
        a.at(row, 9 + 3 * i + j) = y[i] * x[j];
      }
    }
  }
  int order[18];
  // One centre in all: no scale.
  const bool central = !(largest_moment > kZeroByStructure * kZeroByStructure);
  const int rank_R = central ? 0 : a.Reduce(0, 0, 9, kZeroByStructure, order);
  if (a.Reduce(rank_R, 9, 18, kZeroByStructure, order) < 8) return 0;
  Eigen::Matrix3d E;
  if (!SmallestSingularVector(Triangle(a, rank_R), order, &E)) return 0;

  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(E, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Matrix3d U = svd.matrixU();
  const Eigen::Matrix3d& V = svd.matrixV();
  if (U.determinant() * V.determinant() < 0) U.col(2) = -U.col(2);
  Eigen::Matrix3d W = Eigen::Matrix3d::Zero();
  W(2, 2) = 1.0;
  double residuals[2];
  for (const double sign : {1.0, -1.0}) {
    W(0, 1) = -sign;
    W(1, 0) = sign;
    Solution solution;
    const double residual =
        SolveTranslation(matches, sample, sample_size, central, U * W * V.transpose(), &solution);
    if (!std::isfinite(residual) || !solution.AllFinite()) continue;
    residuals[solutions->size()] = residual;
    solutions->Append() = solution;
  }
  if (solutions->size() == 2 && residuals[1] < residuals[0]) {
    std::swap((*solutions)[0], (*solutions)[1]);
  }
  return solutions->size();
}

}  // namespace rigel
