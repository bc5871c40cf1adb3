#include "optimise/chain_evaluator.hpp"

#include "data/model/parallel.hpp"

namespace brachium::optimise {

ChainEvaluator::ChainEvaluator(std::shared_ptr<const Chain> chain, CalibrationProblem::Samples samples)
    : chain_(std::move(chain)),
      samples_(std::move(samples)),
      runs_(chain_->trials.size() * chain_->muscles.size()) {}

void ChainEvaluator::evaluate(const Eigen::VectorXd& x, Eigen::VectorXd& residuals,
                              Eigen::MatrixXd* jacobian) {
  const Chain& chain = *chain_;
  const std::size_t muscles = chain.muscles.size();
  const ChainValues values = chain.free.apply(chain.start, x);
  std::vector<unsigned char> ran(runs_.size(), 0);
  data::parallel_for(runs_.size(), chain.options.threads, [&](std::size_t task) {
    const std::size_t t = task / muscles, m = task % muscles;
    ran[task] =
        runs_[task].update(chain, m, *chain.trials[t], samples_[t], values, jacobian != nullptr) ? 1 : 0;
  });
  ++count.points;
  for (unsigned char one : ran) ++(one ? count.muscle_trials : count.reused);

  residuals.resize(static_cast<Eigen::Index>(chain.residual_count));
  if (jacobian) jacobian->resize(residuals.size(), static_cast<Eigen::Index>(chain.free.parameters.size()));
  data::parallel_for(chain.trials.size(), chain.options.threads,
                     [&](std::size_t t) { assemble(t, values, residuals, jacobian); });
}

void ChainEvaluator::assemble(std::size_t t, const ChainValues& values, Eigen::VectorXd& residuals,
                              Eigen::MatrixXd* jacobian) const {
  const Chain& chain = *chain_;
  const PreparedTrial& trial = *chain.trials[t];
  const std::size_t muscles = chain.muscles.size();
  const auto first = static_cast<Eigen::Index>(trial.first_row);
  for (std::size_t i = 0; i < trial.rows.size(); ++i) {
    const std::size_t frame = trial.rows[i];
    double moment = 0.0;
    for (std::size_t m = 0; m < muscles; ++m)
      moment += values.muscles[m].parameters.strength * trial.arm_m[m][frame] *
                runs_[t * muscles + m].force()[frame];
    residuals[first + static_cast<Eigen::Index>(i)] = trial.weight * (moment - trial.reference[i]);
  }
  if (!jacobian) return;
  for (std::size_t j = 0; j < chain.free.parameters.size(); ++j) {
    auto column = jacobian->col(static_cast<Eigen::Index>(j))
                      .segment(first, static_cast<Eigen::Index>(trial.rows.size()));
    column.setZero();
    for (const Target& target : chain.free.targets[j]) {
      for (std::size_t m = 0; m < muscles; ++m) {
        const std::vector<double>* derivative = derivative_of(target, t, m);
        if (!derivative) continue;
        const bool strength = target.quantity == Quantity::strength;
        const double factor =
            trial.weight * target.slope() * (strength ? 1.0 : values.muscles[m].parameters.strength);
        for (std::size_t i = 0; i < trial.rows.size(); ++i)
          column[static_cast<Eigen::Index>(i)] +=
              factor * trial.arm_m[m][trial.rows[i]] * (*derivative)[trial.rows[i]];
      }
    }
  }
}

const std::vector<double>* ChainEvaluator::derivative_of(const Target& target, std::size_t t,
                                                         std::size_t m) const {
  const MuscleRun& run = runs_[t * chain_->muscles.size() + m];
  const bool gain = target.quantity == Quantity::gain;
  if (!gain && target.index != m) return nullptr;
  if (target.quantity == Quantity::strength) return &run.force();
  const auto& slots = chain_->slots[m];
  for (std::size_t s = 0; s < slots.size(); ++s)
    if (slots[s].quantity == target.quantity && (!gain || slots[s].channel == target.index))
      return &run.dforce(s);
  return nullptr;
}

}  // namespace brachium::optimise
