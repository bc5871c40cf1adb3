#include "optimise/objective.hpp"

#include <algorithm>
#include <cmath>

#include "data/model/error.hpp"

namespace brachium::optimise {

Objective::Objective(const LeastSquaresProblem& problem)
    : problem_(problem),
      evaluator_(problem.evaluator()),
      lower_(lower_of(problem.parameters())),
      upper_(upper_of(problem.parameters())),
      scale_(scale_of(problem.parameters())),
      rows_(static_cast<Eigen::Index>(problem.residual_count())) {
  lower_ = scaled(lower_);
  upper_ = scaled(upper_);
  for (const Parameter& p : problem.parameters()) priors_ += p.prior ? 1 : 0;
}

bool Objective::evaluate(const Eigen::VectorXd& u, Eigen::VectorXd& r, Eigen::MatrixXd* J) {
  ++evaluations_;
  if (J) ++jacobians_;
  // u * s may leave the bounds by rounding: a model may refuse what lies outside.
  const Eigen::VectorXd x =
      unscaled(u).cwiseMax(lower_of(problem_.parameters())).cwiseMin(upper_of(problem_.parameters()));
  try {
    evaluator_->evaluate(x, r_, J ? &J_ : nullptr);
  } catch (const data::ConvergenceFailure& error) {
    ++failures_;
    failure_ = error.what();
    return false;
  }
  r.resize(rows());
  r.head(rows_) = r_;
  if (J) {
    J->resize(rows(), size());
    J->topRows(rows_) = J_ * scale_.asDiagonal();
    J->bottomRows(priors_).setZero();
  }
  Eigen::Index row = rows_;
  for (Eigen::Index j = 0; j < size(); ++j) {
    const auto& prior = problem_.parameters()[static_cast<std::size_t>(j)].prior;
    if (!prior) continue;
    r[row] = (x[j] - prior->mean) / prior->standard_deviation;
    if (J) (*J)(row, j) = scale_[j] / prior->standard_deviation;
    ++row;
  }
  if (!r.allFinite() || (J && !J->allFinite())) {
    ++failures_;
    failure_ = "the model gave a value that is not finite";
    return false;
  }
  return true;
}

double projected_gradient_norm(const Eigen::VectorXd& u, const Eigen::VectorXd& gradient,
                               const Eigen::VectorXd& lower, const Eigen::VectorXd& upper) {
  double norm = 0.0;
  for (Eigen::Index j = 0; j < u.size(); ++j) {
    const bool blocked = (u[j] <= lower[j] && gradient[j] > 0.0) || (u[j] >= upper[j] && gradient[j] < 0.0);
    if (!blocked) norm = std::max(norm, std::abs(gradient[j]));
  }
  return norm;
}

}  // namespace brachium::optimise
