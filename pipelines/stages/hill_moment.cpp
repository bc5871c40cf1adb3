/// hill.moment: activations and joint angle to muscle forces and the joint moment.

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <optional>

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

/// Frames of a piece where frames do not depend on one another; otherwise a trial is one piece.
constexpr std::size_t piece_frames = std::size_t{1} << 17;

/// One muscle's part of a trial, for the tables.
struct Row {
  std::string trial, muscle;
  double peak_force = 0.0, moment_sum = 0.0, active = 0.0, passive = 0.0;
  double shortest_norm = std::numeric_limits<double>::infinity(), longest_norm = 0.0;
  std::size_t frames = 0, unloaded = 0, slack = 0, clamped = 0;
};

struct Chain {
  const data::Scene& scene;
  const data::Coordinate& coordinate;
  const data::Subject* subject;
  hill::MuscleModelOptions model;
  bool clamp;
};

/// One muscle of a trial: its model, its path, where its activation stands.
struct Unit {
  const data::SceneMuscle& muscle;
  const data::MuscleParameters& parameters;
  hill::MuscleTendon model;
  limb::MusclePath path;
  std::size_t activation = 0;  ///< signal
  Row row;
};

/// A trial, piece by piece: no more than a piece of each signal is in memory.
class TrialRun {
 public:
  TrialRun(const StageContext& context, const Chain& chain, const std::string& name, StageOutput& out)
      : chain_(chain), activations_(context.input("activation")), name_(name), out_(*out.signals) {
    const StageData& kinematics = context.input("kinematics");
    angle_ = signal_of(kinematics, name, Quantity::joint_angle, chain.coordinate.name);
    if (has_signal_of(kinematics, name, Quantity::joint_velocity, chain.coordinate.name))
      velocity_ = signal_of(kinematics, name, Quantity::joint_velocity, chain.coordinate.name);
    trial_ = trial_index(activations_, name);
    find_muscles();
    const data::TrialInfo& info = activations_.signals->info().trials[trial_];
    frames_ = common_frames(info.signals[units_.front().activation], angle_, velocity_, name);
  }

  std::vector<Row> operator()() {
    announce();
    const std::size_t count = frames_.time.count;
    const bool independent = hill::frames_are_independent(chain_.model, velocity_.has_value());
    const std::size_t pieces = independent ? (count - 1) / piece_frames + 1 : 1;
    for (std::size_t p = 0; p < pieces; ++p) {
      const std::size_t from = p * count / pieces, to = (p + 1) * count / pieces;
      run(kinematics_at(frames_.piece(from, to - from), angle_, velocity_), from);
    }
    std::vector<Row> rows;
    for (Unit& unit : units_) rows.push_back(std::move(unit.row));
    return rows;
  }

 private:
  void find_muscles() {
    const data::TrialInfo& info = activations_.signals->info().trials[trial_];
    for (const data::SceneMuscle& muscle : chain_.scene.muscles) {
      if (muscle.path.kind == data::PathGeometry::Kind::none ||
          muscle.path.coordinate != chain_.coordinate.name)
        continue;
      const data::MuscleParameters& parameters =
          chain_.subject ? chain_.subject->muscle(muscle.name).parameters : muscle.parameters;
      units_.push_back({muscle,
                        parameters,
                        hill::MuscleTendon(muscle.name, parameters, chain_.model),
                        limb::MusclePath(muscle.name, muscle.path, chain_.coordinate),
                        info.signal_index(muscle.name),
                        {.trial = name_, .muscle = muscle.name}});
    }
    if (units_.empty())
      throw data::InputError(
          "missing-muscle",
          fmt::format("no muscle of the scene spans the coordinate `{}`", chain_.coordinate.name),
          "give muscles a geometry");
  }

