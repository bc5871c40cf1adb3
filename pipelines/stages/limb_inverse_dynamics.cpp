/// limb.inverse_dynamics: the joint moment that a recorded motion of forearm, hand and load needs.

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <atomic>
#include <optional>

#include "data/limb/forearm_motion.hpp"
#include "data/limb/inverse_dynamics.hpp"
#include "data/model/parallel.hpp"
#include "data/model/resample.hpp"
#include "pipelines/stages/common.hpp"
#include "pipelines/stages/limb_common.hpp"

namespace brachium::pipelines {
namespace {

/// d signals of a trial on their common grid, as d x n.
struct Block {
  Eigen::MatrixXd rows;
  data::TimeGrid grid;
};

bool has_all(const data::TrialInfo& trial, const std::vector<std::string>& names) {
  return !names.empty() &&
         std::all_of(names.begin(), names.end(), [&](const std::string& n) { return trial.has_signal(n); });
}

std::vector<std::string> components(const std::string& point) {
  return {point + "_x", point + "_y", point + "_z"};
}

Block read_block(const StageData& input, std::size_t t, const std::vector<std::string>& names,
                 std::optional<data::TimeGrid> grid) {
  const data::TrialInfo& trial = input.signals->info().trials[t];
  std::vector<data::Signal> signals;
  std::vector<data::SignalInfo> infos;
  for (const std::string& name : names) {
    signals.push_back(input.signals->signal(t, trial.signal_index(name)));
    infos.push_back(signals.back().info);
  }
  const data::TimeGrid common = grid ? *grid : data::common_grid(infos, infos.front().rate_hz);
  Block block{
      Eigen::MatrixXd(static_cast<Eigen::Index>(names.size()), static_cast<Eigen::Index>(common.count)),
      common};
  for (std::size_t k = 0; k < signals.size(); ++k) {
    const data::Signal on_grid = in_trial(trial.name, [&] { return data::resample(signals[k], common); });
    block.rows.row(static_cast<Eigen::Index>(k)) =
        Eigen::Map<const Eigen::RowVectorXd>(on_grid.samples.data(), static_cast<Eigen::Index>(common.count));
  }
  return block;
}

struct Result {
  limb::JointMoment moment;
  data::TimeGrid grid;
  std::string origin;
  std::optional<limb::DirectionAgreement> agreement;
  std::optional<limb::LongAxisEstimate> long_axis;
};

Eigen::Vector3d vector_option(const std::vector<double>& values, const std::string& key) {
  if (values.size() != 3)
    throw data::InputError("out-of-range",
                           fmt::format("`{}` needs three numbers, not {}", key, values.size()));
  return {values[0], values[1], values[2]};
}

Result run_trial(const StageContext& context, const data::Scene& scene, const data::Coordinate& coordinate,
                 const std::string& name) {
  const Options& o = *context.options;
  const StageData& input = context.input("signals");
  const std::size_t t = trial_index(input, name);
  const data::TrialInfo& trial = input.signals->info().trials[t];
  const std::vector<std::string>& orientation = o.texts("orientation");
  const std::vector<std::string> elbow = components(o.text("elbow_point"));
  std::vector<std::string> distal;
  for (const std::string& point : o.texts("distal_points")) {
    for (const std::string& c : components(point)) distal.push_back(c);
  }
  const bool has_points = has_all(trial, elbow) && has_all(trial, distal),
             has_orientation = has_all(trial, orientation);
  std::string motion_kind = o.text("motion");
  if (motion_kind == "auto") motion_kind = has_orientation ? "orientation" : has_points ? "points" : "angle";
  const auto need = [&](bool present, const std::vector<std::string>& names) {
    if (!present) {
      throw data::InputError("missing-signal",
                             fmt::format("trial `{}` lacks a signal that `motion = \"{}\"` needs (one of {})",
                                         name, motion_kind, fmt::join(names, ", ")),
                             "import it, name it in the stage's options, or choose another `motion`");
    }
  };
  const Eigen::Vector3d up = vector_option(o.numbers("up"), "up");

  Result result;
  limb::ForearmMotion motion;
  std::optional<limb::ForearmMotion> from_points;
  std::optional<Block> quaternion;
  if (motion_kind == "orientation") {
    need(has_orientation, orientation);
    quaternion = read_block(input, t, orientation, std::nullopt);
    result.grid = quaternion->grid;
  }
  if (has_points && motion_kind != "angle") {
    std::vector<std::string> all = elbow;
    all.insert(all.end(), distal.begin(), distal.end());
    const Block points =
        read_block(input, t, all, quaternion ? std::optional(quaternion->grid) : std::nullopt);
    result.grid = points.grid;
    Eigen::Matrix3Xd mean = Eigen::Matrix3Xd::Zero(3, points.rows.cols());
    const auto count = static_cast<Eigen::Index>(distal.size() / 3);
    for (Eigen::Index p = 0; p < count; ++p)
      mean += points.rows.middleRows(3 + 3 * p, 3) / static_cast<double>(count);
    from_points = in_trial(name, [&] {
      return limb::motion_from_points(points.rows.topRows(3), mean, points.grid.rate_hz, up);
    });
  }
  if (motion_kind == "points") {
    need(has_points, distal);
    motion = *from_points;
  } else if (motion_kind == "orientation") {
    limb::OrientationConvention convention;
    convention.up = up;
    convention.segment_to_world = o.text("quaternion") == "segment_to_world";
    if (o.has("long_axis")) {
      convention.long_axis = vector_option(o.numbers("long_axis"), "long_axis");
    } else if (from_points) {
      result.long_axis =
          limb::estimate_long_axis(quaternion->rows, from_points->direction, convention.segment_to_world);
      convention.long_axis = result.long_axis->long_axis;
    } else {
      throw data::InputError(
          "missing-option",
          fmt::format("stage `{}` needs `long_axis`: the forearm's long axis in the recorder's segment frame",
                      context.name),
          "give it as three numbers, or record elbow and wrist points from which it is found");
    }
    motion = in_trial(name, [&] {
      return limb::motion_from_orientation(quaternion->rows, quaternion->grid.rate_hz, convention);
    });
    if (from_points) {
      motion.elbow_m = from_points->elbow_m;
      result.agreement = limb::compare_directions(motion.direction, from_points->direction);
    }
  } else {
    const data::Signal angle = recorded_angle(input, name, coordinate);
    result.grid = {angle.info.rate_hz, angle.info.start_time_s, angle.samples.size()};
    motion = in_trial(name, [&] {
      return limb::motion_from_angle(
          Eigen::Map<const Eigen::VectorXd>(angle.samples.data(),
                                            static_cast<Eigen::Index>(angle.samples.size())),
          angle.info.rate_hz, scene.upper_arm_inclination_rad);
    });
  }
  result.origin = motion.origin;
  const limb::BodySet bodies = limb::bodies_of(scene, coordinate.name, trial.conditions, name);
  result.moment = in_trial(name, [&] {
    return limb::inverse_dynamics_moment(motion, bodies,
                                         {o.number("lowpass_hz"), o.boolean("elbow_acceleration")});
  });
  return result;
}

void run(const StageContext& context, StageOutput& out) {
  const data::Scene& scene = context.need_scene();
  const data::Coordinate& coordinate =
      coordinate_of(scene, context.options->maybe_text("coordinate").value_or(""));
  begin_output(context, context.input("signals"), out);
  std::vector<Result> results(context.trials.size());
  std::atomic<std::size_t> done{0};
  data::parallel_for(context.trials.size(), context.threads, [&](std::size_t i) {
    results[i] = run_trial(context, scene, coordinate, context.trials[i]);
    const Result& r = results[i];
    data::Signal moment = make_signal(r.grid, coordinate.name + "_moment", data::Quantity::joint_moment,
                                      "N m", coordinate.name, r.moment.moment_N_m);
    moment.info.attributes["source"] = "inverse dynamics, " + r.origin;
    out.signals->write(context.trials[i], moment);
    out.signals->write(context.trials[i], make_signal(r.grid, "moment_sd", data::Quantity::other, "N m",
                                                      coordinate.name, r.moment.sd_N_m));
    out.signals->write(context.trials[i], make_signal(r.grid, "use", data::Quantity::other, "1",
                                                      coordinate.name, r.moment.usable));
    out.signals->write(context.trials[i], make_signal(r.grid, "gravity_part", data::Quantity::other, "N m",
                                                      coordinate.name, r.moment.gravity_part_N_m));
    out.signals->write(context.trials[i], make_signal(r.grid, "inertial_part", data::Quantity::other, "N m",
                                                      coordinate.name, r.moment.inertial_part_N_m));
    if (context.progress)
      context.progress(static_cast<double>(++done) / static_cast<double>(context.trials.size()),
                       context.trials[i]);
  });

  TableBuilder table("inverse dynamics by trial");
  table.text("trial")
      .number("first_moment_kg_m", "kg m")
      .number("inertia_kg_m2", "kg m^2")
      .number("mean_N_m", "N m")
      .number("largest_N_m", "N m")
      .number("rms_inertial_N_m", "N m")
      .number("rms_sd_N_m", "N m")
      .number("share_used", "1")
      .text("orientation_against_points");
  TableBuilder contributors("what the uncertainty comes from");
  contributors.text("trial").text("contributor").number("rms_sd_N_m", "N m");
  for (std::size_t i = 0; i < results.size(); ++i) {
    const limb::JointMoment& m = results[i].moment;
    const double n = static_cast<double>(m.moment_N_m.size());
    table.row({context.trials[i], m.first_moment_kg_m, m.inertia_kg_m2, m.moment_N_m.mean(),
               m.moment_N_m.maxCoeff(), std::sqrt(m.inertial_part_N_m.squaredNorm() / n),
               std::sqrt(m.sd_N_m.squaredNorm() / n), m.usable.mean(),
               results[i].agreement ? fmt::format("{:.1f} deg rms", results[i].agreement->rms_deg)
                                    : std::string("not compared")});
    for (const limb::MomentContributor& c : m.contributors)
      contributors.row({context.trials[i], c.name, c.rms_sd_N_m});
  }
  out.tables["moment"] = table.take();
  out.tables["uncertainty"] = contributors.take();
  out.attributes["origin"] = results.front().origin;
  if (!scene.body_mass_source.empty()) {
    out.attributes["body_mass"] = fmt::format("{:g} kg ({})", scene.body_mass_kg, scene.body_mass_source);
    out.warn("assumed-mass",
             fmt::format("the reference moment rests on a body mass of {:g} kg: {}", scene.body_mass_kg,
                         scene.body_mass_source),
             "its standard uncertainty is given by trial in the table `moment`, column `rms_sd_N_m`");
  }
  for (const data::Load& load : scene.loads) {
    if (!load.source.empty()) out.warn("assumed-load", fmt::format("load `{}`: {}", load.name, load.source));
  }
  const auto worst = std::max_element(results.begin(), results.end(), [](const Result& a, const Result& b) {
    return (a.agreement ? a.agreement->rms_deg : 0.0) < (b.agreement ? b.agreement->rms_deg : 0.0);
  });
  const double limit = context.options->number("agreement_deg");
  if (worst->agreement && worst->agreement->rms_deg > limit) {
    out.warn("direction-disagreement",
             fmt::format("orientation and points of the forearm differ by {:.1f} deg rms in trial `{}`",
                         worst->agreement->rms_deg,
                         context.trials[static_cast<std::size_t>(worst - results.begin())]),
             "check the quaternion's convention, `long_axis`, and which points are named");
  }
}

void fill(const ReportContext& context, report::Section& section) {
  const StageData& output = *context.output;
  std::string text =
      "The reference moment was not measured: it comes from inverse dynamics of forearm, hand and load. "
      "Motion: " +
      output.attributes.at("origin") + ".";
  if (const auto mass = output.attributes.find("body_mass"); mass != output.attributes.end())
    text += " Body mass: " + mass->second + ".";
  section.title += ": reference moment";
  section.blocks.push_back(report::Paragraph{text, report::Tone::warning});
  report::GridOptions grid;
  grid.digits = 3;
  grid.names = {{"first_moment_kg_m", "mass × distance"},
                {"inertia_kg_m2", "inertia"},
                {"mean_N_m", "mean"},
                {"largest_N_m", "largest"},
                {"rms_inertial_N_m", "RMS inertial"},
                {"rms_sd_N_m", "RMS sd"},
                {"share_used", "share used"},
                {"orientation_against_points", "orientation − points"}};
  section.blocks.push_back(report::make_grid(output.tables.at("moment"), grid));
  report::PlotRow plots;
  plots.min_width_px = 320.0;
  for (std::size_t t = 0; t < output.signals->info().trials.size(); ++t) {
    const data::TrialInfo& trial = output.signals->info().trials[t];
    const data::Signal moment =
        output.signals->signal(t, signals_of(trial, data::Quantity::joint_moment).front());
    const data::Signal sd = output.signals->signal(t, trial.signal_index("moment_sd")),
                       gravity = output.signals->signal(t, trial.signal_index("gravity_part"));
    report::Plot plot;
    plot.title = trial.name;
    plot.x_label = "time [s]";
    plot.y_label = "moment [N m]";
    report::Series band;
    band.label = "moment ± 2 sd of the masses";
    band.style = report::Style::area;
    for (std::size_t i = 0; i < moment.samples.size(); ++i) {
      band.x.push_back(moment.info.time_s(i));
      band.y.push_back(moment.samples[i] + 2.0 * sd.samples[i]);
      band.y_lower.push_back(moment.samples[i] - 2.0 * sd.samples[i]);
    }
    plot.series = {band, report::make_series(moment, "moment"),
                   report::make_series(gravity, "gravity alone", "", report::Style::dashed)};
    plots.plots.push_back(std::move(plot));
  }
  section.blocks.push_back(plots);
  report::Section folded;
  folded.blocks.push_back(report::make_grid(output.tables.at("uncertainty"), grid));
  section.blocks.push_back(report::Details{"what the uncertainty comes from", {folded}});
}

std::string methods(const ReportContext& context) {
  std::vector<std::string> parts;
  if (context.scene) {
    for (const data::Segment& s : context.scene->segments)
      parts.push_back(
          fmt::format("{} {:.3f} kg at {:.3f} m ({})", s.name, s.mass_kg, s.centre_of_mass_m, s.source));
    for (const data::Load& l : context.scene->loads)
      parts.push_back(fmt::format("{} at {:.3f} m ({})", l.name, l.distance_m, l.source));
  }
  const bool mass = context.scene && context.scene->body_mass_kg > 0.0;
  return fmt::format(
      "The joint moment was computed by inverse dynamics (Winter 2009, doi:10.1002/9780470549148) with "
      "motion low-pass filtered at {:g} Hz{}. What was moved: {}. The uncertainty of "
      "masses and lengths was propagated to first order.",
      context.options->number("lowpass_hz"),
      mass ? fmt::format(", for a body mass of {:g} kg ({})", context.scene->body_mass_kg,
                         context.scene->body_mass_source)
           : "",
      fmt::join(parts, "; "));
}

}  // namespace

void add_limb_inverse_dynamics(Catalogue& catalogue) {
  StageSpec spec;
  spec.name = "limb.inverse_dynamics";
  spec.summary = "joint moment from recorded motion, segment masses and held load, with its uncertainty";
  spec.doc =
      "Computes the moment that muscles must have exerted for the recorded motion of forearm, hand and held "
      "load: gravity from the forearm's own orientation (not from the joint angle: the upper "
      "arm moves too), rotational inertia, and the acceleration of the elbow where its trajectory is known. "
      "The uncertainty of masses, distances and inertias that the scene states is propagated "
      "to first order and given at each instant. Samples near the ends, and those in which the forearm "
      "leaves its plane so that the hinge's axis is not known, are marked (signal `use`) and left out by "
      "calibration and verdict. Sources: Winter 2009, ch. 5; de Leva 1996, doi:10.1016/0021-9290(95)00178-6.";
  spec.needs_scene = true;
  spec.inputs = {{"signals", PortType::signals, "recordings: orientation, points, or a joint angle", false,
                  false, true}};
  OptionSpec long_axis;
  long_axis.key = "long_axis";
  long_axis.type = OptionType::numbers;
  long_axis.doc =
      "the forearm's long axis, elbow to hand, in the recorder's segment frame; absent: found from the "
      "points";
  long_axis.optional = true;
  OptionSpec up;
  up.key = "up";
  up.type = OptionType::numbers;
  up.doc = "the vertical in the recorder's world frame";
  up.fallback = std::vector<double>{0.0, 0.0, 1.0};
  spec.options = {
      optional_text("coordinate", "joint coordinate; may be left out where the scene has one"),
      choice_option("motion", "auto", {"auto", "orientation", "points", "angle"},
                    "what tells the forearm's direction; angle assumes an upper arm at rest"),
      texts_option("orientation",
                   {"forearm_orientation_x", "forearm_orientation_y", "forearm_orientation_z",
                    "forearm_orientation_w"},
                   "signals of the quaternion, x y z w"),
      choice_option("quaternion", "segment_to_world", {"segment_to_world", "world_to_segment"},
                    "what the quaternion turns into what"),
      long_axis,
      up,
      text_option("elbow_point", "elbow_position", "elbow joint centre: signals <name>_x, _y, _z"),
      texts_option("distal_points", {"radial_styloid_position", "ulnar_styloid_position"},
                   "points whose mean is the forearm's distal end"),
      flag_option("elbow_acceleration", true,
                  "take the acceleration of the elbow into account, where it is recorded"),
      number_option("lowpass_hz", "Hz", 3.0, above(0), "low-pass of the motion before it is differentiated"),
      number_option("agreement_deg", "deg", 10.0, above(0),
                    "orientation and points that differ by more (rms) give a warning")};
  spec.run = run;
  spec.report = fill;
  spec.methods = methods;
  catalogue.add(std::move(spec));
}

}  // namespace brachium::pipelines
