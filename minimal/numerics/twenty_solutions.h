// The real solutions of a system of polynomials in three variables that has twenty, those near zero
// best, from the action of multiplication by the first one (polynomial_system.h makes it).
//
// The matrix of multiplication is reduced to Hessenberg form from the monomials 1, x, x^2, ... on.
// Their rows hold one entry each, so that this is less work than from the other end
// (action_matrix.h), and it leaves more digits of small roots in the characteristic polynomial.
// With 48 solutions it fails, as the powers of x are nearly dependent. The two reductions share no
// loop: this one eliminates along rows what the other eliminates along columns.
//
// Plain loops in a file of their own; every path gives the same bits (cpu_path.h). No heap.
#ifndef RIGEL_MINIMAL_NUMERICS_TWENTY_SOLUTIONS_H_
#define RIGEL_MINIMAL_NUMERICS_TWENTY_SOLUTIONS_H_

#include "rigel/core/cpu_path.h"
#include "rigel/minimal/numerics/action_matrix.h"

namespace rigel::polynomial_system {

// Writes the real solutions, at most twenty, and returns their number. `multiplicity` ones are
// known to be at x = 0 and left out: rounding would spread them, and telling them apart is the
// costliest part of all. Solutions may be off by more than rounding: an iteration on the original
// equations should follow. Destroys `action`.
int FindTwentySolutions(int multiplicity, ActionMatrix<20>* action, double (*solutions)[3],
                        CpuPath path = BestCpuPath());

}  // namespace rigel::polynomial_system

#endif  // RIGEL_MINIMAL_NUMERICS_TWENTY_SOLUTIONS_H_
