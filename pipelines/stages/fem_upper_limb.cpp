/// fem.upper_limb: activations and joint angle to forces, lever arms and moments of continuum muscles.

#include "pipelines/stages/fem_upper_limb.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <numbers>

#include "data/model/parallel.hpp"
#include "pipelines/stages/common.hpp"
#include "pipelines/stages/fem_muscle_map.hpp"
#include "pipelines/stages/limb_groups.hpp"
#include "pipelines/stages/model_options.hpp"
#include "pipelines/stages/moment_frames.hpp"
#include "pipelines/stages/upper_limb_rungs.hpp"

namespace brachium::pipelines {
namespace {

using data::Quantity;
constexpr double degree = std::numbers::pi / 180.0;

/// One trial before its muscles are evaluated.
struct Trial {
  data::TimeGrid time;
  std::vector<bool> use;  ///< by frame
  LimbFrames frames;      ///< the frames in use
  std::size_t left_out = 0, brought = 0;
};

class Study {
 public:
  Study(const StageContext& context, StageOutput& out)
      : context_(context),
        options_(*context.options),
        out_(out),
        scene_(context.need_scene()),
        coordinate_(coordinate_of(scene_, options_.maybe_text("coordinate").value_or(""))),
        rung_(limb_rung(context)),
        grouping_(group_muscles(context, rung_->muscles())) {}

  void run() {
    begin_output(context_, context_.input("activation"), out_);
    for (const std::string& name : context_.trials) trials_.push_back(prepare(name));
    rung_->begin(context_);
    results_.assign(rung_->muscles().size(), std::vector<MuscleFrames>(trials_.size()));
    std::atomic<std::size_t> done{0};
    data::parallel_for(rung_->muscles().size(), context_.threads, [&](std::size_t m) {
      for (std::size_t t = 0; t < trials_.size(); ++t) {
        results_[m][t] = rung_->evaluate(m, trials_[t].frames);
        if (context_.progress)
          context_.progress(
              static_cast<double>(++done) / static_cast<double>(results_.size() * trials_.size()),
              fmt::format("{}, {}", rung_->muscles()[m], trials_[t].frames.trial));
      }
    });
    for (std::size_t t = 0; t < trials_.size(); ++t) write(t);
    tables();
  }

 private:
  Trial prepare(const std::string& name) const {
    const StageData& activations = context_.input("activation");
    const std::size_t t = trial_index(activations, name);
    const data::TrialInfo& info = activations.signals->info().trials[t];
    const data::Signal angle =
        signal_of(context_.input("kinematics"), name, Quantity::joint_angle, coordinate_.name);
    const std::string& first = grouping_.groups.front().members.front();
    const MomentFrames frames =
        kinematics_at(common_frames(info.signals[info.signal_index(first)], angle, std::nullopt, name), angle,
                      std::nullopt);
    Trial trial;
    std::vector<std::vector<double>> activation;
    for (const MuscleGroup& group : grouping_.groups) {
      activation.push_back(group_activation(frames, group, *activations.signals, t,
                                            options_.text("outside_activation") == "clamp", trial.brought));
    }
    const auto every = static_cast<std::size_t>(options_.integer("decimate"));
    trial.time = {frames.time.rate_hz / static_cast<double>(every), frames.time.start_s,
                  (frames.time.count - 1) / every + 1};
    trial.frames.trial = name;
    trial.frames.activation.resize(activation.size());
    for (std::size_t i = 0; i < frames.time.count; i += every) {
      const bool inside = in_range(name, frames.time.time_s(i), frames.angle_rad[i], activation, i);
      trial.use.push_back(inside);
      trial.left_out += !inside;
      if (!inside) continue;
      trial.frames.time_s.push_back(frames.time.time_s(i));
      trial.frames.angle_rad.push_back(frames.angle_rad[i]);
      for (std::size_t m = 0; m < activation.size(); ++m)
        trial.frames.activation[m].push_back(activation[m][i]);
    }
    if (trial.frames.time_s.empty())
      throw data::InputError("outside-surrogate",
                             fmt::format("no frame of trial `{}` lies between {:.4g} and {:.4g} deg", name,
                                         rung_->lower_rad() / degree, rung_->upper_rad() / degree),
                             "leave the trial out, or solve the map over its angles");
    return trial;
  }

  bool in_range(const std::string& trial, double time_s, double angle,
                const std::vector<std::vector<double>>& activation, std::size_t i) const {
    const bool angle_known = angle >= rung_->lower_rad() && angle <= rung_->upper_rad();
    std::size_t beyond = activation.size();
    for (std::size_t m = 0; m < activation.size(); ++m) {
      if (activation[m][i] > rung_->upper_activation()) beyond = m;
    }
    if (angle_known && beyond == activation.size()) return true;
    if (options_.text("outside_range") == "leave_out") return false;
    const std::string what =
        !angle_known
            ? fmt::format("the angle is {:.4g} deg, and muscles are known from {:.4g} to {:.4g} deg",
                          angle / degree, rung_->lower_rad() / degree, rung_->upper_rad() / degree)
            : fmt::format("the activation of `{}` is {:.4g}, and its states end at {:.4g}",
                          rung_->muscles()[beyond], activation[beyond][i], rung_->upper_activation());
    throw data::InputError(
        "outside-surrogate", fmt::format("trial `{}` at {:.3f} s: {}", trial, time_s, what),
        "solve the map over a wider range, leave the trial out, or choose `outside_range = "
        "\"leave_out\"` to leave such frames out and count them");
  }

