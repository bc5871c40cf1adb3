#pragma once
/// Residuals and their derivatives over all trials of a calibration. Internal to optimise/.

#include <memory>
#include <vector>

#include "optimise/chain.hpp"

namespace brachium::optimise {

class ChainEvaluator final : public Evaluator {
 public:
  ChainEvaluator(std::shared_ptr<const Chain> chain, CalibrationProblem::Samples samples);

  void evaluate(const Eigen::VectorXd& x, Eigen::VectorXd& residuals, Eigen::MatrixXd* jacobian) override;

  EvaluationCount count;

 private:
  void assemble(std::size_t t, const ChainValues& values, Eigen::VectorXd& residuals,
                Eigen::MatrixXd* jacobian) const;
  /// Force derivative of muscle m with respect to what a target sets; null if m does not depend on it.
  const std::vector<double>* derivative_of(const Target& target, std::size_t t, std::size_t m) const;

  std::shared_ptr<const Chain> chain_;
  CalibrationProblem::Samples samples_;
  std::vector<MuscleRun> runs_;  ///< trial-major
};

}  // namespace brachium::optimise
