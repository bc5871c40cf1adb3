/// optimise.muscle_forces: named parameters of continuum muscles from forces at angles and activations.

#include <fmt/format.h>

#include <algorithm>
#include <mutex>
#include <numbers>

#include "data/model/parallel.hpp"
#include "fem/limb/body_parameters.hpp"
#include "optimise/muscle_force_fit.hpp"
#include "optimise/verdicts.hpp"
#include "pipelines/stages/common.hpp"
#include "pipelines/stages/fem_muscle_map.hpp"
#include "pipelines/stages/limb_fitted.hpp"
#include "pipelines/stages/model_options.hpp"
#include "pipelines/stages/muscle_force_references.hpp"
#include "pipelines/stages/muscle_moment_references.hpp"
#include "pipelines/stages/optimise_muscle_forces.hpp"

namespace brachium::pipelines {
namespace {

using optimise::FreeBodyParameter;
using optimise::Measure;
using optimise::MuscleForceFit;
using optimise::ReferenceForce;

constexpr double degree = std::numbers::pi / 180.0;

constexpr double none = std::numeric_limits<double>::quiet_NaN();

/// Of a table of the options: for this muscle, or for all.
bool concerns(const Options& o, const std::string& muscle) {
  return o.maybe_text("muscle").value_or(muscle) == muscle;
}

bool is_of_the_law(const std::string& parameter) {
  for (const fem::BodyParameter& p : fem::body_parameters())
    if (p.name == parameter) return p.material;
  return false;
}

struct MuscleStudy {
  fem::MuscleBody in_the_limb, start;
  std::vector<FreeBodyParameter> free;
  std::vector<ReferenceForce> references;
  std::optional<MuscleForceFit> strap, continuum;
  /// With the limb's law; where a parameter of the law is free.
  std::optional<MuscleForceFit> strap_geometry, continuum_geometry;

