#include "optimise/chain_setup.hpp"

#include <fmt/format.h>

#include <cmath>
#include <set>

#include "data/model/error.hpp"
#include "optimise/prepare.hpp"

namespace brachium::optimise {
namespace {

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

PreparedChain prepare_chain(data::Scene scene, const std::vector<CalibrationTrial>& trials,
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

  PreparedChain out;
  std::vector<std::shared_ptr<PreparedTrial>> prepared;
  for (const CalibrationTrial& trial : trials) {
    collect([&] {
      prepared.push_back(prepare_trial(trial, *chain, paths));
      out.samples.push_back(channel_samples(trial, chain->drive.channels));
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
    out.windows.push_back(trial->window);
    chain->trials.push_back(trial);
  }
  out.chain = std::move(chain);
  return out;
}

}  // namespace brachium::optimise