  void announce() {
    for (const Unit& unit : units_) {
      const auto begin = [&](const std::string& suffix, Quantity quantity, const std::string& unit_text) {
        data::SignalInfo info = signal_on(frames_.time, unit.muscle.name + suffix, quantity, unit_text);
        info.muscle = unit.muscle.name;
        out_.begin_signal(name_, info);
      };
      begin("_force", Quantity::muscle_force, "N");
      begin("_fibre_length", Quantity::fibre_length, "m");
      begin("_fibre_velocity", Quantity::fibre_velocity, "m/s");
      begin("_moment_arm", Quantity::moment_arm, "m");
    }
    data::SignalInfo moment = signal_on(frames_.time, moment_name(), Quantity::joint_moment, "N m");
    moment.coordinate = chain_.coordinate.name;
    out_.begin_signal(name_, moment);
    out_.begin_signal(name_, signal_on(frames_.time, passive_moment_name(chain_.coordinate.name),
                                       Quantity::joint_moment, "N m"));
  }

  void run(const MomentFrames& frames, std::size_t from) {
    check_angles(frames, chain_.coordinate, name_);
    total_.assign(frames.time.count, 0.0);
    passive_total_.assign(frames.time.count, 0.0);
    length_.resize(frames.time.count);
    arm_.resize(frames.time.count);
    speed_.resize(frames.velocity_rad_s.size());
    for (Unit& unit : units_) {
      const std::vector<double> a = activation_at(frames, *activations_.signals, trial_, unit.activation,
                                                  chain_.clamp, unit.row.clamped);
      unit.path.evaluate(frames.angle_rad, frames.velocity_rad_s, length_, arm_, speed_);
      trace_.parts = true;
      hill::forward(unit.model, {frames.time.rate_hz, length_, speed_, arm_}, a, scratch_, trace_);
      add(unit);
      const std::string& muscle = unit.muscle.name;
      out_.write_samples(name_, muscle + "_force", from, trace_.force_N);
      out_.write_samples(name_, muscle + "_fibre_length", from, trace_.fibre_length_m);
      out_.write_samples(name_, muscle + "_fibre_velocity", from, trace_.fibre_velocity_m_s);
      out_.write_samples(name_, muscle + "_moment_arm", from, arm_);
    }
    out_.write_samples(name_, moment_name(), from, total_);
    out_.write_samples(name_, passive_moment_name(chain_.coordinate.name), from, passive_total_);
  }

  void add(Unit& unit) {
    Row& row = unit.row;
    row.frames += total_.size();
    row.unloaded += trace_.count(hill::FrameStatus::unloaded);
    row.slack += trace_.count(hill::FrameStatus::slack);
    for (std::size_t i = 0; i < total_.size(); ++i) {
      total_[i] += trace_.moment_N_m[i];
      // The share of the parallel elastic element in the fibre's force; what damps belongs to the active part.
      const double parts = trace_.active_norm[i] + trace_.passive_norm[i];
      if (parts > 0.0) passive_total_[i] += trace_.moment_N_m[i] * trace_.passive_norm[i] / parts;
      row.peak_force = std::max(row.peak_force, trace_.force_N[i]);
      row.moment_sum += trace_.moment_N_m[i];
      row.active += std::abs(trace_.active_norm[i]);
      row.passive += std::abs(trace_.passive_norm[i]);
      const double norm = trace_.fibre_length_m[i] / unit.parameters.optimal_fibre_length_m;
      row.shortest_norm = std::min(row.shortest_norm, norm);
      row.longest_norm = std::max(row.longest_norm, norm);
    }
  }

  std::string moment_name() const { return chain_.coordinate.name + "_moment"; }

  const Chain& chain_;
  const StageData& activations_;
  std::string name_;
  data::SessionSink& out_;
  data::Signal angle_;
  std::optional<data::Signal> velocity_;
  std::size_t trial_ = 0;
  CommonFrames frames_;
  std::vector<Unit> units_;
  std::vector<double> total_, passive_total_, length_, arm_, speed_;
  hill::MuscleScratch scratch_;
  hill::MuscleTrace trace_;
};

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
    rows[i] = TrialRun(context, chain, context.trials[i], out)();
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
      const double parts = r.active + r.passive;
      table.row({r.trial, r.muscle, r.peak_force, r.moment_sum / static_cast<double>(r.frames),
                 parts > 0.0 ? r.active / parts : 0.0, r.shortest_norm, r.longest_norm,
                 static_cast<double>(r.unloaded), static_cast<double>(r.slack),
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
