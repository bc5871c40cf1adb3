#include "optimise/twin.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "data/limb/bodies.hpp"
#include "data/limb/drive.hpp"
#include "data/limb/muscle_path.hpp"
#include "data/model/error.hpp"
#include "emg/random.hpp"
#include "optimise/excitation_error.hpp"
#include "optimise/twin_programme.hpp"

namespace brachium::optimise {
namespace {

using Recorded = data::Quantity;
constexpr double kDeg = 3.14159265358979323846 / 180.0;

data::Signal signal(const std::string& name, Recorded quantity, const std::string& unit, double rate_hz,
                    std::vector<double> samples) {
  data::Signal out;
  out.info.name = name;
  out.info.quantity = quantity;
  out.info.unit = unit;
  out.info.rate_hz = rate_hz;
  out.info.count = samples.size();
  out.info.attributes["source"] = "synthetic twin";
  out.samples = std::move(samples);
  return out;
}

void check(const TwinOptions& options, const data::Coordinate& coordinate) {
  std::vector<data::Diagnostic> found;
  const auto need = [&](bool good, const std::string& message) {
    if (!good) found.push_back({data::Severity::error, "out-of-range", message, {}, {}});
  };
  need(options.motion_rate_hz > 0.0 && std::isfinite(options.motion_rate_hz),
       fmt::format("`motion_rate_hz` {} must be positive", options.motion_rate_hz));
  need(options.excitation_rate_hz > 0.0 && std::isfinite(options.excitation_rate_hz),
       fmt::format("`excitation_rate_hz` {} must be positive", options.excitation_rate_hz));
  need(options.cocontraction >= 0.0 && options.cocontraction <= 1.0,
       fmt::format("`cocontraction` {} must be in [0, 1]", options.cocontraction));
  need(options.independence >= 0.0 && options.independence <= 1.0,
       fmt::format("`independence` {} must be in [0, 1]", options.independence));
  need(options.moment_noise_sd_N_m >= 0.0,
       fmt::format("`moment_noise_sd_N_m` {} must not be negative", options.moment_noise_sd_N_m));
  need(options.moment_noise_cutoff_hz > 0.0,
       fmt::format("`moment_noise_cutoff_hz` {} must be positive", options.moment_noise_cutoff_hz));
  std::set<std::string> names;
  for (const TwinTrial& t : options.trials) {
    need(t.duration_s >= 1.0 && std::isfinite(t.duration_s),
         fmt::format("trial `{}`: duration {} s must be at least 1 s", t.name, t.duration_s));
    need(t.effort >= 0.0 && t.effort <= 1.0,
         fmt::format("trial `{}`: effort {} must be in [0, 1]", t.name, t.effort));
    need(t.cycle_s >= 0.5,
         fmt::format("trial `{}`: cycle of {} s must be at least 0.5 s", t.name, t.cycle_s));
    need(
        t.lower_rad <= t.upper_rad && t.lower_rad >= coordinate.lower_rad &&
            t.upper_rad <= coordinate.upper_rad,
        fmt::format("trial `{}`: angles {:.1f} to {:.1f} deg are not inside the scene's {:.1f} to {:.1f} deg",
                    t.name, t.lower_rad / kDeg, t.upper_rad / kDeg, coordinate.lower_rad / kDeg,
                    coordinate.upper_rad / kDeg));
    need(names.insert(t.name).second, fmt::format("trial `{}` stands twice", t.name));
  }
  if (!found.empty()) throw data::InputError(std::move(found));
}

/// +1 for a channel that mostly drives flexors, -1 for extensors, by moment arm times force in mid range.
std::vector<double> channel_sides(const data::Scene& scene, const limb::DriveMap& drive,
                                  const data::Coordinate& coordinate) {
  std::vector<double> sides(drive.channels.size(), 0.0);
  const double mid = 0.5 * (coordinate.lower_rad + coordinate.upper_rad);
  for (std::size_t row = 0; row < drive.muscles.size(); ++row) {
    const data::SceneMuscle& muscle = scene.muscle(drive.muscles[row]);
    if (muscle.path.coordinate != coordinate.name && !muscle.path.coordinate.empty()) continue;
    const double share = limb::MusclePath(muscle.name, muscle.path, coordinate)(mid).moment_arm_m *
                         muscle.parameters.max_isometric_force_N;
    for (std::size_t k = 0; k < sides.size(); ++k)
      sides[k] += share * drive.weights(static_cast<Eigen::Index>(row), static_cast<Eigen::Index>(k));
  }
  for (double& side : sides) side = side >= 0.0 ? 1.0 : -1.0;
  return sides;
}

/// True excitation of a channel: its side's effort, partly followed, and some of the other side's.
std::vector<double> channel_excitation(const ProgrammeTraces& traces, const TwinTrial& trial,
                                       const TwinOptions& options, double side, std::size_t trial_index,
                                       std::size_t channel) {
  const auto &own = side > 0.0 ? traces.flexion : traces.extension,
             &other = side > 0.0 ? traces.extension : traces.flexion;
  const std::uint64_t stream = ((static_cast<std::uint64_t>(trial_index) + 1) << 16) + 100 + channel;
  std::vector<double> out =
      smooth_course(own.size(), options.excitation_rate_hz, 0.1, 1.5, options.seed, stream);
  const bool maximal = trial.programme == Programme::mvc;
  for (std::size_t i = 0; i < out.size(); ++i) {
    const double follow = maximal ? own[i] : own[i] * (1.0 - options.independence * out[i]);
    out[i] = std::clamp(follow + options.cocontraction * other[i], 0.0, 1.0);
  }
  return out;
}

/// What a dynamometer whose arm follows the limb reads: flexion positive, gravity and inertia of limb and
/// load included.
void add_dynamometer(const data::Scene& scene, const std::string& coordinate, const ProgrammeTraces& traces,
                     const std::vector<double>& moment, const TwinOptions& options, data::Trial& trial) {
  const limb::BodySet bodies = limb::bodies_of(scene, coordinate, trial.conditions, trial.name);
  const double S = bodies.first_moment_kg_m(), I = bodies.inertia_kg_m2(), rate = options.motion_rate_hz;
  const std::size_t n = moment.size();
  std::vector<double> torque(n);
  for (std::size_t i = 0; i < n; ++i) {
    const std::size_t a = i == 0 ? 0 : i - 1, b = i + 1 == n ? i : i + 1;
    const double acceleration =
        (traces.velocity_rad_s[b] - traces.velocity_rad_s[a]) * rate / static_cast<double>(b - a);
    const double gravity = -S * limb::standard_gravity_m_per_s2 *
                           std::sin(traces.angle_rad[i] + scene.upper_arm_inclination_rad);
    torque[i] = moment[i] + gravity - I * acceleration;
  }
  const auto add = [&](const char* name, Recorded quantity, const char* unit, std::vector<double> samples) {
    trial.signals.push_back(signal(name, quantity, unit, rate, std::move(samples)));
    trial.signals.back().info.coordinate = coordinate;
  };
  add("dynamometer_torque", Recorded::dynamometer_torque, "N m", std::move(torque));
  add("dynamometer_angle", Recorded::dynamometer_angle, "rad", traces.angle_rad);
  add("dynamometer_velocity", Recorded::dynamometer_velocity, "rad/s", traces.velocity_rad_s);
}

data::TrialKind kind_of(const TwinTrial& trial) {
  if (trial.programme == Programme::mvc) return data::TrialKind::mvc;
  if (trial.programme == Programme::passive_sweep) return data::TrialKind::passive;
  return trial.kind;
}

}  // namespace

std::vector<TwinTrial> twin_protocol() {
  const auto trial = [](std::string name, Programme programme, double duration, double lower_deg,
                        double upper_deg, double effort, double cycle) {
    TwinTrial t;
    t.name = std::move(name);
    t.programme = programme;
    t.duration_s = duration;
    t.lower_rad = lower_deg * kDeg;
    t.upper_rad = upper_deg * kDeg;
    t.effort = effort;
    t.cycle_s = cycle;
    return t;
  };
  return {trial("mvc", Programme::mvc, 30.0, 90.0, 90.0, 1.0, 5.0),
          trial("passive", Programme::passive_sweep, 20.0, 15.0, 125.0, 0.0, 10.0),
          trial("ramp-45", Programme::isometric_ramp, 20.0, 45.0, 45.0, 0.6, 5.0),
          trial("ramp-75", Programme::isometric_ramp, 20.0, 75.0, 75.0, 0.6, 5.0),
          trial("ramp-105", Programme::isometric_ramp, 20.0, 105.0, 105.0, 0.6, 5.0),
          trial("hold-60", Programme::isometric_hold, 24.0, 60.0, 60.0, 0.7, 5.0),
          trial("curl", Programme::curl, 20.0, 20.0, 120.0, 0.5, 5.0),
          trial("isokinetic", Programme::isokinetic, 20.0, 30.0, 115.0, 0.8, 4.0),
          trial("random", Programme::random, 20.0, 20.0, 120.0, 0.7, 4.0)};
}

Twin make_twin(const data::Scene& scene, const TwinOptions& given) {
  TwinOptions options = given;
  if (options.trials.empty()) options.trials = twin_protocol();
  if (scene.coordinates.empty())
    throw data::InputError("missing-coordinate", "the twin's scene has no coordinate");
  const data::Coordinate& coordinate = scene.coordinates.front();
  check(options, coordinate);
  const limb::DriveMap drive = limb::drive_map(scene);
  const std::vector<double> sides = channel_sides(scene, drive, coordinate);

  Twin twin;
  twin.recordings.subject = "synthetic twin";
  twin.recordings.attributes["source"] =
      fmt::format("synthetic twin of scene `{}`, seed {}", scene.title, options.seed);
  twin.truth = twin.recordings;
  for (std::size_t t = 0; t < options.trials.size(); ++t) {
    const TwinTrial& plan = options.trials[t];
    const ProgrammeTraces traces = run_programme(plan, options, t);
    const std::string& q = coordinate.name;
    data::Trial recorded{plan.name, kind_of(plan), {}, {{"programme", to_string(plan.programme)}}, {}};
    if (plan.load_mass_kg > 0.0) recorded.conditions["load_mass_kg"] = plan.load_mass_kg;
    data::Trial truth = recorded;

    CalibrationTrial chain;
    chain.name = plan.name;
    for (std::size_t k = 0; k < drive.channels.size(); ++k) {
      std::vector<double> e = channel_excitation(traces, plan, options, sides[k], t, k);
      const auto gain = options.channel_gains.find(drive.channels[k]);
      if (gain != options.channel_gains.end())
        for (double& value : e) value /= gain->second;
      chain.excitations.push_back(
          signal(drive.channels[k], Recorded::excitation, "1", options.excitation_rate_hz, std::move(e)));
    }
    chain.angle =
        signal("joint_angle", Recorded::joint_angle, "rad", options.motion_rate_hz, traces.angle_rad);
    chain.velocity = signal("joint_velocity", Recorded::joint_velocity, "rad/s", options.motion_rate_hz,
                            traces.velocity_rad_s);
    chain.moment = signal("joint_moment", Recorded::joint_moment, "N m", options.motion_rate_hz,
                          std::vector<double>(traces.angle_rad.size(), 0.0));
    chain.angle.info.coordinate = chain.velocity->info.coordinate = chain.moment.info.coordinate = q;
    CalibrationProblemOptions problem_options;
    problem_options.coordinate = q;
    problem_options.model = options.model;
    problem_options.scale_N_m = 1.0;
    problem_options.channel_gains = options.channel_gains;
    const CalibrationProblem problem(scene, {chain}, problem_options);
    if (t == 0) twin.subject = problem.subject(Eigen::VectorXd());
    if (problem.frame_times_s(0).size() != traces.angle_rad.size())
      throw data::InputError(
          "rate-mismatch",
          fmt::format("trial `{}`: {} s do not hold whole periods of the excitation ({} Hz) and "
                      "the motion ({} Hz)",
                      plan.name, plan.duration_s, options.excitation_rate_hz, options.motion_rate_hz));
    std::vector<double> moment(traces.angle_rad.size(), 0.0);
    for (const auto& excitation : chain.excitations) truth.signals.push_back(excitation);
    for (const MuscleTraces& m : problem.muscle_traces(0, Eigen::VectorXd())) {
      for (std::size_t i = 0; i < moment.size(); ++i) moment[i] += m.moment_N_m[i];
      const auto add = [&](const char* suffix, Recorded quantity, const char* unit,
                           const std::vector<double>& samples) {
        truth.signals.push_back(signal(m.muscle + suffix, quantity, unit, options.motion_rate_hz, samples));
        truth.signals.back().info.muscle = m.muscle;
      };
      add(".activation", Recorded::activation, "1", m.activation);
      add(".force", Recorded::muscle_force, "N", m.force_N);
      add(".moment", Recorded::joint_moment, "N m", m.moment_N_m);
    }
    truth.signals.push_back(chain.moment);
    truth.signals.back().samples = moment;

    if (options.raw_emg) {
      for (std::size_t k = 0; k < drive.channels.size(); ++k) {
        emg::SyntheticEmgOptions electrode = options.emg;
        electrode.seed = options.seed;
        electrode.stream = ((static_cast<std::uint64_t>(t) + 1) << 16) + 1000 + k;
        electrode.amplitude_V *= std::exp2(2.0 * emg::Random(options.seed, 500 + k).uniform() - 1.0);
        auto emg = emg::synthesise_emg(chain.excitations[k].samples, options.excitation_rate_hz, electrode);
        recorded.signals.push_back(
            signal(drive.channels[k], Recorded::emg, "V", electrode.rate_hz, std::move(emg.raw)));
      }
    }
    recorded.signals.push_back(chain.angle);
    recorded.signals.push_back(*chain.velocity);
    if (options.dynamometer) add_dynamometer(scene, q, traces, moment, options, recorded);
    if (options.moment_noise_sd_N_m > 0.0) {
      const auto noise = envelope_noise(moment.size(), options.motion_rate_hz, options.moment_noise_cutoff_hz,
                                        options.seed, ((static_cast<std::uint64_t>(t) + 1) << 16) + 2000);
      for (std::size_t i = 0; i < moment.size(); ++i) moment[i] += options.moment_noise_sd_N_m * noise[i];
      if (options.dynamometer)
        for (data::Signal& s : recorded.signals)
          if (s.info.quantity == Recorded::dynamometer_torque)
            for (std::size_t i = 0; i < moment.size(); ++i)
              s.samples[i] += options.moment_noise_sd_N_m * noise[i];
    }
    recorded.signals.push_back(chain.moment);
    recorded.signals.back().samples = std::move(moment);
    twin.recordings.trials.push_back(std::move(recorded));
    twin.truth.trials.push_back(std::move(truth));
  }
  twin.subject.name = "synthetic twin";
  twin.subject.provenance["source"] = twin.recordings.attributes["source"];
  return twin;
}

std::vector<CalibrationTrial> noise_free_trials(const Twin& twin, const std::string& coordinate) {
  std::vector<CalibrationTrial> out;
  for (std::size_t t = 0; t < twin.recordings.trials.size(); ++t) {
    data::Trial joined = twin.recordings.trials[t];
    for (const data::Signal& s : twin.truth.trials[t].signals)
      if (s.info.quantity == Recorded::excitation) joined.signals.push_back(s);
    out.push_back(calibration_trial(joined, coordinate));
  }
  return out;
}

}  // namespace brachium::optimise
