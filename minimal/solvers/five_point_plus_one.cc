#include "rigel/minimal/solvers/five_point_plus_one.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "rigel/core/cheirality.h"
#include "rigel/core/depth_terms.h"
#include "rigel/core/pose.h"
#include "rigel/minimal/solvers/five_point_essential.h"

namespace rigel {
namespace {

// Below this, relative to the rest, the sixth match says nothing about the scale: the rotation
// that it is multiplied by is known to a few digits less than a double has.
constexpr double kBlind = 1e-7;

// A rotation near a nearly orthogonal matrix, exact to rounding (Gram-Schmidt).
Eigen::Matrix3d Orthonormalized(const Eigen::Matrix3d& M) {
  Eigen::Matrix3d R;
  R.col(0) = M.col(0).normalized();
  R.col(1) = (M.col(1) - R.col(0).dot(M.col(1)) * R.col(0)).normalized();
  R.col(2) = R.col(0).cross(R.col(1));
  return R;
}

// R and the unit vector b of E = [b]x R up to sign that have most of the five points in front of
// both cameras. False if those are fewer than three: no motion, or five that do not agree.
bool Decompose(const Eigen::Matrix3d& E, const Eigen::Vector3d* x1, const Eigen::Vector3d* x2,
               Eigen::Matrix3d* R, Eigen::Vector3d* b) {
  // The columns of the cofactor matrix of [b]x R = b b'R are multiples of b.
  Eigen::Matrix3d cofactor;
  cofactor.col(0) = E.col(1).cross(E.col(2));
  cofactor.col(1) = E.col(2).cross(E.col(0));
  cofactor.col(2) = E.col(0).cross(E.col(1));
  int best = 0;
  for (int k = 1; k < 3; ++k) {
    if (cofactor.col(k).squaredNorm() > cofactor.col(best).squaredNorm()) best = k;
  }
  *b = cofactor.col(best).normalized();
  Eigen::Matrix3d bE;
  for (int k = 0; k < 3; ++k) bE.col(k) = b->cross(E.col(k));
  // b b'R - [b]x [b]x R = R; the other sign of b E gives (2 b b' - I) R.
  *R = cofactor - bE;

  int votes[4] = {};  // (R, b), (R, -b), (2bb'R - R, b), (2bb'R - R, -b)
  for (int k = 0; k < 5; ++k) {
    const Eigen::Vector3d g = *R * x1[k];
    const Eigen::Vector3d& f = x2[k];
    const DepthTerms d = DepthTermsOf(g[0], g[1], g[2], f[0], f[1], f[2], b->x(), b->y(), b->z());
    // The same with 2 (b.g) b - g for g.
    const Eigen::Vector3d fb = f.cross(*b);
    const double twice = 2.0 * b->dot(g);
    const double e1 = -twice * fb.squaredNorm() - d.n1;
    const double e2 = twice * g.cross(*b).dot(fb) + d.n2;
    votes[0] += d.n1 > kNoParallax && d.n2 > kNoParallax;
    votes[1] += d.n1 < -kNoParallax && d.n2 < -kNoParallax;
    votes[2] += e1 > kNoParallax && e2 > kNoParallax;
    votes[3] += e1 < -kNoParallax && e2 < -kNoParallax;
  }
  int choice = 0;
  for (int k = 1; k < 4; ++k) {
    if (votes[k] > votes[choice]) choice = k;
  }
  if (votes[choice] < 3) return false;
  if (choice >= 2) *R = cofactor + bE;
  if (choice % 2 == 1) *b = -*b;
  *R = Orthonormalized(*R);
  return true;
}

// The five constraints b . (R x1 x x2) = 0, linear in a left perturbation d of R and in b + T e:
// M[k][0..4] . (d, e) = M[k][5]. Returns the largest |M[k][5]|.
double Linearize(const Eigen::Vector3d* x1, const Eigen::Vector3d* x2, const Eigen::Matrix3d& R,
                 const Eigen::Vector3d& b, const Eigen::Matrix<double, 3, 2>& T, double (*M)[6]) {
  double largest = 0.0;
  for (int k = 0; k < 5; ++k) {
    const Eigen::Vector3d g = R * x1[k];
    const Eigen::Vector3d n = g.cross(x2[k]);
    const Eigen::Vector3d turn = g.cross(x2[k].cross(b));
    for (int i = 0; i < 3; ++i) M[k][i] = turn[i];
    M[k][3] = n.dot(T.col(0));
    M[k][4] = n.dot(T.col(1));
    M[k][5] = -n.dot(b);
    largest = std::max(largest, std::abs(M[k][5]));
  }
  return largest;
}

// Solves M[k][0..4] . d = M[k][5] by elimination with partial pivoting, in place; returns sum |d|,
// which is not finite if the rows are dependent.
double SolveFiveByFive(double (*M)[6], double* d) {
  for (int p = 0; p < 5; ++p) {
    int best = p;
    for (int r = p + 1; r < 5; ++r) {
      if (std::abs(M[r][p]) > std::abs(M[best][p])) best = r;
    }
    for (int k = p; k < 6; ++k) std::swap(M[p][k], M[best][k]);
    const double inverse = 1.0 / M[p][p];
    for (int r = p + 1; r < 5; ++r) {
      const double factor = M[r][p] * inverse;
      for (int k = p + 1; k < 6; ++k) M[r][k] -= factor * M[p][k];
    }
  }
  double size = 0.0;
  for (int p = 4; p >= 0; --p) {
    double sum = M[p][5];
    for (int k = p + 1; k < 5; ++k) sum -= M[p][k] * d[k];
    d[p] = sum / M[p][p];
    size += std::abs(d[p]);
  }
  return size;
}

// Newton steps on the five constraints b . (R x1 x x2) = 0 themselves. Rounding in the polynomial
// leaves an error above 1e-7 rad in one motion of a hundred.
void Refine(const Eigen::Vector3d* x1, const Eigen::Vector3d* x2, Eigen::Matrix3d* R,
            Eigen::Vector3d* b) {
  // Each step squares the error. Three take an error of 1e-3 to rounding; those of the polynomial's
  // roots are smaller.
  constexpr int kMaxSteps = 3;
  constexpr double kSolved = 1e-13;  // of a constraint, whose vectors have unit length: rounding
  // Radians. Larger steps occur at double roots. Then the start is as good.
  constexpr double kMaxStep = 0.1;
  for (int step = 0; step < kMaxSteps; ++step) {
    const Eigen::Matrix<double, 3, 2> T = TangentBasis(*b);
    double M[5][6];
    if (!(Linearize(x1, x2, *R, *b, T, M) > kSolved)) return;
    double d[5];
    if (!(SolveFiveByFive(M, d) < kMaxStep)) return;
    for (int k = 0; k < 3; ++k) {
      R->col(k) += Eigen::Vector3d(d[0], d[1], d[2]).cross(Eigen::Vector3d(R->col(k)));
    }
    *R = Orthonormalized(*R);
    *b = (*b + d[3] * T.col(0) + d[4] * T.col(1)).normalized();
  }
}

}  // namespace

int Solve5ptPlusOne(const PreparedMatches& matches, const int* sample, Solutions* solutions) {
  solutions->clear();
  const PreparedMatch& first = matches[sample[0]];
  Eigen::Vector3d x1[5], x2[5];
  for (int k = 0; k < 5; ++k) {
    const PreparedMatch& m = matches[sample[k]];
    if (m.camera1 != first.camera1 || m.camera2 != first.camera2) return 0;
    x1[k] = matches.rays(sample[k]).ray1.x;
    x2[k] = matches.rays(sample[k]).ray2.x;
  }
  const RayPair& five = matches.rays(sample[0]);
  const RayPair& sixth = matches.rays(sample[5]);
  const PreparedMatch& last = matches[sample[5]];
  if (!std::isfinite(last.parallax2)) return 0;
  const bool same_pair = last.camera1 == first.camera1 && last.camera2 == first.camera2;

  Eigen::Matrix3d E[kMaxEssentialMatrices];
  const int count = FivePointEssentialMatrices(x1, x2, E);
  for (int n = 0; n < count; ++n) {
    Eigen::Matrix3d R;
    Eigen::Vector3d b;
    if (!Decompose(E[n], x1, x2, &R, &b)) continue;
    Refine(x1, x2, &R, &b);

    // The sixth match: normal . (length b + arm) = 0, its own baseline in the brackets.
    double length = 1.0;
    bool has_scale = false;
    if (!same_pair) {
      const Eigen::Vector3d normal = (R * sixth.ray1.x).cross(sixth.ray2.x);
      const Eigen::Vector3d apart1 = sixth.ray1.s - five.ray1.s;
      const Eigen::Vector3d apart2 = sixth.ray2.s - five.ray2.s;
      const double along = normal.dot(b);
      const double across = -normal.dot(R * apart1 - apart2);
      const double size = apart1.norm() + apart2.norm();
      has_scale = std::abs(across) > kBlind * size * normal.norm() &&
                  std::abs(along) > kBlind * normal.norm() && across / along > 0;
      if (has_scale) length = across / along;
    }
    Solution& solution = solutions->Append();
    solution.R = R;
    solution.t = length * b - (R * five.ray1.s - five.ray2.s);
    solution.has_scale = has_scale;
  }
  return solutions->size();
}

}  // namespace rigel
