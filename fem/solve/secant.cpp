#include "fem/solve/secant.hpp"

#include <cmath>

namespace brachium::fem {

double Secant::product(const Eigen::VectorXd& a, const Eigen::VectorXd& b) const {
  return leading_ < 0 ? a.dot(b) : a.head(leading_).dot(b.head(leading_));
}

Eigen::VectorXd Secant::step(Eigen::VectorXd z) const {
  if (steps_.empty()) return z;
  for (std::size_t j = 0; j + 1 < steps_.size(); ++j) {
    z += (product(steps_[j], z) / product(steps_[j], steps_[j])) * steps_[j + 1];
  }
  const Eigen::VectorXd& last = steps_.back();
  const double denominator = 1.0 - product(last, z) / product(last, last);
  if (std::abs(denominator) < 0.2) return z;  // the update would multiply the step beyond trust
  return z / denominator;
}

void Secant::taken(const Eigen::VectorXd& step) {
  if (product(step, step) == 0.0) return;
  if (steps_.size() == limit) steps_.clear();
  steps_.push_back(step);
}

}  // namespace brachium::fem
