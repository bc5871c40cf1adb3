#pragma once
// A system of several branches.

#include <cmath>

#include "optimise/scenario.hpp"

namespace brachium::optimise::test {

// No muscles at work, all by the external moment: a pendulum with a spring that snaps, M = 4 sin(3 q) - q +
// L.
class Idle final : public limb::MuscleModel {
 public:
  const limb::ModelTraits& traits() const override { return traits_; }
  const std::vector<std::string>& coordinates() const override { return names_; }
  const std::vector<std::string>& muscles() const override { return names_; }
  void evaluate(const Eigen::VectorXd&, const Eigen::VectorXd&, const Eigen::VectorXd& a,
                const Eigen::VectorXd&, limb::Evaluation& e) const override {
    e.force = a;
    e.moment_arm = Eigen::MatrixXd::Constant(1, 1, 0.5);
    e.moment = 0.5 * a;
  }

 private:
  limb::ModelTraits traits_{"test", 0, false, false, false, false};
  std::vector<std::string> names_{"q"};
};

inline StaticSystem snapping(const Idle& idle) {
  StaticSystem s;
  s.model = &idle;
  s.load_arm = [](double) { return data::CurveValue{1.0, 0.0}; };
  s.external_moment = [](double q) {
    return data::CurveValue{4.0 * std::sin(3.0 * q) - q, 12.0 * std::cos(3.0 * q) - 1.0};
  };
  s.lower_rad = -3.0;
  s.upper_rad = 3.0;
  return s;
}

}  // namespace brachium::optimise::test
