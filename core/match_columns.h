// What is known about the matches of a frame pair besides their pixels.
#ifndef RIGEL_CORE_MATCH_COLUMNS_H_
#define RIGEL_CORE_MATCH_COLUMNS_H_

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace rigel {

// Each vector is empty if nothing is known of that kind; else it has one entry for each match, in
// their order. The columns of a match file (docs/formats.md).
struct MatchColumns {
  std::vector<int64_t> landmark;       // matches of one number see one point
  std::vector<double> sigma1, sigma2;  // pixels, 1 sigma of each point; > 0
  std::vector<double> depth1;          // metres along the ray of camera1 at time 1; 0: unknown
  std::vector<double> depth_sigma;     // 1 sigma, a fraction of the depth; > 0
  std::vector<std::array<double, 4>> affine;  // d(pixel2)/d(pixel1), row by row; all zero: unknown
  std::vector<double> affine_sigma;           // 1 sigma, a fraction; > 0
  // Known in simulations only.
  std::vector<char> inlier;                  // 1 or 0
  std::vector<std::array<double, 4>> exact;  // u, v, u2, v2 without noise

  // False with a message if a vector is not empty and has not `num_matches` entries, or if an entry
  // is out of its range. Numbers must be finite, sigmas positive, depths not negative. An affine
  // frame has a positive determinant, or is all zero.
  bool IsValid(size_t num_matches, std::string* error) const;

  // The columns of the matches `rows`, in that order.
  MatchColumns Subset(const std::vector<size_t>& rows) const;
};

}  // namespace rigel

#endif  // RIGEL_CORE_MATCH_COLUMNS_H_