  const fem::MuscleBody& fitted() const { return continuum->body; }
};

/// What the options alone say of a muscle.
MuscleStudy study_of(const Options& options, const fem::MuscleBody& body) {
  MuscleStudy study;
  study.in_the_limb = study.start = body;
  study.references = reference_forces(options, body.name);
  for (const Options& o : options.tables("hold")) {
    if (concerns(o, body.name)) fem::set_body_value(study.start, o.text("parameter"), o.number("value"));
  }
  for (const Options& o : options.tables("free")) {
    if (!concerns(o, body.name)) continue;
    FreeBodyParameter f{o.text("parameter")};
    if (const auto v = o.maybe_number("start")) fem::set_body_value(study.start, f.name, *v);
    f.lower = o.maybe_number("lower").value_or(fem::not_given);
    f.upper = o.maybe_number("upper").value_or(fem::not_given);
    study.free.push_back(f);
  }
  return study;
}

void check_references(const MuscleStudy& study) {
  if (study.references.empty())
    throw data::InputError("no-references",
                           fmt::format("muscle `{}` has no references", study.in_the_limb.name),
                           "add a table [[stage.reference]], or leave the muscle out with `muscles`");
}

MuscleStudy study_of(const StageContext& context, const PreparedLimb& limb, const fem::MuscleBody& body) {
  MuscleStudy study = study_of(*context.options, body);
  for (const MuscleGroup& g : limb.grouping ? limb.grouping->groups : std::vector<MuscleGroup>{}) {
    if (g.muscle != body.name || !context.maybe_input("moments")) continue;
    const std::vector<ReferenceForce> more = moment_references(context, g, limb.scene.range);
    study.references.insert(study.references.end(), more.begin(), more.end());
  }
  check_references(study);
  return study;
}

void fit(const Options& options, const PreparedLimb& limb,
         const std::function<void(const optimise::Iteration&)>& progress, MuscleStudy& study) {
  const bool rigid = limb.scene.variant == LimbVariant::rigid_tendon;
  fem::MuscleBody from = study.start;
  std::vector<FreeBodyParameter> geometry;
  for (const FreeBodyParameter& f : study.free)
    if (!is_of_the_law(f.name)) geometry.push_back(f);
  const bool in_parts = !geometry.empty() && geometry.size() < study.free.size();
  if (rigid) {
    optimise::SolveOptions o;
    o.starts = static_cast<std::size_t>(options.integer("strap_starts"));
    study.strap =
        optimise::fit_muscle_forces(from, study.free, study.references, *optimise::strap_force_model(), o);
    if (in_parts)
      study.strap_geometry = optimise::fit_muscle_forces(study.in_the_limb, geometry, study.references,
                                                         *optimise::strap_force_model(), o);
    if (options.text("begin_at") == "strap") from = study.strap->body;
  }
  optimise::ContinuumForceOptions c;
  c.range = limb.scene.range;
  c.hinge = limb.scene.hinge;
  c.bones = limb.scene.humerus;
  c.states = limb.solving;
  c.states.slopes = false;
  optimise::SolveOptions o;
  o.solver = optimise::parse_solver(options.text("optimiser"));
  o.max_iterations = static_cast<int>(options.integer("max_iterations"));
  o.max_evaluations = static_cast<int>(options.integer("max_evaluations"));
  o.cost_tolerance = options.number("cost_tolerance");
  o.progress = progress;
  const auto model = optimise::continuum_force_model(c);
  if (in_parts && options.boolean("geometry_alone"))
    study.continuum_geometry = optimise::fit_muscle_forces(
        study.strap_geometry && options.text("begin_at") == "strap" ? study.strap_geometry->body
                                                                    : study.in_the_limb,
        geometry, study.references, *model, o);
  study.continuum = optimise::fit_muscle_forces(from, study.free, study.references, *model, o);
}

/// Reference, continuum and strap, state by state, of the references of one measure.
data::Table state_table(const std::vector<MuscleStudy>& studies, Measure measure) {
  const bool forces = measure == Measure::force;
  const std::string unit = forces ? "N" : "N m", ending = forces ? "_N" : "_N_m";
  TableBuilder table(forces ? "forces" : "moments");
  table.text("muscle").text("set").number("angle_deg", "deg").number("activation", "1");
  table.text("fitted").number("reference" + ending, unit).number("continuum" + ending, unit);
  table.number("strap" + ending, unit);
  for (const MuscleStudy& s : studies) {
    for (std::size_t i = 0; i < s.references.size(); ++i) {
      const ReferenceForce& r = s.references[i];
      if (r.measure != measure) continue;
      const auto k = static_cast<Eigen::Index>(i);
      table.row({s.start.name, r.set, r.q_rad / degree, r.activation,
                 std::string(r.weight > 0.0 ? "yes" : "no"), r.value, s.continuum->value[k],
                 s.strap ? s.strap->value[k] : none});
    }
  }
  return table.take();
}

data::Table agreement_table(const std::vector<MuscleStudy>& studies) {
  TableBuilder table("agreement");
  table.text("muscle").text("model").text("set").number("states", "1").number("relative_l2", "1");
  table.number("rms_N", "N").number("worst_N", "N").number("rms_N_m", "N m").number("worst_N_m", "N m");
  table.number("worst_angle_deg", "deg").number("worst_activation", "1");
  for (const MuscleStudy& s : studies) {
    for (const auto& [model, fit] : {std::pair{"continuum", &s.continuum}, std::pair{"strap", &s.strap},
                                     std::pair{"continuum, the limb's law", &s.continuum_geometry},
                                     std::pair{"strap, the limb's law", &s.strap_geometry}}) {
      if (!fit->has_value()) continue;
      for (const optimise::ForceAgreement& a : optimise::agreement(s.references, (*fit)->value)) {
        const bool force = a.measure == Measure::force;
        table.row({s.start.name, std::string(model), a.set, static_cast<double>(a.states), a.relative_l2,
                   force ? a.rms : none, force ? a.worst : none, force ? none : a.rms, force ? none : a.worst,
                   a.worst_q_rad / degree, a.worst_activation});
      }
    }
  }
  return table.take();
}

data::Table verdicts_of(const std::vector<MuscleStudy>& studies,
                        std::optional<MuscleForceFit> MuscleStudy::*fit) {
  data::Subject all;
  for (const MuscleStudy& s : studies) {
    if ((s.*fit).has_value())
      all.verdicts.insert(all.verdicts.end(), (s.*fit)->verdicts.begin(), (s.*fit)->verdicts.end());
  }
  return optimise::verdict_table(all);
}

std::vector<std::string> changed_parameters(const Options& options) {
  std::vector<std::string> names;
  for (const std::string list : {"hold", "free"}) {
    for (const Options& o : options.tables(list)) {
      if (std::find(names.begin(), names.end(), o.text("parameter")) == names.end())
        names.push_back(o.text("parameter"));
    }
  }
  return names;
}

}  // namespace

std::vector<data::Diagnostic> check_muscle_forces(const CheckContext& context) {
  const Options& options = *context.options;
  Mistakes mistakes;
  const std::optional<LimbScene> limb = check_limb(context, mistakes);
  if (!limb) return std::move(mistakes).list();
  for (const std::string list : {"reference", "free", "hold"}) {
    for (const Options& o : options.tables(list))
      if (const auto name = o.maybe_text("muscle")) mistakes.guarded(o, {}, [&] { limb->muscle(*name); });
  }
  if (!mistakes.empty()) return std::move(mistakes).list();
  mistakes.guarded(options, {}, [&] {
    for (const std::string& name : chosen_muscles(options, *limb))
      mistakes.guarded(options, {}, [&] { study_of(options, limb->muscle(name).body); });
  });
  return std::move(mistakes).list();
}

void run_muscle_forces(const StageContext& context, StageOutput& out) {
  const Options& options = *context.options;
  PreparedLimb limb = prepare_limb(context);
  for (const std::string list : {"reference", "free", "hold"}) {
    for (const Options& o : options.tables(list))
      if (const auto name = o.maybe_text("muscle")) limb.scene.muscle(*name);  // throws where there is none
  }
  const std::vector<std::string> names = chosen_muscles(options, limb.scene);
  make_stress_free(limb, names, context);
  if (context.maybe_input("moments") && !limb.grouping) limb.grouping = group_muscles(context, names);
  std::vector<MuscleStudy> studies;
  for (const std::string& name : names)
    studies.push_back(study_of(context, limb, limb.scene.muscle(name).body));

  std::mutex one_at_a_time;
  data::parallel_for(studies.size(), context.threads, [&](std::size_t k) {
    const auto progress = [&](const optimise::Iteration& i) {
      const std::lock_guard lock(one_at_a_time);
      if (context.say)
        context.say(fmt::format("{}: iteration {}, root mean square of the sets' relative L2 errors {:.2f} %",
                                names[k], i.iteration, 100.0 * std::sqrt(2.0 * i.cost)));
      if (context.progress)
        context.progress(
            static_cast<double>(i.iteration) / static_cast<double>(options.integer("max_iterations")),
            fmt::format("{}, iteration {}", names[k], i.iteration));
    };
    fit(options, limb, progress, studies[k]);
  });

  std::vector<fem::MuscleBody> bodies;
  for (const MuscleStudy& s : studies) {
    bodies.push_back(s.fitted());
    if (!s.continuum->summary.converged)
      out.warn("not-converged", fmt::format("{}: {}", s.start.name, s.continuum->summary.reason),
               "raise `max_iterations`, or free fewer parameters");
    out.attributes["summary " + s.start.name] = s.continuum->summary.message();
  }
  out.tables["forces"] = state_table(studies, Measure::force);
  if (data::Table moments = state_table(studies, Measure::moment); moments.rows() > 0)
    out.tables["moments"] = std::move(moments);
  out.tables["agreement"] = agreement_table(studies);
  out.tables["verdicts"] = verdicts_of(studies, &MuscleStudy::continuum);
  out.tables["strap_verdicts"] = verdicts_of(studies, &MuscleStudy::strap);
  if (options.boolean("geometry_alone"))
    out.tables["geometry_verdicts"] = verdicts_of(studies, &MuscleStudy::continuum_geometry);
  out.tables["fitted"] = fitted_table(bodies, changed_parameters(options));
  out.attributes["solver"] = options.text("optimiser");
  out.attributes["variant"] = to_string(limb.scene.variant);
}

}  // namespace brachium::pipelines
