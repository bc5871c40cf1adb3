#pragma once
/// 95 % intervals that follow the model's curvature.
///
/// x_j +- t se_j takes the precision at the fitted value for the precision everywhere. Where a muscle works on
/// the steep part of a curve it is many times that of a little further on (the slack length of a flexor: ten
/// times within its bounds), and such an interval is confidently wrong on one side. Here the distance of a
/// value theta from the fitted one is measured along the profile of parameter j, each stretch in the standard
/// errors that hold there; the interval ends where the distance is t:
///
///     g(theta) = int dtheta' / se_j(x(theta')),   dx/dtheta' = C(x) e_j / C_jj(x),   |g| <= t
///     C(x) = L(x)^-T W L(x)^-1,   W = L0' C0 L0,   J'J + P = L L'
///
/// For one parameter and independent errors this is the likelihood-ratio interval; for several, the profile
/// likelihood (Venzon & Moolgavkar 1988, Applied Statistics 37, 87-94) with the profile's path integrated
/// instead of minimised for. W, what the full covariance C0 (autocorrelation, noise in the excitations) is
/// beyond the classical one, is taken as constant; C scales exactly with any change of a parameter's unit.
///
/// | symbol | identifier | unit              | meaning                                             |
/// |--------|------------|-------------------|-----------------------------------------------------|
/// | t      | quantile   | 1                 | of Student's t, two-sided                           |
/// | C0     | covariance | products of units | of the fitted values                                |
/// | L0, L  | -          | 1 / unit          | Cholesky factors of the information at x_fit, at x  |

#include <Eigen/Core>

#include "optimise/problem.hpp"

namespace brachium::optimise {

struct Intervals {
  Eigen::VectorXd lower, upper;  ///< n; may lie beyond the bounds, -inf and inf where t is not finite
};

/// Ends are good to about 2 % of their distance. Along the path, parameters that reach a bound stay there. Where the model has no value the last standard
/// error is kept. Two evaluations a side where the precision changes little, else up to a dozen; sides run in
/// parallel, and results do not depend on the number of threads.
Intervals profile_intervals(const LeastSquaresProblem& problem, const Eigen::VectorXd& x,
                            const Eigen::MatrixXd& covariance, double quantile, std::size_t threads = 1);

}  // namespace brachium::optimise