  /// On all frames of the trial: those left out lie on the line between their neighbours, and `use` says so.
  std::vector<double> spread(const Trial& trial, const std::vector<double>& values) const {
    std::vector<double> out(trial.use.size());
    std::size_t k = 0;
    std::ptrdiff_t last = -1;
    for (std::size_t i = 0; i < out.size(); ++i) {
      if (!trial.use[i]) continue;
      out[i] = values[k++];
      for (std::ptrdiff_t gap = last + 1; gap < static_cast<std::ptrdiff_t>(i); ++gap) {
        const double before = last < 0 ? out[i] : out[static_cast<std::size_t>(last)];
        const double share = last < 0 ? 1.0
                                      : static_cast<double>(gap - last) /
                                            static_cast<double>(static_cast<std::ptrdiff_t>(i) - last);
        out[static_cast<std::size_t>(gap)] = before + share * (out[i] - before);
      }
      last = static_cast<std::ptrdiff_t>(i);
    }
    for (std::size_t i = static_cast<std::size_t>(last) + 1; i < out.size(); ++i)
      out[i] = out[static_cast<std::size_t>(last)];
    return out;
  }

  void write(std::size_t t) {
    const Trial& trial = trials_[t];
    const std::string& name = trial.frames.trial;
    const auto put = [&](const std::string& signal, Quantity quantity, const std::string& unit,
                         const std::vector<double>& values, const std::string& muscle) {
      data::Signal s{signal_on(trial.time, signal, quantity, unit), spread(trial, values)};
      s.info.muscle = muscle;
      if (signal == coordinate_.name + "_moment" || signal == coordinate_.name)
        s.info.coordinate = coordinate_.name;
      if (trial.left_out > 0)
        s.info.attributes["left_out"] =
            "frames where `use` is 0 are outside the model's range; straight lines there";
      out_.signals->write(name, s);
    };
    std::vector<double> total(trial.frames.time_s.size(), 0.0), passive(total);
    for (std::size_t m = 0; m < results_.size(); ++m) {
      const MuscleFrames& r = results_[m][t];
      const std::string& muscle = rung_->muscles()[m];
      for (std::size_t i = 0; i < total.size(); ++i) {
        total[i] += r.moment_n_m[i];
        passive[i] += r.passive_n_m[i];
      }
      put(muscle, Quantity::activation, "1", trial.frames.activation[m], muscle);
      put(muscle + "_force", Quantity::muscle_force, "N", r.force_n, muscle);
      put(muscle + "_moment_arm", Quantity::moment_arm, "m", r.arm_m, muscle);
    }
    put(coordinate_.name, Quantity::joint_angle, "rad", trial.frames.angle_rad, "");
    put(coordinate_.name + "_moment", Quantity::joint_moment, "N m", total, "");
    put(passive_moment_name(coordinate_.name), Quantity::joint_moment, "N m", passive, "");
    std::vector<double> use(trial.use.begin(), trial.use.end());
    data::Signal mask{signal_on(trial.time, "use", Quantity::other, "1"), use};
    out_.signals->write(name, mask);
  }

