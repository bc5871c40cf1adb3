/// limb.dynamometer: a machine's angle, velocity and torque to the muscles' moment about the joint.

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <numbers>
#include <optional>

#include "data/limb/bodies.hpp"
#include "data/limb/dynamometer.hpp"
#include "data/model/parallel.hpp"
#include "data/model/resample.hpp"
#include "pipelines/stages/common.hpp"
#include "pipelines/stages/limb_common.hpp"

namespace brachium::pipelines {
namespace {

using data::Quantity;
constexpr double rad_per_deg = std::numbers::pi / 180.0;

struct Record {
  limb::DynamometerRecord joint;
  data::TimeGrid grid;
};

Record read_record(const StageContext& context, const data::Coordinate& coordinate,
                   const std::string& trial) {
  const Options& o = *context.options;
  const StageData& input = context.input("signals");
  std::vector<data::Signal> signals{signal_of(input, trial, Quantity::dynamometer_torque, coordinate.name),
                                    signal_of(input, trial, Quantity::dynamometer_angle, coordinate.name)};
  if (has_signal_of(input, trial, Quantity::dynamometer_velocity, coordinate.name))
    signals.push_back(signal_of(input, trial, Quantity::dynamometer_velocity, coordinate.name));
  const std::vector<data::Signal> aligned =
      in_trial(trial, [&] { return data::align(signals, signals.front().info.rate_hz); });
  limb::DynamometerLayout layout;
  layout.angle_sign = static_cast<int>(o.integer("angle_sign"));
  layout.torque_sign = static_cast<int>(o.integer("torque_sign"));
  layout.angle_zero_rad = o.number("angle_zero_deg") * rad_per_deg;
  layout.torque_zero_N_m = o.number("torque_zero_N_m");
  const std::vector<double> none;
  const data::SignalInfo& info = aligned.front().info;
  return {in_trial(trial,
                   [&] {
                     return limb::joint_record(
                         aligned[1].samples, aligned.size() > 2 ? aligned[2].samples : none,
                         aligned[0].samples, info.rate_hz, layout, o.number("lowpass_hz"));
                   }),
          {info.rate_hz, info.start_time_s, aligned.front().samples.size()}};
}

/// What weighs and turns in one trial.
struct Loads {
  limb::PassiveLoad limb, machine;
};

Loads loads_of(const StageContext& context, const data::Scene& scene, const data::Coordinate& coordinate,
               const limb::GravityModel* fitted, const std::string& trial) {
  const Options& o = *context.options;
  Loads loads;
  const bool gravity = o.text("gravity") == "limb", inertia = o.text("inertia") == "limb";
  if (gravity || inertia) {
    const limb::BodySet bodies = limb::bodies_of(
        scene, coordinate.name, trial_info(context.input("signals"), trial).conditions, trial);
    if (gravity) {
      loads.limb.gravity = limb::gravity_from_limb(bodies, scene.upper_arm_inclination_rad);
      loads.machine.gravity = limb::gravity_from_machine_arm(o.number("machine_arm_first_moment_kg_m"),
                                                             scene.upper_arm_inclination_rad);
    }
    if (inertia) {
      loads.limb.inertia_kg_m2 = bodies.inertia_kg_m2();
      loads.machine.inertia_kg_m2 = o.number("machine_arm_inertia_kg_m2");
    }
  }
  if (fitted) loads.machine.gravity = *fitted;
  return loads;
}

std::optional<limb::GravityModel> fit_sweep(const StageContext& context, const data::Coordinate& coordinate,
                                            StageOutput& out) {
  const Options& o = *context.options;
  if (o.text("gravity") != "passive_sweep") return std::nullopt;
  const StageData& input = context.input("signals");
  std::vector<std::string> all, passive;
  for (const data::TrialInfo& trial : input.signals->info().trials) {
    all.push_back(trial.name);
    if (trial.kind == data::TrialKind::passive) passive.push_back(trial.name);
  }
  const std::vector<std::string>& patterns = o.texts("sweep_trials");
  if (!patterns.empty()) passive = data::match_names(patterns, all, "trial");
  if (passive.size() != 1) {
    throw data::InputError(
        "missing-trial",
        fmt::format(
            "stage `{}` corrects gravity by a passive sweep and needs one trial of kind `passive`, not {}",
            context.name, passive.size()),
        "name it in `sweep_trials`, or choose `gravity = \"limb\"`");
  }
  limb::PassiveSweepOptions options;
  options.max_speed_rad_per_s = o.number("sweep_max_speed_deg_s") * rad_per_deg;
  const Record sweep = read_record(context, coordinate, passive.front());
  limb::GravityModel model =
      in_trial(passive.front(), [&] { return limb::fit_gravity(sweep.joint, options); });
  TableBuilder table("gravity fitted to the passive sweep");
  table.text("trial")
      .number("cos_N_m", "N m")
      .number("sin_N_m", "N m")
      .number("offset_N_m", "N m")
      .number("rms_residual_N_m", "N m")
      .number("worst_residual_N_m", "N m")
      .number("worst_angle_rad", "rad")
      .number("condition_number", "1");
  table.row({passive.front(), model.cos_N_m, model.sin_N_m, model.offset_N_m, model.rms_residual_N_m,
             model.worst_residual_N_m, model.worst_angle_rad, model.condition_number});
  out.tables["gravity"] = table.take();
  return model;
}

struct Row {
  std::string trial, phases;
  double largest, rms_gravity, rms_inertial, rms_sd, used;
};

Row run_trial(const StageContext& context, const data::Scene& scene, const data::Coordinate& coordinate,
              const limb::GravityModel* fitted, const std::string& name, StageOutput& out) {
  const Options& o = *context.options;
  const Record record = read_record(context, coordinate, name);
  limb::AxisOffset axis;
  axis.along_m = o.number("axis_along_m");
  axis.across_m = o.number("axis_across_m");
  axis.sd_m = o.number("axis_sd_m");
  axis.pad_distance_m = o.number("pad_distance_m");
  const Loads loads = loads_of(context, scene, coordinate, fitted, name);
  const limb::DynamometerMoment m = limb::dynamometer_moment(record.joint, loads.limb, loads.machine, axis);
  const Eigen::Index count = m.moment_N_m.size();

  std::vector<limb::Phase> phases{{0, count, 0.0, 0.0}};
  const std::string& windows = o.text("windows");
  if (windows == "isokinetic") {
    limb::IsokineticOptions iso;
    iso.speed_rad_per_s = o.number("speed_deg_s") * rad_per_deg;
    iso.relative_tolerance = o.number("phase_tolerance");
    phases = limb::isokinetic_phases(record.joint, iso);
  } else if (windows == "holds") {
    limb::HoldOptions hold;
    hold.relative_tolerance = o.number("phase_tolerance");
    phases = limb::isometric_holds(record.joint, hold);
  }
  const Eigen::VectorXd use = limb::phase_mask(phases, count);
  const auto rms = [count](const Eigen::VectorXd& v) {
    return std::sqrt(v.squaredNorm() / static_cast<double>(count));
  };

  data::Signal moment = make_signal(record.grid, coordinate.name + "_moment", Quantity::joint_moment, "N m",
                                    coordinate.name, m.moment_N_m);
  moment.info.attributes["source"] = "dynamometer, gravity " + o.text("gravity");
  out.signals->write(name, moment);
  out.signals->write(name, make_signal(record.grid, coordinate.name, Quantity::joint_angle, "rad",
                                       coordinate.name, m.angle_rad));
  out.signals->write(name, make_signal(record.grid, coordinate.name + "_velocity", Quantity::joint_velocity,
                                       "rad/s", coordinate.name, m.velocity_rad_per_s));
  out.signals->write(name, make_signal(record.grid, "use", Quantity::other, "1", coordinate.name, use));
  out.signals->write(
      name, make_signal(record.grid, "moment_sd", Quantity::other, "N m", coordinate.name, m.sd_N_m));
  out.signals->write(
      name, make_signal(record.grid, "gravity", Quantity::other, "N m", coordinate.name, m.gravity_N_m));
  std::string text = windows == "all" ? std::string("all") : std::to_string(phases.size());
  return {
      name,          text,      m.moment_N_m.cwiseAbs().maxCoeff(), rms(m.gravity_N_m), rms(m.inertial_N_m),
      rms(m.sd_N_m), use.mean()};
}

void run(const StageContext& context, StageOutput& out) {
  const data::Scene& scene = context.need_scene();
  const data::Coordinate& coordinate =
      coordinate_of(scene, context.options->maybe_text("coordinate").value_or(""));
  const std::optional<limb::GravityModel> fitted = fit_sweep(context, coordinate, out);
  begin_output(context, context.input("signals"), out);
  std::vector<Row> rows(context.trials.size());
  std::atomic<std::size_t> done{0};
  data::parallel_for(context.trials.size(), context.threads, [&](std::size_t i) {
    rows[i] = run_trial(context, scene, coordinate, fitted ? &*fitted : nullptr, context.trials[i], out);
    if (context.progress)
      context.progress(static_cast<double>(++done) / static_cast<double>(context.trials.size()),
                       context.trials[i]);
  });
  TableBuilder table("dynamometer by trial");
  table.text("trial")
      .number("largest_N_m", "N m")
      .number("rms_gravity_N_m", "N m")
      .number("rms_inertial_N_m", "N m")
      .number("rms_sd_N_m", "N m")
      .text("phases")
      .number("share_used", "1");
  for (const Row& r : rows) {
    table.row({r.trial, r.largest, r.rms_gravity, r.rms_inertial, r.rms_sd, r.phases, r.used});
    if (r.used == 0.0)
      out.warn("no-phase",
               fmt::format("no {} phase was found in trial `{}`: none of it is used",
                           context.options->text("windows"), r.trial),
               "check `speed_deg_s` and `phase_tolerance`");
  }
  out.tables["moment"] = table.take();
}

void fill(const ReportContext& context, report::Section& section) {
  const StageData& output = *context.output;
  report::GridOptions grid;
  grid.digits = 3;
  grid.names = {{"largest_N_m", "largest"},
                {"rms_gravity_N_m", "RMS of gravity"},
                {"rms_inertial_N_m", "RMS of inertia"},
                {"rms_sd_N_m", "standard uncertainty"},
                {"share_used", "share used"},
                {"cos_N_m", "cosine"},
                {"sin_N_m", "sine"},
                {"offset_N_m", "offset"},
                {"rms_residual_N_m", "RMS residual"},
                {"worst_residual_N_m", "worst residual"},
                {"worst_angle_rad", "at angle"}};
  grid.units = {{"worst_angle_rad", "deg"}};
  section.title += ": reference moment";
  if (output.tables.contains("gravity"))
    section.blocks.push_back(report::make_grid(output.tables.at("gravity"), grid));
  section.blocks.push_back(report::make_grid(output.tables.at("moment"), grid));
  std::vector<std::string> trials;
  for (const data::TrialInfo& trial : output.signals->info().trials) trials.push_back(trial.name);
  section.blocks.push_back(trial_plots(*output.signals, trials, Quantity::joint_moment, "moment"));
}

std::string methods(const ReportContext& context) {
  const std::string gravity = context.options->text("gravity");
  return std::string(
             "The joint moment was measured with a dynamometer; the torque was corrected for gravity ") +
         (gravity == "passive_sweep" ? "by a sine and cosine fitted to a slow sweep of the relaxed limb "
                                       "(passive tissue is then part of the correction)"
          : gravity == "limb"        ? "of the limb's own masses"
                                     : "by the machine itself") +
         " and for inertia (Winter, Wells & Orr 1981, Eur J Appl Physiol 46, 397-408; Herzog 1988, J Biomech "
         "21, 5-12).";
}

}  // namespace

void add_limb_dynamometer(Catalogue& catalogue) {
  StageSpec spec;
  spec.name = "limb.dynamometer";
  spec.version = 2;
  spec.summary = "a dynamometer's record to the muscles' moment: layout, gravity, inertia, axis, ramps";
  spec.doc =
      "Brings a machine's angle, velocity and torque (signals of quantity dynamometer_angle, "
      "dynamometer_velocity, dynamometer_torque) to the joint: declared signs and zeros, gravity from a "
      "passive sweep or from the limb's masses, inertia in the ramps, and a joint centre beside the "
      "machine's axis to first order. `windows` keeps the stretches of constant velocity of isokinetic "
      "trials or the holds of isometric ones; the others are marked (signal `use`) and left out by "
      "calibration and verdict.\n"
      "A fit to a passive sweep takes passive tissue for gravity: then a model's passive forces must not be "
      "fitted to the rest. Sources: Winter, Wells & Orr 1981, Eur J Appl Physiol 46, 397-408; Herzog "
      "1988, J Biomech 21, 5-12.\n"
      "No public recording with raw EMG and a real dynamometer could be found: this stage is tested on "
      "synthetic records.";
  spec.needs_scene = true;
  spec.inputs = {{"signals", PortType::signals, "recordings with dynamometer signals", false, false, true}};
  OptionSpec angle_sign = integer_option("angle_sign", 1, between(-1, 1),
                                         "+1: the machine's angle grows with flexion; -1: it falls");
  OptionSpec torque_sign = integer_option(
      "torque_sign", 1, between(-1, 1), "+1: the machine's torque is positive towards flexion; -1: negative");
  spec.options = {
      optional_text("coordinate", "joint coordinate; may be left out where the scene has one"),
      angle_sign,
      torque_sign,
      number_option("angle_zero_deg", "deg", 0.0, {}, "the machine's angle at which the joint is straight"),
      number_option("torque_zero_N_m", "N m", 0.0, {}, "the machine's torque with nothing attached"),
      choice_option(
          "gravity", "limb", {"passive_sweep", "limb", "none"},
          "gravity fitted to a passive sweep, computed from the scene's masses, or already taken off"),
      texts_option("sweep_trials", {}, "the passive sweep; empty: the trial of kind `passive`"),
      number_option("sweep_max_speed_deg_s", "deg/s", 20.0, above(0),
                    "faster samples of the sweep are not used"),
      choice_option("inertia", "limb", {"limb", "none"},
                    "correct for the inertia of limb and machine arm, or not"),
      number_option("machine_arm_inertia_kg_m2", "kg m^2", 0.0, at_least(0),
                    "of the machine's arm about its axis"),
      number_option("machine_arm_first_moment_kg_m", "kg m", 0.0, at_least(0),
                    "mass times distance of the machine's arm, for gravity from masses"),
      number_option(
          "axis_along_m", "m", 0.0, {},
          "joint centre beside the machine's axis, along the machine's arm with the joint straight"),
      number_option("axis_across_m", "m", 0.0, {}, "and across it, towards the side to which flexion turns"),
      number_option("axis_sd_m", "m", 0.0, at_least(0), "standard uncertainty of both"),
      number_option("pad_distance_m", "m", 0.0, at_least(0),
                    "machine axis to pad; 0: no correction for the axis"),
      number_option("lowpass_hz", "Hz", 6.0, above(0), "low-pass of the angle before it is differentiated"),
      choice_option("windows", "all", {"all", "isokinetic", "holds"}, "which stretches count"),
      number_option("speed_deg_s", "deg/s", 60.0, above(0), "set speed of isokinetic trials"),
      number_option("phase_tolerance", "", 0.05, between(0, 1),
                    "relative tolerance on velocity (isokinetic) or torque (holds)")};
  spec.run = run;
  spec.report = fill;
  spec.methods = methods;
  catalogue.add(std::move(spec));
}

}  // namespace brachium::pipelines
