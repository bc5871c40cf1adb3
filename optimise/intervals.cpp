#include "optimise/intervals.hpp"

#include <Eigen/Cholesky>
#include <cmath>
#include <limits>

#include "data/model/parallel.hpp"
#include "optimise/objective.hpp"

namespace brachium::optimise {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kNearlyConstant = 0.05;  // of the precision along a side: one step is enough
constexpr int kSteps = 6;                 // of a side along which it changes

/// Lower Cholesky factor of J'J + P; what nothing sees is kept from being singular.
MatrixXd factor_of(const MatrixXd& J) {
  MatrixXd H = J.transpose() * J;
  H.diagonal().array() += 1e-12 * std::max(H.diagonal().maxCoeff(), 1e-300);
  return H.llt().matrixL();
}

/// The profile of one parameter, in scaled parameters.
class Profile {
 public:
  Profile(const LeastSquaresProblem& problem, const MatrixXd& W, Index j)
      : objective_(problem), W_(W), j_(j) {}

  /// du/dg = C e_j / sqrt(C_jj), so that u_j moves by one standard error a unit of g; `before` where the model
  /// has no value.
  VectorXd direction(const VectorXd& u, const VectorXd& before) {
    VectorXd r;
    MatrixXd J;
    if (!objective_.evaluate(u.cwiseMax(objective_.lower()).cwiseMin(objective_.upper()), r, &J))
      return before;
    const MatrixXd L = factor_of(J);
    const VectorXd back = L.triangularView<Eigen::Lower>().solve(VectorXd::Unit(u.size(), j_));
    const VectorXd column = L.transpose().triangularView<Eigen::Upper>().solve(W_ * back);
    const double variance = column[j_];
    if (!(variance > 0.0) || !column.allFinite()) return before;
    return column / std::sqrt(variance);
  }

  /// u_j at distance g (signed) from u, by Heun's method.
  double end(const VectorXd& u, const VectorXd& k0, double g) {
    const VectorXd k1 = direction(u + g * k0, k0);
    if (std::abs(k1[j_] - k0[j_]) < kNearlyConstant * k0[j_]) return u[j_] + 0.5 * g * (k0[j_] + k1[j_]);
    VectorXd at = u, k = k0;
    const double h = g / kSteps;
    for (int step = 0; step < kSteps; ++step) {
      const VectorXd ahead = direction(at + h * k, k);
      at += 0.5 * h * (k + ahead);
      if (step + 1 < kSteps) k = direction(at, ahead);
    }
    return at[j_];
  }

 private:
  Objective objective_;
  const MatrixXd& W_;
  Index j_;
};

}  // namespace

Intervals profile_intervals(const LeastSquaresProblem& problem, const VectorXd& x, const MatrixXd& covariance,
                            double quantile, std::size_t threads) {
  const Index n = x.size();
  const double infinity = std::numeric_limits<double>::infinity();
  Intervals out{VectorXd::Constant(n, -infinity), VectorXd::Constant(n, infinity)};
  if (!std::isfinite(quantile)) return out;
  const VectorXd scale = scale_of(problem.parameters()), u = x.cwiseQuotient(scale);
  VectorXd r;
  MatrixXd J;
  Objective objective(problem);
  const bool good = objective.evaluate(u, r, &J);
  const MatrixXd C0 = scale.cwiseInverse().asDiagonal() * covariance * scale.cwiseInverse().asDiagonal();
  const MatrixXd L0 = good ? factor_of(J) : MatrixXd::Identity(n, n);
  const MatrixXd W = L0.transpose() * C0 * L0;
  data::parallel_for(static_cast<std::size_t>(2 * n), threads, [&](std::size_t side) {
    const auto j = static_cast<Index>(side / 2);
    const double g = side % 2 == 0 ? -quantile : quantile, variance = C0(j, j);
    double& end = side % 2 == 0 ? out.lower[j] : out.upper[j];
    if (!(variance > 0.0) || !good) {
      end = scale[j] * (u[j] + g * std::sqrt(std::max(variance, 0.0)));
      return;
    }
    Profile profile(problem, W, j);
    end = scale[j] * profile.end(u, C0.col(j) / std::sqrt(variance), g);
  });
  return out;
}

}  // namespace brachium::optimise
