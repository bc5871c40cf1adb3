#include "pipelines/stages/model_options.hpp"

#include <fmt/format.h>

#include "hill/curve_set.hpp"
#include "pipelines/stages/common.hpp"

namespace brachium::pipelines {

std::vector<OptionSpec> activation_option_specs() {
  return {
      choice_option("activation_form", "continuous", {"continuous", "recursive", "first_order"},
                    "continuous: exact solution of the second-order ODE; recursive: the field's difference "
                    "equation; first_order: Thelen 2003"),
      choice_option("nonlinearity", "exponential", {"exponential", "piecewise", "none"},
                    "from neural activation to muscle activation"),
      choice_option("start_up", "steady_state", {"steady_state", "rest", "ceinms"},
                    "what was before the first sample"),
  };
}

std::vector<OptionSpec> muscle_option_specs() {
  return {
      choice_option("curves", "degroote_fregly_2016",
                    {"degroote_fregly_2016", "thelen_2003", "millard_2012", "lloyd_2003", "lloyd_2003_spline",
                     "guenther_2007"},
                    "curve set: force-length, force-velocity, passive and tendon"),
      choice_option("tendon", "rigid", {"rigid", "elastic"},
                    "rigid: for l_slack/l_opt up to about 1; elastic: static equilibrium, a root per frame"),
      choice_option("fibre_velocity", "zero_lag", {"zero_lag", "causal", "none"},
                    "offline without lag, online from past frames, or f_v = 1"),
      choice_option("compatibility", "none", {"none", "ceinms"},
                    "whose conventions are followed where they differ from ours"),
      number_option("optimal_length_coupling", "", 0.0, between(0, 1),
                    "p of l_opt(a) = l_opt (1 + p (1 - a)); CEINMS: 0.15"),
  };
}

optimise::ModelChoice activation_choice(const Options& options) {
  optimise::ModelChoice model;
  model.activation.form = optimise::parse_activation_form(options.text("activation_form"));
  model.activation.nonlinearity = emg::parse_nonlinearity(options.text("nonlinearity"));
  model.activation.start_up = optimise::parse_start_up(options.text("start_up"));
  return model;
}

optimise::ModelChoice model_choice(const Options& options) {
  optimise::ModelChoice model = activation_choice(options);
  model.curves = options.text("curves");
  model.tendon = hill::parse_tendon(options.text("tendon"));
  model.fibre_velocity = hill::parse_fibre_velocity(options.text("fibre_velocity"));
  model.compatibility = hill::parse_compatibility(options.text("compatibility"));
  model.optimal_length_coupling = options.number("optimal_length_coupling");
  return model;
}

const data::Subject& subject_of(const StageData& data) {
  if (!data.subject) {
    throw data::InputError(
        "missing-subject", fmt::format("the output of `{}` holds no calibrated subject", data.stage),
        "wire this input to a stage optimise.calibrate, or to a file: `subject = \"file:...\"`");
  }
  return *data.subject;
}

std::vector<ExcitationChannel> excitation_channels(const StageData& excitation, const std::string& trial,
                                                   const data::Subject* subject) {
  const std::size_t t = trial_index(excitation, trial);
  const data::TrialInfo& info = excitation.signals->info().trials[t];
  std::vector<ExcitationChannel> channels;
  for (const std::size_t s : signals_of(info, data::Quantity::excitation)) {
    ExcitationChannel channel{s, info.signals[s], 1.0};
    const data::SignalInfo& c = channel.info;
    if (!channels.empty()) {
      const data::SignalInfo& first = channels.front().info;
      if (first.rate_hz != c.rate_hz || first.start_time_s != c.start_time_s || first.count != c.count) {
        throw data::InputError("rate-mismatch",
                               fmt::format("excitations `{}` and `{}` of trial `{}` are not on one time grid",
                                           first.name, c.name, trial),
                               "condition them to one `output_rate_hz`");
      }
    }
    if (subject && subject->channel_gains.contains(c.name)) {
      channel.gain = subject->channel_gains.at(c.name);
      channel.info.unit = "1";
    } else if (c.unit != "1") {
      throw data::InputError(
          "not-normalised",
          fmt::format("the envelope of `{}` in trial `{}` is in {}, and there is no gain for it", c.name,
                      trial, c.unit),
          "normalise it in emg.envelope, or wire a calibrated subject with its gain");
    }
    channels.push_back(std::move(channel));
  }
  if (channels.empty()) {
    throw data::InputError("missing-signal",
                           fmt::format("trial `{}` of `{}` has no excitation", trial, excitation.stage),
                           "wire this input to emg.envelope");
  }
  return channels;
}

std::vector<bool> use_of(const StageData& moment, const std::string& trial) {
  const std::size_t t = trial_index(moment, trial);
  const data::TrialInfo& info = moment.signals->info().trials[t];
  std::vector<bool> use;
  if (!info.has_signal("use")) return use;
  for (const double mark : moment.signals->read(t, info.signal_index("use"))) use.push_back(mark > 0.5);
  return use;
}

std::vector<optimise::CalibrationTrial> calibration_trials(const StageContext& context,
                                                           const data::Coordinate& coordinate,
                                                           const std::vector<std::string>& trials) {
  const StageData& excitation = context.input("excitation");
  const StageData& kinematics = context.input("kinematics");
  const StageData& moment = context.input("moment");
  std::vector<optimise::CalibrationTrial> out;
  for (const std::string& name : trials) {
    optimise::CalibrationTrial trial;
    trial.name = name;
    const std::size_t t = trial_index(excitation, name);
    for (const std::size_t s : signals_of(excitation.signals->info().trials[t], data::Quantity::excitation)) {
      trial.excitations.push_back(excitation.signals->signal(t, s));
    }
    trial.angle = signal_of(kinematics, name, data::Quantity::joint_angle, coordinate.name);
    if (has_signal_of(kinematics, name, data::Quantity::joint_velocity, coordinate.name)) {
      trial.velocity = signal_of(kinematics, name, data::Quantity::joint_velocity, coordinate.name);
    }
    if (!has_signal_of(moment, name, data::Quantity::joint_moment, coordinate.name)) {
      throw data::InputError(
          "missing-moment", fmt::format("trial `{}` has no reference moment for `{}`", name, coordinate.name),
          "add a stage limb.dynamometer or limb.inverse_dynamics, and wire `moment` to it");
    }
    trial.moment = signal_of(moment, name, data::Quantity::joint_moment, coordinate.name);
    trial.use = use_of(moment, name);
    out.push_back(std::move(trial));
  }
  return out;
}

}  // namespace brachium::pipelines
