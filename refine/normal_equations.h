// The normal equations of one camera pair's Sampson errors by the parameters of a motion.
#ifndef RIGEL_REFINE_NORMAL_EQUATIONS_H_
#define RIGEL_REFINE_NORMAL_EQUATIONS_H_

#include <Eigen/Core>

#include "rigel/refine/epipolar_residuals.h"
#include "rigel/refine/sampson_kernel.h"

namespace rigel {

// Of at most six parameters: no heap.
using ParameterVector = Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, 6, 1>;
using ParameterMatrix =
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, 6, 6>;

// Adds what SumSampson() gives for the matches, turned from the entries of F into the n parameters
// that `linear` has the derivatives of. `gradient` has n entries, `curvature` n x n.
void AddNormalEquations(const SampsonKernelOptions& options, const GroupLinearization& linear,
                        const PixelArrays& pixels, const double* weights, double* cost,
                        ParameterVector* gradient, ParameterMatrix* curvature);

}  // namespace rigel

#endif  // RIGEL_REFINE_NORMAL_EQUATIONS_H_
