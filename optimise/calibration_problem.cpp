#include "optimise/calibration_problem.hpp"

#include <fmt/format.h>

#include <cmath>
#include <set>

#include "data/model/error.hpp"
#include "data/model/parallel.hpp"
#include "optimise/chain.hpp"
#include "optimise/prepare.hpp"

namespace brachium::optimise {

struct CalibrationProblem::Impl {
  std::shared_ptr<const Chain> chain;
  Samples samples;
  std::vector<TrialWindow> windows;
};

namespace {

class ChainEvaluator final : public Evaluator {
 public:
  ChainEvaluator(std::shared_ptr<const Chain> chain, CalibrationProblem::Samples samples)
      : chain_(std::move(chain)),
        samples_(std::move(samples)),
        runs_(chain_->trials.size() * chain_->muscles.size()) {}

  void evaluate(const Eigen::VectorXd& x, Eigen::VectorXd& residuals, Eigen::MatrixXd* jacobian) override {
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

  EvaluationCount count;

 private:
  void assemble(std::size_t t, const ChainValues& values, Eigen::VectorXd& residuals,
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

  /// Force derivative of muscle m with respect to what a target sets; null if m does not depend on it.
  const std::vector<double>* derivative_of(const Target& target, std::size_t t, std::size_t m) const {
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

  std::shared_ptr<const Chain> chain_;
  CalibrationProblem::Samples samples_;
  std::vector<MuscleRun> runs_;  ///< trial-major
};

/// The scene's muscles on the coordinate, with start values; recursion coefficients belong to the choice's
/// rate.
void set_up_muscles(Chain& chain, std::vector<data::Diagnostic>& found) {
  const ModelChoice& model = chain.options.model;
  const bool recursive = model.activation.form == emg::ActivationForm::recursive;
  if (model.activation.form == emg::ActivationForm::first_order)
    found.push_back({data::Severity::error,
                     "bad-parameter",
                     "`first_order` activation dynamics cannot be calibrated: it has no exact derivatives",
                     {},
                     "use `continuous` or `recursive`"});
  if (recursive && !(model.recursion_rate_hz > 0.0))
    found.push_back(
        {data::Severity::error,
         "bad-parameter",
         fmt::format("`recursion_rate_hz` {} must be positive: coefficients mean nothing without their rate",
                     model.recursion_rate_hz),
         {},
         {}});
  for (const data::SceneMuscle& muscle : chain.scene.muscles) {
    if (muscle.path.coordinate != chain.options.coordinate && !muscle.path.coordinate.empty()) continue;
    ChainValues::Muscle values{muscle.parameters, muscle.activation, 0.0, 0.0};
    if (recursive && model.recursion_rate_hz > 0.0) {
      values.recursion_1 =
          emg::recursion_coefficient(muscle.activation.time_constant_1_s, model.recursion_rate_hz);
      values.recursion_2 =
          emg::recursion_coefficient(muscle.activation.time_constant_2_s, model.recursion_rate_hz);
    }
    chain.muscles.push_back(muscle);
    chain.start.muscles.push_back(values);
  }
}

void set_up_drive(Chain& chain, const std::vector<CalibrationTrial>& trials) {
  std::vector<std::string> available;
  for (const data::Signal& signal : trials.front().excitations) available.push_back(signal.info.name);
  chain.drive = limb::drive_map(chain.scene, available);
  chain.weights.resize(static_cast<Eigen::Index>(chain.muscles.size()), chain.drive.weights.cols());
  for (std::size_t m = 0; m < chain.muscles.size(); ++m) {
    for (std::size_t row = 0; row < chain.drive.muscles.size(); ++row)
      if (chain.drive.muscles[row] == chain.muscles[m].name)
        chain.weights.row(static_cast<Eigen::Index>(m)) =
            chain.drive.weights.row(static_cast<Eigen::Index>(row));
    chain.driven.push_back(chain.weights.row(static_cast<Eigen::Index>(m)).cwiseAbs().sum() > 0.0);
  }
  for (const std::string& channel : chain.drive.channels) {
    const auto gain = chain.options.channel_gains.find(channel);
    chain.start.gains.push_back(gain == chain.options.channel_gains.end() ? 1.0 : gain->second);
    if (!(chain.start.gains.back() > 0.0))
      throw data::InputError("bad-parameter", fmt::format("gain {} of channel `{}` must be positive",
                                                          chain.start.gains.back(), channel));
  }
}

void set_up_slots(Chain& chain) {
  chain.slots.resize(chain.muscles.size());
  const auto add = [&](std::size_t m, Slot slot) {
    for (const Slot& known : chain.slots[m])
      if (known.quantity == slot.quantity && known.channel == slot.channel) return;
    chain.slots[m].push_back(slot);
  };
  for (const auto& targets : chain.free.targets) {
    for (const Target& target : targets) {
      if (target.quantity == Quantity::strength) continue;
      if (target.quantity != Quantity::gain) {
        add(target.index, {target.quantity, 0});
        continue;
      }
      for (std::size_t m = 0; m < chain.muscles.size(); ++m)
        if (chain.weights(static_cast<Eigen::Index>(m), static_cast<Eigen::Index>(target.index)) != 0.0)
          add(m, {Quantity::gain, target.index});
    }
  }
}

double pooled_deviation(const std::vector<std::shared_ptr<PreparedTrial>>& trials) {
  double sum = 0.0, count = 0.0, square = 0.0;
  for (const auto& trial : trials) {
    for (double value : trial->reference) sum += value;
    count += static_cast<double>(trial->reference.size());
  }
  for (const auto& trial : trials)
    for (double value : trial->reference) square += (value - sum / count) * (value - sum / count);
  return std::sqrt(square / count);
}

void set_scale(Chain& chain, const std::vector<std::shared_ptr<PreparedTrial>>& trials) {
  double largest = 0.0;
  for (const auto& trial : trials)
    for (double value : trial->reference) largest = std::max(largest, std::abs(value));
  chain.scale_N_m = chain.options.scale_N_m.value_or(pooled_deviation(trials));
  if (chain.options.scale_N_m && !(chain.scale_N_m > 0.0))
    throw data::InputError("out-of-range", fmt::format("`scale_N_m` {} must be positive", chain.scale_N_m));
  if (!chain.options.scale_N_m && !(chain.scale_N_m > 1e-9 * largest))
    throw data::InputError(
        "zero-variance-moment",
        fmt::format("the reference moment does not vary over the training trials (constant {:.6g} N m): "
                    "no scale can be taken from it",
                    trials.front()->reference.front()),
        "add trials in which the moment varies, or give `scale_N_m`");
}

}  // namespace

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
                                       CalibrationProblemOptions options) {
  if (trials.empty()) throw data::InputError("no-trials", "a calibration needs at least one trial");
  auto chain = std::make_shared<Chain>();
  chain->scene = std::move(scene);
  chain->options = std::move(options);
  std::vector<data::Diagnostic> found;
  const auto collect = [&](const auto& task) {
    try {
      task();
    } catch (const data::InputError& error) {
      found.insert(found.end(), error.diagnostics().begin(), error.diagnostics().end());
    }
  };
  if (chain->options.coordinate.empty()) {
    if (chain->scene.coordinates.size() != 1)
      throw data::InputError("missing-coordinate",
                             fmt::format("the scene has {} coordinates: say which one's moment is fitted",
                                         chain->scene.coordinates.size()));
    chain->options.coordinate = chain->scene.coordinates.front().name;
  }
  const data::Coordinate& coordinate = chain->scene.coordinate(chain->options.coordinate);
  if (chain->options.decimate == 0 || !(chain->options.edge_s >= 0.0))
    throw data::InputError("out-of-range", "`decimate` must be at least 1 and `edge_s` not negative");
  if (chain->options.independent_rate_hz && !(*chain->options.independent_rate_hz > 0.0))
    throw data::InputError("out-of-range", "`independent_rate_hz` must be positive");

  set_up_muscles(*chain, found);
  if (chain->muscles.empty())
    throw data::InputError("no-muscles",
                           fmt::format("no muscle of the scene acts on `{}`", chain->options.coordinate));
  chain->muscle_options = chain->options.model.muscle_options();
  std::vector<limb::MusclePath> paths;
  for (const data::SceneMuscle& muscle : chain->muscles) {
    collect([&] { paths.emplace_back(muscle.name, muscle.path, coordinate); });
    collect([&] { (void)hill::MuscleTendon(muscle.name, muscle.parameters, chain->muscle_options); });
  }
  std::set<std::string> names;
  for (const CalibrationTrial& trial : trials)
    if (!names.insert(trial.name).second)
      found.push_back({data::Severity::error,
                       "duplicate-trial",
                       fmt::format("trial `{}` stands twice in the training set", trial.name),
                       {},
                       "name each trial once"});
  collect([&] { set_up_drive(*chain, trials); });
  if (!found.empty()) throw data::InputError(std::move(found));

  chain->free = expand(chain->options.free, chain->muscles, chain->driven, chain->drive.channels,
                       chain->start, chain->options.model, found);
  collect([&] { check_parameters(chain->free.parameters); });
  set_up_slots(*chain);

  auto impl = std::make_shared<Impl>();
  std::vector<std::shared_ptr<PreparedTrial>> prepared;
  for (const CalibrationTrial& trial : trials) {
    collect([&] {
      prepared.push_back(prepare_trial(trial, *chain, paths));
      impl->samples.push_back(channel_samples(trial, chain->drive.channels));
    });
  }
  if (!found.empty()) throw data::InputError(std::move(found));
  set_scale(*chain, prepared);
  for (const auto& trial : prepared) {
    trial->first_row = chain->residual_count;
    chain->residual_count += trial->rows.size();
    const double row_rate = trial->frame_rate_hz / static_cast<double>(chain->options.decimate);
    const double share = chain->options.independent_rate_hz
                             ? std::min(1.0, *chain->options.independent_rate_hz / row_rate)
                             : 1.0;
    trial->weight = std::sqrt(share) / chain->scale_N_m;
    impl->windows.push_back(trial->window);
    chain->trials.push_back(trial);
  }
  impl->chain = std::move(chain);
  impl_ = std::move(impl);
}

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
