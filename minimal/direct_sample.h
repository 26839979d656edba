// Four matches as constraints on the translation itself: what 4pt-lee, 4pt-liu and 4pt-sweeney
// share.
//
// Each match says n(a) . t + k(a) = 0 (prepared_matches.h), so (t, 1) is a null vector of a 4x4
// matrix whose determinant is a polynomial in the angle. Two structures are taken out of it:
//
// Deflation. If all matches are intra-camera and R = I is in the family, k vanishes at a = 0: the
// zero motion R = I, t = 0 satisfies the sample whatever the matches are. k is divided by
// z = tan(a/2) and the unknowns become (t, w'), w' = z w. A root that remains at 0 is true pure
// translation, with a direction and no scale (compare depth_system.h).
//
// Central samples. If all camera centres coincide, the baseline b = R s_i + t - s_j satisfies
// n . b = 0 and |b| is not determined: (t, 1) = (s_j - R s_i, 1) would be a null vector at any
// angle. The unknowns become (b, w), one match is left out and w = 0 takes its row.
#ifndef RIGEL_MINIMAL_DIRECT_SAMPLE_H_
#define RIGEL_MINIMAL_DIRECT_SAMPLE_H_

#include "rigel/minimal/prepared_matches.h"
#include "rigel/minimal/solutions.h"

namespace rigel {

class DirectSample {
 public:
  // `sample` holds four indices into `matches`, which must outlive this object.
  DirectSample(const PreparedMatches& matches, const int* sample);
  DirectSample(const DirectSample&) = delete;
  DirectSample& operator=(const DirectSample&) = delete;

  const ConstraintRow& operator[](int r) const { return *rows_[r]; }
  bool deflated() const { return deflated_; }

  // False if no match moves: nothing can be said of translation.
  bool has_parallax() const { return reference_->parallax2 > kNoParallax2; }

  // Adds the motion with z = tan(a/2): R exact from the angle, t from the null vector. Adds
  // nothing if that does not exist.
  void AddSolution(double z, Solutions* solutions) const;

 private:
  const PreparedMatches* matches_;
  const PreparedMatch* reference_;  // of largest parallax: decides the sign where |t| is not known
  bool deflated_;
  bool central_;
  const ConstraintRow* rows_[4];
  ConstraintRow central_rows_[4];  // set and used where the sample is central only
};

// The null vector of a 4x4 matrix of rank 3: the largest row of its adjugate. Zero if the rank is
// lower.
void NullVector4(const double m[4][4], double v[4]);

}  // namespace rigel

#endif  // RIGEL_MINIMAL_DIRECT_SAMPLE_H_