  void tables() {
    TableBuilder rows("muscles by trial"), groups("what each continuum muscle stands for");
    rows.text("trial")
        .text("muscle")
        .number("frames", "1")
        .number("left_out", "1")
        .number("peak_force_N", "N")
        .number("mean_moment_N_m", "N m")
        .number("mean_passive_N_m", "N m")
        .number("mean_arm_m", "m")
        .number("unstable_frames", "1");
    std::size_t left_out = 0, brought = 0, unstable = 0, frames = 0;
    for (std::size_t t = 0; t < trials_.size(); ++t) {
      const Trial& trial = trials_[t];
      left_out += trial.left_out;
      brought += trial.brought;
      frames += trial.use.size();
      for (std::size_t m = 0; m < results_.size(); ++m) {
        const MuscleFrames& r = results_[m][t];
        const auto mean = [](const std::vector<double>& v) {
          double sum = 0.0;
          for (const double x : v) sum += x;
          return sum / static_cast<double>(v.size());
        };
        rows.row({trial.frames.trial, rung_->muscles()[m], static_cast<double>(r.force_n.size()),
                  static_cast<double>(trial.left_out), *std::max_element(r.force_n.begin(), r.force_n.end()),
                  mean(r.moment_n_m), mean(r.passive_n_m), mean(r.arm_m), static_cast<double>(r.unstable)});
        unstable += r.unstable;
      }
    }
    groups.text("muscle").text("stands_for").number("strength_N", "N");
    for (const MuscleGroup& g : grouping_.groups)
      groups.row({g.muscle, fmt::format("{}", fmt::join(g.members, ", ")), g.sum_n()});
    out_.tables["muscles"] = rows.take();
    out_.tables["groups"] = groups.take();
    out_.attributes["rung"] = rung_->words();
    out_.attributes["left_out_muscles"] = fmt::format("{}", fmt::join(grouping_.left_out, ","));
    if (left_out > 0)
      out_.warn("frames-left-out",
                fmt::format("{} of {} frames lie outside the range of the continuum muscles ({:.4g} to "
                            "{:.4g} deg) and are left out",
                            left_out, frames, rung_->lower_rad() / degree, rung_->upper_rad() / degree));
    if (brought > 0)
      out_.note("activation-range",
                fmt::format("{} samples of activation were outside [0, 1] and brought to its ends", brought));
    if (unstable > 0)
      out_.warn("unstable-state", fmt::format("{} frames of muscles are unstable equilibria", unstable));
    if (!grouping_.left_out.empty())
      out_.warn("muscles-left-out",
                fmt::format("the continuum model lacks {}", fmt::join(grouping_.left_out, ", ")),
                "pipelines.compare says what they contribute to the lumped model's moment");
    out_.attributes["verdict"] = fmt::format("{} over {} trials, {}", fmt::join(rung_->muscles(), " and "),
                                             trials_.size(), rung_->words());
    out_.attributes["verdict_tone"] = "plain";
  }

  const StageContext& context_;
  const Options& options_;
  StageOutput& out_;
  const data::Scene& scene_;
  const data::Coordinate& coordinate_;
  std::unique_ptr<LimbRung> rung_;
  Grouping grouping_;
  std::vector<Trial> trials_;
  std::vector<std::vector<MuscleFrames>> results_;  ///< by muscle and trial
};

std::vector<data::Diagnostic> check(const CheckContext& context) {
  const Options& options = *context.options;
  Mistakes mistakes;
  mistakes.guarded(options, {}, [&] { check_lever_arm(options); });
  if (!options.has("limb")) return std::move(mistakes).list();
  const std::optional<LimbScene> limb = check_limb(context, mistakes);
  if (!limb || !context.scene || options.text("scale_to") != "none") return std::move(mistakes).list();
  check_groups(context, *limb, mistakes);
  return std::move(mistakes).list();
}

void run(const StageContext& context, StageOutput& out) {
  Study(context, out).run();
}

}  // namespace

void add_upper_limb_stage(Catalogue& catalogue) {
  StageSpec spec;
  spec.name = "fem.upper_limb";
  spec.summary = "activations and joint angle to forces, lever arms and moments of continuum muscles";
  spec.doc =
      "The continuum muscles of a limb, driven by the activations and the angle of recorded trials: from the "
      "surrogates of "
      "a muscle map (input `map`), or solved at every frame from the state before (option `limb`, with "
      "`decimate` to choose "
      "frames). A continuum muscle stands for a group of the scene's lumped muscles (`group`); its "
      "activation is the mean of "
      "theirs, weighted by their strength. What the limb is scaled by is said where it is read: here, or in "
      "the map.\n"
      "Quasi-static: forces do not depend on velocity. Frames outside the known angles end the stage, or are "
      "left out, "
      "marked in the signal `use` and counted. The passive moment is that of the same muscles at the same "
      "angle without "
      "activation.";
  spec.needs_scene = true;
  spec.inputs = {
      {"activation", PortType::signals, "activations by muscle (emg.activation)"},
      {"kinematics", PortType::signals, "joint angle (limb.kinematics)", false, false, true},
      {"map", PortType::tables, "muscle map (fem.muscle_map)", true},
      {"subject", PortType::subject, "calibrated subject: strengths that weigh activations", true}};
  spec.options = {
      optional_text("coordinate", "joint coordinate; may be left out where the scene has one"),
      choice_option("lever_arm", "virtual_work", {"virtual_work", "tdm", "vrla", "vrla_plus"},
                    "where moments come from: work of the reactions on the end's motion, or a lever arm "
                    "times the force"),
      integer_option("decimate", 1, between(1, 100000),
                     "every so many frames of the activations are evaluated"),
      choice_option(
          "outside_range", "fail", {"fail", "leave_out"},
          "frames outside the known angles and activations: fail, or leave them out and count them"),
      choice_option("outside_activation", "clamp", {"clamp", "fail"},
                    "activations above 1: bring them to 1 and count them, or fail; those below 0 are brought "
                    "to 0 and counted")};
  for (OptionSpec& o : limb_option_specs()) {
    if (o.key == "limb") {
      o.optional = true;
      o.doc = "a limb whose muscles are solved at every frame, instead of the input `map`";
    }
    spec.options.push_back(std::move(o));
  }
  spec.run = run;
  spec.check = check;
  spec.report = fill_upper_limb_report;
  spec.methods = upper_limb_methods;
  catalogue.add(std::move(spec));
}

}  // namespace brachium::pipelines
