#include "optimise/calibration_problem.hpp"

#include <fmt/format.h>

#include "data/model/error.hpp"
#include "optimise/chain_evaluator.hpp"
#include "optimise/chain_setup.hpp"

namespace brachium::optimise {

struct CalibrationProblem::Impl : PreparedChain {};

CalibrationTrial calibration_trial(const data::Trial& trial, const std::string& coordinate) {
  CalibrationTrial out;
  out.name = trial.name;
  bool angle = false, moment = false;
  for (const data::Signal& signal : trial.signals) {
    const auto& info = signal.info;
    const bool ours = info.coordinate.empty() || coordinate.empty() || info.coordinate == coordinate;
    if (info.quantity == data::Quantity::excitation) out.excitations.push_back(signal);
    if (!ours) continue;
    if (info.quantity == data::Quantity::joint_angle && !angle) {
      out.angle = signal;
      angle = true;
    }
    if (info.quantity == data::Quantity::joint_velocity && !out.velocity) out.velocity = signal;
    if (info.quantity == data::Quantity::joint_moment && !moment) {
      out.moment = signal;
      moment = true;
    }
  }
  std::vector<data::Diagnostic> found;
  if (out.excitations.empty())
    found.push_back({data::Severity::error,
                     "missing-signal",
                     fmt::format("trial `{}` has no excitation", trial.name),
                     {},
                     {}});
  if (!angle)
    found.push_back({data::Severity::error,
                     "missing-signal",
                     fmt::format("trial `{}` has no joint angle of `{}`", trial.name, coordinate),
                     {},
                     {}});
  if (!moment)
    found.push_back({data::Severity::error,
                     "missing-moment",
                     fmt::format("trial `{}` has no reference moment", trial.name),
                     {},
                     "wire a measured moment or one from inverse dynamics, or leave the trial out"});
  if (!found.empty()) throw data::InputError(std::move(found));
  return out;
}

CalibrationProblem::CalibrationProblem(std::shared_ptr<const Impl> impl) : impl_(std::move(impl)) {}
CalibrationProblem::~CalibrationProblem() = default;

CalibrationProblem::CalibrationProblem(data::Scene scene, std::vector<CalibrationTrial> trials,
                                       CalibrationProblemOptions options)
    : impl_(std::make_shared<Impl>(Impl{prepare_chain(std::move(scene), trials, std::move(options))})) {}

const std::vector<Parameter>& CalibrationProblem::parameters() const {
  return impl_->chain->free.parameters;
}
std::size_t CalibrationProblem::residual_count() const {
  return impl_->chain->residual_count;
}

std::string CalibrationProblem::residual_name(std::size_t i) const {
  for (const auto& trial : impl_->chain->trials)
    if (i < trial->first_row + trial->rows.size())
      return fmt::format("trial `{}`, {:.3f} s", trial->name,
                         trial->frame_time_s[trial->rows[i - trial->first_row]]);
  return fmt::format("residual {}", i);
}

std::unique_ptr<Evaluator> CalibrationProblem::evaluator() const {
  return std::make_unique<ChainEvaluator>(impl_->chain, impl_->samples);
}

EvaluationCount CalibrationProblem::count(const Evaluator& evaluator) {
  return dynamic_cast<const ChainEvaluator&>(evaluator).count;
}

const data::Scene& CalibrationProblem::scene() const {
  return impl_->chain->scene;
}
const CalibrationProblemOptions& CalibrationProblem::options() const {
  return impl_->chain->options;
}
const std::vector<TrialWindow>& CalibrationProblem::windows() const {
  return impl_->windows;
}
const std::vector<std::string>& CalibrationProblem::channels() const {
  return impl_->chain->drive.channels;
}
const std::vector<std::string>& CalibrationProblem::undriven() const {
  return impl_->chain->drive.undriven;
}
double CalibrationProblem::scale_N_m() const {
  return impl_->chain->scale_N_m;
}
double CalibrationProblem::residual_weight(std::size_t trial) const {
  return impl_->chain->trials.at(trial)->weight;
}
const CalibrationProblem::Samples& CalibrationProblem::excitations() const {
  return impl_->samples;
}
double CalibrationProblem::excitation_rate_hz(std::size_t trial) const {
  return impl_->chain->trials.at(trial)->excitation_rate_hz;
}

CalibrationProblem CalibrationProblem::with_excitations(Samples samples) const {
  auto impl = std::make_shared<Impl>(*impl_);
  if (samples.size() != impl->samples.size())
    throw data::InputError("wrong-size", "excitations of every trial are needed");
  for (std::size_t t = 0; t < samples.size(); ++t) {
    bool same = samples[t].size() == impl->samples[t].size();
    for (std::size_t k = 0; same && k < samples[t].size(); ++k)
      same = samples[t][k].size() == impl->samples[t][k].size();
    if (!same)
      throw data::InputError("wrong-size", fmt::format("excitations of trial `{}` are not on its grid",
                                                       impl->chain->trials[t]->name));
  }
  impl->samples = std::move(samples);
  return CalibrationProblem(std::move(impl));
}

std::vector<ResidualBlock> CalibrationProblem::blocks() const {
  std::vector<ResidualBlock> out;
  // A gap in a trial's rows ends a block: correlation is sought inside, never across.
  for (const auto& trial : impl_->chain->trials) {
    for (std::size_t i = 0; i < trial->rows.size(); ++i) {
      if (i == 0 || trial->rows[i] - trial->rows[i - 1] != impl_->chain->options.decimate) {
        out.push_back({trial->name, trial->first_row + i, 0});
      }
      ++out.back().count;
    }
  }
  return out;
}

std::vector<double> CalibrationProblem::times_s(std::size_t trial) const {
  const PreparedTrial& t = *impl_->chain->trials.at(trial);
  std::vector<double> out;
  for (std::size_t row : t.rows) out.push_back(t.frame_time_s[row]);
  return out;
}

std::vector<double> CalibrationProblem::reference_N_m(std::size_t trial) const {
  return impl_->chain->trials.at(trial)->reference;
}

std::vector<double> CalibrationProblem::modelled_N_m(std::size_t trial,
                                                     const Eigen::VectorXd& residuals) const {
  const PreparedTrial& t = *impl_->chain->trials.at(trial);
  std::vector<double> out(t.reference);
  for (std::size_t i = 0; i < out.size(); ++i)
    out[i] += residuals[static_cast<Eigen::Index>(t.first_row + i)] / t.weight;
  return out;
}

std::vector<double> CalibrationProblem::frame_times_s(std::size_t trial) const {
  return impl_->chain->trials.at(trial)->frame_time_s;
}

std::vector<MuscleTraces> CalibrationProblem::muscle_traces(std::size_t trial,
                                                            const Eigen::VectorXd& x) const {
  const Chain& chain = *impl_->chain;
  const PreparedTrial& t = *chain.trials.at(trial);
  const ChainValues values = chain.free.apply(chain.start, x);
  std::vector<MuscleTraces> out;
  for (std::size_t m = 0; m < chain.muscles.size(); ++m) {
    MuscleRun run;
    run.update(chain, m, t, impl_->samples[trial], values, false);
    MuscleTraces traces{chain.muscles[m].name, run.activation(), run.force(), run.force(),
                        run.trace().fibre_length_m};
    for (std::size_t i = 0; i < traces.force_N.size(); ++i) {
      traces.force_N[i] *= values.muscles[m].parameters.strength;
      traces.moment_N_m[i] = t.arm_m[m][i] * traces.force_N[i];
    }
    out.push_back(std::move(traces));
  }
  return out;
}

data::Subject CalibrationProblem::subject(const Eigen::VectorXd& x) const {
  const Chain& chain = *impl_->chain;
  const ChainValues values = chain.free.apply(chain.start, x);
  data::Subject subject;
  subject.model = chain.options.model.to_map();
  for (std::size_t m = 0; m < chain.muscles.size(); ++m) {
    data::SubjectMuscle muscle{chain.muscles[m].name, chain.muscles[m].group, values.muscles[m].parameters,
                               values.muscles[m].activation};
    if (chain.options.model.activation.form == emg::ActivationForm::recursive) {
      const double rate = chain.options.model.recursion_rate_hz;
      muscle.activation.time_constant_1_s = emg::time_constant(values.muscles[m].recursion_1, rate);
      muscle.activation.time_constant_2_s = emg::time_constant(values.muscles[m].recursion_2, rate);
    }
    subject.muscles.push_back(std::move(muscle));
  }
  for (std::size_t k = 0; k < values.gains.size(); ++k)
    subject.channel_gains[chain.drive.channels[k]] = values.gains[k];
  return subject;
}

std::vector<std::size_t> CalibrationProblem::strength_parameters() const {
  std::vector<std::size_t> out;
  for (std::size_t j = 0; j < parameters().size(); ++j)
    if (parameters()[j].name == "strength") out.push_back(j);
  return out;
}

std::vector<std::pair<std::size_t, std::size_t>> CalibrationProblem::gain_strength_pairs() const {
  const Chain& chain = *impl_->chain;
  const auto drives = [&](const std::vector<Target>& gains, const std::vector<Target>& strengths) {
    for (const Target& gain : gains)
      for (const Target& strength : strengths)
        if (gain.quantity == Quantity::gain && strength.quantity == Quantity::strength &&
            chain.weights(static_cast<Eigen::Index>(strength.index), static_cast<Eigen::Index>(gain.index)) !=
                0.0)
          return true;
    return false;
  };
  std::vector<std::pair<std::size_t, std::size_t>> out;
  for (std::size_t g = 0; g < parameters().size(); ++g)
    for (std::size_t s = 0; s < parameters().size(); ++s)
      if (!parameters()[g].prior && !parameters()[s].prior &&
          drives(chain.free.targets[g], chain.free.targets[s]))
        out.emplace_back(g, s);
  return out;
}

}  // namespace brachium::optimise
