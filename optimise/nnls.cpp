#include "optimise/nnls.hpp"

#include <fmt/format.h>

#include <Eigen/QR>
#include <cmath>
#include <limits>
#include <vector>

#include "data/model/error.hpp"

namespace brachium::optimise {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

void check(const MatrixXd& A, const VectorXd& b, const VectorXd& lower, const VectorXd& upper) {
  if (A.rows() != b.size() || A.cols() != lower.size() || A.cols() != upper.size())
    throw data::InputError("wrong-size",
                           fmt::format("a {} x {} matrix does not fit {} data, {} lower and {} upper bounds",
                                       A.rows(), A.cols(), b.size(), lower.size(), upper.size()));
  if (!A.allFinite() || !b.allFinite()) throw data::InputError("not-finite", "matrix or data are not finite");
  for (Index j = 0; j < lower.size(); ++j)
    if (!(lower[j] <= upper[j]))
      throw data::InputError(
          "bad-bounds",
          fmt::format("unknown {}: lower bound {} is above the upper bound {}", j, lower[j], upper[j]));
}

enum class State { free, at_lower, at_upper };

}  // namespace

LinearFit bounded_least_squares(const MatrixXd& A, const VectorXd& b, const VectorXd& lower,
                                const VectorXd& upper) {
  check(A, b, lower, upper);
  const Index n = A.cols();
  // Every unknown starts at its finite bound nearest to zero; one without bounds starts free, at zero.
  VectorXd x(n);
  std::vector<State> state(static_cast<std::size_t>(n), State::free);
  for (Index j = 0; j < n; ++j) {
    const bool low = std::isfinite(lower[j]), high = std::isfinite(upper[j]);
    const bool use_low = low && (!high || std::abs(lower[j]) <= std::abs(upper[j]));
    if (use_low)
      state[static_cast<std::size_t>(j)] = State::at_lower;
    else if (high)
      state[static_cast<std::size_t>(j)] = State::at_upper;
    x[j] = use_low ? lower[j] : (high ? upper[j] : 0.0);
  }
  const double tolerance = 1e-12 * std::max(1e-300, (A.transpose() * b).lpNorm<Eigen::Infinity>());
  LinearFit fit;
  bool unbounded_left = false;
  for (State s : state) unbounded_left = unbounded_left || s == State::free;
  while (true) {
    const VectorXd w = A.transpose() * (b - A * x);  // downhill direction of each unknown
    Index pick = -1;
    double best = tolerance;
    for (Index j = 0; j < n; ++j) {
      const State s = state[static_cast<std::size_t>(j)];
      const double gain = s == State::at_lower ? w[j] : (s == State::at_upper ? -w[j] : 0.0);
      if (s != State::free && gain > best && lower[j] < upper[j]) {
        best = gain;
        pick = j;
      }
    }
    if (pick < 0 && !unbounded_left) break;
    unbounded_left = false;
    if (pick >= 0) state[static_cast<std::size_t>(pick)] = State::free;
    while (true) {
      if (++fit.iterations > 30 * n + 30)
        throw data::ConvergenceFailure({"bounded linear least squares",
                                        "the active set keeps changing",
                                        fit.iterations,
                                        (A * x - b).norm(),
                                        0.0,
                                        {}});
      std::vector<Index> free;
      VectorXd rhs = b;
      for (Index j = 0; j < n; ++j) {
        if (state[static_cast<std::size_t>(j)] == State::free)
          free.push_back(j);
        else
          rhs -= A.col(j) * x[j];
      }
      if (free.empty()) break;
      MatrixXd F(A.rows(), static_cast<Index>(free.size()));
      for (std::size_t k = 0; k < free.size(); ++k) F.col(static_cast<Index>(k)) = A.col(free[k]);
      const VectorXd z = F.completeOrthogonalDecomposition().solve(rhs);
      // As far towards z as the bounds allow.
      double alpha = 1.0;
      Index blocker = -1;
      for (std::size_t k = 0; k < free.size(); ++k) {
        const Index j = free[k];
        const double target = z[static_cast<Index>(k)];
        const double bound = target < lower[j] ? lower[j] : (target > upper[j] ? upper[j] : target);
        if (bound == target) continue;
        const double a = (bound - x[j]) / (target - x[j]);
        if (a < alpha || blocker < 0) {
          alpha = std::min(alpha, std::max(a, 0.0));
          blocker = j;
        }
      }
      for (std::size_t k = 0; k < free.size(); ++k)
        x[free[k]] += alpha * (z[static_cast<Index>(k)] - x[free[k]]);
      if (blocker < 0) break;
      const bool low = std::abs(x[blocker] - lower[blocker]) <= std::abs(x[blocker] - upper[blocker]);
      x[blocker] = low ? lower[blocker] : upper[blocker];
      state[static_cast<std::size_t>(blocker)] = low ? State::at_lower : State::at_upper;
      if (blocker == pick) break;  // no progress possible in this direction
    }
  }
  fit.x = x;
  fit.residual_norm = (A * x - b).norm();
  return fit;
}

LinearFit nnls(const MatrixXd& A, const VectorXd& b) {
  return bounded_least_squares(A, b, VectorXd::Zero(A.cols()),
                               VectorXd::Constant(A.cols(), std::numeric_limits<double>::infinity()));
}

}  // namespace brachium::optimise
