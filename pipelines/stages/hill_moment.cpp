/// hill.moment: activations and joint angle to muscle forces and the joint moment.

#include <fmt/format.h>

#include <algorithm>
#include <atomic>

#include "data/limb/muscle_path.hpp"
#include "data/model/parallel.hpp"
#include "data/model/resample.hpp"
#include "hill/forward.hpp"
#include "pipelines/stages/common.hpp"
#include "pipelines/stages/model_options.hpp"
#include "pipelines/stages/moment_frames.hpp"

namespace brachium::pipelines {
namespace {

using data::Quantity;

/// One muscle's part of a trial, for the tables.
struct Row {
  std::string trial, muscle;
  double peak_force, mean_moment, active_share, shortest_norm, longest_norm;
  std::size_t unloaded, slack, clamped;
};

struct Chain {
  const data::Scene& scene;
  const data::Coordinate& coordinate;
  const data::Subject* subject;
  hill::MuscleModelOptions model;
  bool clamp;
};

std::vector<Row> run_trial(const StageContext& context, const Chain& chain, const std::string& name,
                           StageOutput& out) {
  const StageData& activations = context.input("activation");
  const StageData& kinematics = context.input("kinematics");
  const data::Signal angle = signal_of(kinematics, name, Quantity::joint_angle, chain.coordinate.name);
  std::optional<data::Signal> velocity;
  if (has_signal_of(kinematics, name, Quantity::joint_velocity, chain.coordinate.name)) {
    velocity = signal_of(kinematics, name, Quantity::joint_velocity, chain.coordinate.name);
  }
  const std::size_t t = trial_index(activations, name);
  std::optional<MomentFrames> grid;
  std::vector<double> total, passive_total, length, arm, speed;
  std::vector<Row> rows;
  hill::MuscleScratch scratch;
  hill::MuscleTrace trace;
  trace.parts = true;
  for (const data::SceneMuscle& muscle : chain.scene.muscles) {
    if (muscle.path.kind == data::PathGeometry::Kind::none || muscle.path.coordinate != chain.coordinate.name)
      continue;
    const data::Signal activation =
        activations.signals->signal(t, activations.signals->info().trials[t].signal_index(muscle.name));
    if (!grid) {
      grid = moment_frames(activation.info, angle, velocity, name);
      total.assign(grid->time.count, 0.0);
      passive_total.assign(grid->time.count, 0.0);
      length.resize(grid->time.count);
      arm.resize(grid->time.count);
      speed.resize(grid->velocity_rad_s.size());
    }
    std::size_t clamped = 0;
    const std::vector<double> a = activation_at(*grid, activation, chain.clamp, name, clamped);
    const limb::MusclePath path(muscle.name, muscle.path, chain.coordinate);
    path.evaluate(grid->angle_rad, grid->velocity_rad_s, length, arm, speed);
    const data::MuscleParameters& parameters =
        chain.subject ? chain.subject->muscle(muscle.name).parameters : muscle.parameters;
    const hill::MuscleTendon unit(muscle.name, parameters, chain.model);
    hill::forward(unit, {grid->time.rate_hz, length, speed, arm}, a, scratch, trace);

    Row row{name,
            muscle.name,
            0.0,
            0.0,
            0.0,
            1e300,
            0.0,
            trace.count(hill::FrameStatus::unloaded),
            trace.count(hill::FrameStatus::slack),
            clamped};
    double active = 0.0, passive = 0.0;
    for (std::size_t i = 0; i < grid->time.count; ++i) {
      total[i] += trace.moment_N_m[i];
      // The share of the parallel elastic element in the fibre's force; what damps belongs to the active part.
      const double parts = trace.active_norm[i] + trace.passive_norm[i];
      if (parts > 0.0) passive_total[i] += trace.moment_N_m[i] * trace.passive_norm[i] / parts;
      row.peak_force = std::max(row.peak_force, trace.force_N[i]);
      row.mean_moment += trace.moment_N_m[i] / static_cast<double>(grid->time.count);
      active += std::abs(trace.active_norm[i]);
      passive += std::abs(trace.passive_norm[i]);
      const double norm = trace.fibre_length_m[i] / parameters.optimal_fibre_length_m;
      row.shortest_norm = std::min(row.shortest_norm, norm);
      row.longest_norm = std::max(row.longest_norm, norm);
    }
    row.active_share = active + passive > 0.0 ? active / (active + passive) : 0.0;
    rows.push_back(row);

    const auto write = [&](const std::string& suffix, Quantity quantity, const std::string& unit_text,
                           const std::vector<double>& samples) {
      data::Signal signal{signal_on(grid->time, muscle.name + suffix, quantity, unit_text), samples};
      signal.info.muscle = muscle.name;
      out.signals->write(name, signal);
    };
    write("_force", Quantity::muscle_force, "N", trace.force_N);
    write("_fibre_length", Quantity::fibre_length, "m", trace.fibre_length_m);
    write("_fibre_velocity", Quantity::fibre_velocity, "m/s", trace.fibre_velocity_m_s);
    write("_moment_arm", Quantity::moment_arm, "m", arm);
  }
  if (!grid)
    throw data::InputError(
        "missing-muscle",
        fmt::format("no muscle of the scene spans the coordinate `{}`", chain.coordinate.name),
        "give muscles a geometry");
  data::Signal moment{signal_on(grid->time, chain.coordinate.name + "_moment", Quantity::joint_moment, "N m"),
                      total};
  moment.info.coordinate = chain.coordinate.name;
  out.signals->write(name, moment);
  out.signals->write(
      name, {signal_on(grid->time, passive_moment_name(chain.coordinate.name), Quantity::joint_moment, "N m"),
             passive_total});
  return rows;
}

void run(const StageContext& context, StageOutput& out) {
  const data::Scene& scene = context.need_scene();
  const StageData* with = context.maybe_input("subject");
  const data::Subject* subject = with ? &subject_of(*with) : nullptr;
  optimise::ModelChoice model =
      subject ? optimise::ModelChoice::from_map(subject->model) : model_choice(*context.options);
  if (const auto velocity = context.options->maybe_text("override_fibre_velocity"))
    model.fibre_velocity = hill::parse_fibre_velocity(*velocity);
  const Chain chain{scene, coordinate_of(scene, context.options->maybe_text("coordinate").value_or("")),
                    subject, model.muscle_options(), context.options->text("outside_activation") == "clamp"};
  begin_output(context, context.input("activation"), out);
  std::vector<std::vector<Row>> rows(context.trials.size());
  std::atomic<std::size_t> done{0};
  data::parallel_for(context.trials.size(), context.threads, [&](std::size_t i) {
    rows[i] = run_trial(context, chain, context.trials[i], out);
    if (context.progress)
      context.progress(static_cast<double>(++done) / static_cast<double>(context.trials.size()),
                       context.trials[i]);
  });

  TableBuilder table("muscles by trial");
  table.text("trial")
      .text("muscle")
      .number("peak_force_N", "N")
      .number("mean_moment_N_m", "N m")
      .number("active_share", "1")
      .number("shortest_fibre_norm", "1")
      .number("longest_fibre_norm", "1")
      .number("unloaded_frames", "1")
      .number("slack_frames", "1")
      .number("clamped_activations", "1");
  std::size_t clamped = 0, slack = 0;
  for (const auto& trial : rows) {
    for (const Row& r : trial) {
      table.row({r.trial, r.muscle, r.peak_force, r.mean_moment, r.active_share, r.shortest_norm,
                 r.longest_norm, static_cast<double>(r.unloaded), static_cast<double>(r.slack),
                 static_cast<double>(r.clamped)});
      clamped += r.clamped;
      slack += r.slack;
    }
  }
  out.tables["muscles"] = table.take();
  out.attributes["rung"] = model.tendon == hill::TendonKind::rigid ? "hill.rigid" : "hill.elastic";
  if (clamped > 0)
    out.warn(
        "activation-clamped",
        fmt::format("{} activation samples outside [0, 1] were brought to its ends before the muscle model",
                    clamped),
        "the table `muscles` says where");
  if (slack > 0)
    out.warn(
        "slack-muscle",
        fmt::format("{} muscle frames are slack: the path is shorter than the slack tendon allows", slack),
        "look at slack lengths and geometry; force is 0 there");
}

void fill(const ReportContext& context, report::Section& section) {
  const StageData& output = *context.output;
  std::vector<std::string> trials;
  for (const data::TrialInfo& trial : output.signals->info().trials) trials.push_back(trial.name);
  section.title += ": muscle forces";
  section.blocks.push_back(report::Paragraph{"Tension along each tendon."});
  section.blocks.push_back(trial_plots(*output.signals, trials, Quantity::muscle_force, "force"));
  report::GridOptions grid;
  grid.digits = 3;
  report::Section folded;
  grid.names = {{"active_share", "active share of the force"},
                {"shortest_fibre_norm", "shortest fibre [l0]"},
                {"longest_fibre_norm", "longest fibre [l0]"}};
  grid.decimals = {{"peak_force_N", 0},
                   {"mean_moment_N_m", 2},
                   {"active_share", 2},
                   {"shortest_fibre_norm", 2},
                   {"longest_fibre_norm", 2}};
  folded.blocks.push_back(report::make_grid(output.tables.at("muscles"), grid));
  section.blocks.push_back(report::Details{"figures of every muscle and trial", {folded}});
}

std::string methods(const ReportContext& context) {
  const auto subject = context.inputs.find("subject");
  const data::Subject* s =
      subject != context.inputs.end() && !subject->second.empty() && subject->second.front()->subject
          ? &*subject->second.front()->subject
          : nullptr;
  const std::string curves =
      s && s->model.contains("curves") ? s->model.at("curves") : context.options->text("curves");
  const std::string tendon =
      s && s->model.contains("tendon") ? s->model.at("tendon") : context.options->text("tendon");
  static const std::map<std::string, std::string> sources = {
      {"degroote_fregly_2016", "De Groote et al. 2016, doi:10.1007/s10439-016-1591-9"},
      {"thelen_2003", "Thelen 2003, doi:10.1115/1.1531112"},
      {"millard_2012", "Millard et al. 2013, doi:10.1115/1.4023390"},
      {"lloyd_2003", "Lloyd & Besier 2003, doi:10.1016/S0021-9290(03)00010-1"},
      {"lloyd_2003_spline", "Lloyd & Besier 2003, doi:10.1016/S0021-9290(03)00010-1"},
      {"guenther_2007", "Günther et al. 2007, doi:10.1007/s00422-007-0160-6"}};
  const auto source = sources.find(curves);
  return fmt::format(
      "Muscle forces are those of Hill-type muscle-tendon units (Zajac 1989, PMID 2676342) with a {} tendon "
      "and the curves of {}; the joint moment is the sum of "
      "force times moment arm.",
      tendon, source == sources.end() ? curves : source->second);
}

}  // namespace

void add_hill_stages(Catalogue& catalogue) {
  StageSpec spec;
  spec.name = "hill.moment";
  spec.summary = "activations and joint angle to muscle forces and joint moment";
  spec.doc =
      "Runs every muscle of the scene that spans the coordinate: path length, velocity and moment arm from "
      "the joint angle, force from activation and "
      "fibre state, moment as the sum of force times moment arm. Works on the activations' own time stamps; "
      "the angle is interpolated there. With a "
      "`subject` its parameters and model choices are used (the model options below are then not).\n"
      "Frames in which a muscle is slack or unloaded are counted, not hidden. Source: Zajac 1989, PMID "
      "2676342.";
  spec.needs_scene = true;
  spec.inputs = {{"activation", PortType::signals, "activations by muscle (emg.activation)"},
                 {"kinematics", PortType::signals, "joint angle, and velocity if known (limb.kinematics)",
                  false, false, true},
                 {"subject", PortType::subject, "calibrated subject", true}};
  spec.options = {
      optional_text("coordinate", "joint coordinate; may be left out where the scene has one"),
      choice_option("outside_activation", "clamp", {"clamp", "fail"},
                    "activations above 1: bring them to 1 and count them, or fail; those below 0 (ringing of "
                    "a filter) are brought to 0 and counted"),
      optional_text(
          "override_fibre_velocity",
          "`none`, `zero_lag` or `causal` instead of the subject's choice, e.g. to compare with f_v = 1")};
  for (OptionSpec& o : muscle_option_specs()) spec.options.push_back(std::move(o));
  for (OptionSpec& o : activation_option_specs()) spec.options.push_back(std::move(o));
  spec.run = run;
  spec.report = fill;
  spec.methods = methods;
  catalogue.add(std::move(spec));
}

}  // namespace brachium::pipelines
