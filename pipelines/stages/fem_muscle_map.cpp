/// fem.muscle_map: the limb's muscles over angle and activation, and surrogates of them.

#include "pipelines/stages/fem_muscle_map.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "fem/limb/muscle_reading.hpp"
#include "fem/quantities/point_fields.hpp"
#include "fem/surrogate/samples.hpp"
#include "pipelines/fingerprint.hpp"
#include "pipelines/stages/common.hpp"
#include "pipelines/stages/fem_checkpoint.hpp"
#include "pipelines/stages/fem_limb_map.hpp"
#include "pipelines/stages/fem_map_table.hpp"
#include "pipelines/stages/fem_quantities.hpp"
#include "pipelines/stages/fem_surface.hpp"

namespace brachium::pipelines {
namespace {

constexpr double degree = std::numbers::pi / 180.0;

/// What states are made from, but for which of them are asked and how they are used: those of another grid,
/// or of a map with another surrogate, are the same.
std::string states_digest(const StageContext& context) {
  Fingerprint parts = context.made_from;
  for (const std::string key :
       {"option.solver", "option.angle_deg", "option.activation", "option.state", "option.sparse_level",
        "option.surrogate", "option.show_activation", "option.muscles", "failed", "trials"})
    parts.erase(key);
  return digest(parts);
}

/// One state as the run keeps it: rows of the stage's tables.
FemTables rows_of(const std::string& muscle, const fem::MapState& state) {
  FemTables tables;
  tables["states"] = map_table({map_row(muscle, state)});
  tables["contacts"] = contact_rows(muscle, state);
  tables["fibre_stretch"] = stretch_rows(muscle, state);
  const fem::PointFields at =
      fem::point_fields(state.problem, state.discretisation, state.solved.configuration);
  auto fields = fields_at_points(state.problem, state.discretisation, at);
  std::erase_if(fields,
                [](const auto& f) { return f.first != "fibre_stretch" && f.first != "fibre_stress_pa"; });
  fields.emplace_back("contact_pressure_pa", fem::contact_pressure_pa(state.problem, state.discretisation,
                                                                      state.solved.configuration));
  tables["surface"] = FemSurface(*state.problem.mesh).state(0, state.solved.configuration, fields);
  return tables;
}

fem::StateBounds bounds_of(const std::vector<fem::StatePoint>& asked, const Options& options,
                           const fem::AngleRange& range) {
  if (options.maybe_number("sparse_level")) return {range.lower_rad, range.upper_rad, 0.0, 1.0};
  fem::StateBounds bounds{HUGE_VAL, -HUGE_VAL, HUGE_VAL, -HUGE_VAL};
  for (const fem::StatePoint& s : asked) {
    bounds.theta_lower_rad = std::min(bounds.theta_lower_rad, s.theta_rad);
    bounds.theta_upper_rad = std::max(bounds.theta_upper_rad, s.theta_rad);
    bounds.activation_lower = std::min(bounds.activation_lower, s.activation);
    bounds.activation_upper = std::max(bounds.activation_upper, s.activation);
  }
  return bounds;
}

/// A surrogate over states without figures: whether they lie where it needs them is known before anything is
/// solved.
void check_design(const std::vector<fem::StatePoint>& asked, const fem::StateBounds& bounds,
                  const std::string& method) {
  if (method == "none") return;
  fem::MuscleMap map;
  map.muscle = "any";
  map.bounds = bounds;
  for (const fem::StatePoint& s : asked) {
    fem::MuscleState state;
    state.at = s;
    state.vrla_m = state.vrla_plus_m = state.contact_force_n = 0.0;
    state.force_gradient = state.moment_gradient = fem::Gradient{};
    state.fibre_stretch = fem::FibreStretch{};
    map.states.push_back(state);
  }
  make_map_surrogate(map, method);
}

class Study {
 public:
  Study(const StageContext& context, StageOutput& out)
      : context_(context),
        out_(out),
        limb_(prepare_limb(context)),
        asked_(asked_states(*context.options, limb_.scene.range)),
        checkpoints_(context.beside.empty() ? std::filesystem::path()
                                            : std::filesystem::path(context.beside.string() + ".restart"),
                     states_digest(context)) {
    names_ = chosen_muscles(*context.options, limb_.scene);
    bounds_ = bounds_of(asked_, *context.options, limb_.scene.range);
    check_design(asked_, bounds_, context.options->text("surrogate"));
    make_stress_free(limb_, names_, context);
    for (const std::string& name : names_)
      requests_.push_back({limb_.scene.muscle(name).body,
                           limb_.scene.range,
                           limb_.scene.hinge,
                           limb_.scene.humerus,
                           limb_.solving,
                           asked_,
                           {}});
  }

  void run() {
    take_earlier();
    solve();
    tables();
    surrogates();
    surfaces();
    verdict();
  }

 private:
  void take_earlier() {
    std::size_t used = 0;
    for (const FemTables& earlier : checkpoints_.rows()) {
      const MapRow row = map_rows(earlier.at("states")).front();
      const auto at = std::find(names_.begin(), names_.end(), row.muscle);
      if (at == names_.end()) continue;
      fem::MapRequest& request = requests_[static_cast<std::size_t>(at - names_.begin())];
      const auto all = fem::states_of(request);
      const bool wanted = std::any_of(all.begin(), all.end(), [&](const fem::StatePoint& s) {
        return std::abs(s.theta_rad - row.reading.q_rad) < 1e-10 &&
               std::abs(s.activation - row.reading.activation) < 1e-10;
      });
      if (!wanted) continue;
      for (const fem::StatePoint& s : all) {
        if (std::abs(s.theta_rad - row.reading.q_rad) < 1e-10 &&
            std::abs(s.activation - row.reading.activation) < 1e-10)
          request.known.push_back(s);
      }
      keep(row.muscle, earlier);
      ++used;
    }
    if (used == 0) return;
    out_.note("restarted", fmt::format("{} states were there from an earlier run", used));
    say(fmt::format("{} states are there from an earlier run", used));
  }

  void solve() {
    std::size_t total = 0, done = 0;
    for (const fem::MapRequest& r : requests_) total += fem::states_of(r).size() - r.known.size();
    const auto observe = [&](const fem::MapState& state) {
      const std::string& muscle = names_[state.muscle];
      const FemTables rows = rows_of(muscle, state);
      if (mesh_.find(muscle) == mesh_.end()) mesh_.emplace(muscle, state.problem.mesh);
      checkpoints_.keep({}, rows);
      keep(muscle, rows);
      ++done;
      if (context_.progress)
        context_.progress(static_cast<double>(done) / static_cast<double>(total),
                          fmt::format("{} at {:.4g} deg, activation {:.3g}", muscle,
                                      state.reading.q_rad / degree, state.reading.activation));
    };
    outcomes_ = fem::solve_maps(requests_, context_.threads, observe);
    for (std::size_t m = 0; m < names_.size(); ++m) {
      for (const std::string& line : outcomes_[m].log) say(line);
      for (const fem::FailedState& f : outcomes_[m].failed) rows_.push_back(failed_row(names_[m], f));
    }
  }

  void keep(const std::string& muscle, const FemTables& rows) {
    for (const MapRow& r : map_rows(rows.at("states"))) rows_.push_back(r);
    append_rows(out_.tables["contacts"], rows.at("contacts"));
    append_rows(out_.tables["fibre_stretch"], rows.at("fibre_stretch"));
    surfaces_[muscle].push_back(
        {rows_.back().reading.q_rad, rows_.back().reading.activation, rows.at("surface")});
  }

  void tables() {
    add_tendon_displacement(rows_);
    for (MapRow& r : rows_) {
      r.asked = std::any_of(asked_.begin(), asked_.end(), [&](const fem::StatePoint& s) {
        return std::abs(s.theta_rad - r.reading.q_rad) < 1e-10 &&
               std::abs(s.activation - r.reading.activation) < 1e-10;
      });
    }
    std::stable_sort(rows_.begin(), rows_.end(), [&](const MapRow& a, const MapRow& b) {
      return std::find(names_.begin(), names_.end(), a.muscle) <
             std::find(names_.begin(), names_.end(), b.muscle);
    });
    out_.tables["states"] = map_table(rows_);
    if (limb_.scaling) out_.tables["scaling"] = limb_.scaling->table;
    TableBuilder muscles("muscles");
    muscles.text("muscle")
        .text("action")
        .number("states", "1")
        .number("failed", "1")
        .number("unstable", "1")
        .number("unknowns", "1")
        .number("pre_stretch", "1")
        .number("max_stress_Pa", "Pa")
        .text("bones");
    for (std::size_t m = 0; m < names_.size(); ++m) {
      std::size_t count = 0, failed = 0, unstable = 0;
      for (const MapRow& r : rows_) {
        if (r.muscle != names_[m]) continue;
        ++count;
        failed += r.outcome.starts_with("failed: ");
        unstable += r.outcome == "unstable";
      }
      failed_ += failed;
      unstable_ += unstable;
      const LimbMuscle& muscle = limb_.scene.muscle(names_[m]);
      muscles.row({names_[m], std::string(muscle.flexor ? "flexor" : "extensor"), static_cast<double>(count),
                   static_cast<double>(failed), static_cast<double>(unstable),
                   static_cast<double>(outcomes_[m].unknowns), muscle.body.pre_stretch,
                   muscle.body.material.max_stress_pa, fmt::format("{}", fmt::join(outcomes_[m].log, "\n"))});
    }
    out_.tables["muscles"] = muscles.take();
    out_.attributes["lower_rad"] = fmt::format("{}", bounds_.theta_lower_rad);
    out_.attributes["upper_rad"] = fmt::format("{}", bounds_.theta_upper_rad);
    out_.attributes["lower_activation"] = fmt::format("{}", bounds_.activation_lower);
    out_.attributes["upper_activation"] = fmt::format("{}", bounds_.activation_upper);
    out_.attributes["load_arm_m"] = fmt::format("{}", limb_.scene.load_arm_m);
    out_.attributes["variant"] = to_string(limb_.scene.variant);
    out_.attributes["limb"] = limb_.scene.title;
    if (!limb_.log.empty())
      out_.attributes["stress_free_shapes"] = fmt::format("{}", fmt::join(limb_.log, "\n"));
    out_.attributes["not_modelled"] =
        limb_.scene.forearm.empty()
            ? ""
            : fmt::format("contact with the bones of the forearm ({})", fmt::join(limb_.scene.forearm, ", "));
    out_.attributes["surrogate_method"] = context_.options->text("surrogate");
  }

  void surrogates() {
    if (context_.options->text("surrogate") == "none") return;
    TableBuilder errors("error of the surrogates, by leaving out"), curves("surrogates");
    errors.text("muscle")
        .text("method")
        .text("output")
        .number("states", "1")
        .number("rms", "")
        .number("greatest", "")
        .number("relative_l2", "1")
        .number("worst_angle_deg", "deg")
        .number("worst_activation", "1")
        .number("left_out", "1")
        .number("order", "1");
    curves.text("muscle")
        .number("activation", "1")
        .number("angle_deg", "deg")
        .number("force_N", "N")
        .number("moment_N_m", "N m")
        .number("dforce_dangle_N_per_rad", "N/rad")
        .number("dforce_dactivation_N", "N");
    StageData self;
    self.stage = context_.name;
    self.tables = {{"states", out_.tables.at("states")}, {"muscles", out_.tables.at("muscles")}};
    self.attributes = out_.attributes;
    LimbMap map;
    try {
      map = limb_map_of(self);
    } catch (const data::InputError& e) {
      // The states lie where they should (check_design): some could not be solved. What there is, is kept and
      // shown.
      out_.failure = e.diagnostics().front().message;
      return;
    }
    for (const MappedMuscle& m : map.muscles) {
      const fem::Surrogate& s = *m.surrogate;
      for (std::size_t o = 0; s.error() && o < s.error()->outputs.size(); ++o) {
        const auto& e = s.error()->outputs[o];
        errors.row({m.name, s.method(), e.name, static_cast<double>(s.states()), e.rms, e.greatest,
                    e.relative_l2, e.worst.theta_rad / degree, e.worst.activation,
                    static_cast<double>(s.error()->left_out), static_cast<double>(s.error()->order)});
      }
      std::vector<fem::OutputValue> values(s.outputs().size());
      for (const double a : fem::equidistant(s.bounds().activation_lower, s.bounds().activation_upper, 5)) {
        for (const double q : fem::equidistant(s.bounds().theta_lower_rad, s.bounds().theta_upper_rad, 71)) {
          s.evaluate(q, a, values);
          curves.row(
              {m.name, a, q / degree, values[0].value, values[1].value, values[0].dtheta, values[0].dalpha});
        }
      }
    }
    out_.tables["surrogate_error"] = errors.take();
    out_.tables["surrogate"] = curves.take();
  }

  void surfaces() {
    const std::vector<double>& shown = context_.options->numbers("show_activation");
    for (auto& [muscle, states] : surfaces_) {
      std::shared_ptr<const data::Mesh> mesh = mesh_.contains(muscle) ? mesh_.at(muscle) : nullptr;
      if (!mesh) mesh = fem::build(limb_.scene.muscle(muscle).body, limb_.scene.range).problem.mesh;
      std::sort(states.begin(), states.end(), [](const Surface& a, const Surface& b) {
        return std::pair(a.activation, a.q_rad) < std::pair(b.activation, b.q_rad);
      });
      int number = 0;
      data::Table all;
      for (Surface& s : states) {
        const bool show = std::any_of(shown.begin(), shown.end(),
                                      [&](double a) { return std::abs(a - s.activation) < 1e-9; });
        if (!show) continue;
        ++number;
        for (double& x : std::get<std::vector<double>>(s.table.columns.front().values)) x = number;
        s.table.columns.insert(s.table.columns.begin() + 1,
                               {{"angle_deg", "deg", std::vector<double>(s.table.rows(), s.q_rad / degree)},
                                {"activation", "1", std::vector<double>(s.table.rows(), s.activation)}});
        append_rows(all, s.table);
      }
      if (number == 0) continue;
      for (auto& [name, table] : FemSurface(*mesh).tables())
        out_.tables[name + "_" + muscle] = std::move(table);
      out_.tables["surface_states_" + muscle] = std::move(all);
    }
    bones();
  }

  /// Surfaces of the bones, for pictures.
  void bones() {
    TableBuilder points("points of the bones at 0 deg"), triangles("triangles of the bones");
    points.text("bone").text("segment").number("x_m", "m").number("y_m", "m").number("z_m", "m");
    triangles.text("bone").number("a", "1").number("b", "1").number("c", "1");
    for (const BoneSurface& s : limb_.scene.surfaces) {
      for (Eigen::Index p = 0; p < s.points.cols(); ++p)
        points.row({s.bone, std::string(s.moves ? "forearm" : "humerus"), s.points(0, p), s.points(1, p),
                    s.points(2, p)});
      for (Eigen::Index t = 0; t < s.triangles.cols(); ++t)
        triangles.row({s.bone, static_cast<double>(s.triangles(0, t)), static_cast<double>(s.triangles(1, t)),
                       static_cast<double>(s.triangles(2, t))});
    }
    out_.tables["bone_points"] = points.take();
    out_.tables["bone_triangles"] = triangles.take();
  }

  void verdict() {
    std::string text =
        fmt::format("{} states of {} solved", rows_.size() - failed_, fmt::join(names_, " and "));
    if (failed_ > 0) text += fmt::format("; {} FAILED", failed_);
    if (unstable_ > 0) text += fmt::format("; {} UNSTABLE", unstable_);
    if (out_.tables.contains("surrogate_error")) {
      const data::Table& e = out_.tables.at("surrogate_error");
      for (std::size_t k = 0; k < e.rows(); ++k) {
        if (e.texts("output")[k] == "force_n")
          text += fmt::format("; force of {}: leave-out error {:.2g} %", e.texts("muscle")[k],
                              100.0 * e.numbers("relative_l2")[k]);
      }
    }
    for (const MapRow& r : rows_) {
      if (r.outcome.starts_with("failed: ") || r.outcome == "unstable")
        out_.warn(r.outcome == "unstable" ? "unstable-state" : "failed-state",
                  fmt::format("{} at {:.4g} deg, activation {:.3g}: {}", r.muscle, r.reading.q_rad / degree,
                              r.reading.activation, r.outcome));
    }
    out_.attributes["verdict"] = text;
    out_.attributes["verdict_tone"] = failed_ + unstable_ > 0 ? "warning" : "good";
  }

  void say(const std::string& line) {
    if (context_.say) context_.say(line);
  }

  struct Surface {
    double q_rad, activation;
    data::Table table;
  };
  const StageContext& context_;
  StageOutput& out_;
  PreparedLimb limb_;
  std::vector<fem::StatePoint> asked_;
  fem::StateBounds bounds_;
  FemCheckpoints checkpoints_;
  std::vector<std::string> names_;
  std::vector<fem::MapRequest> requests_;
  std::vector<fem::MapOutcome> outcomes_;
  std::vector<MapRow> rows_;
  std::map<std::string, std::vector<Surface>> surfaces_;
  std::map<std::string, std::shared_ptr<const data::Mesh>> mesh_;
  std::size_t failed_ = 0, unstable_ = 0;
};

}  // namespace

std::vector<data::Diagnostic> check_muscle_map(const CheckContext& context) {
  const Options& options = *context.options;
  Mistakes mistakes;
  const std::optional<LimbScene> limb = check_limb(context, mistakes);
  if (!limb) return std::move(mistakes).list();
  mistakes.guarded(options, {}, [&] { chosen_muscles(options, *limb); });
  mistakes.guarded(options, {}, [&] {
    const std::vector<fem::StatePoint> asked = asked_states(options, limb->range);
    for (const fem::StatePoint& s : asked) {
      if (s.theta_rad > limb->range.lower_rad - 1e-9 && s.theta_rad < limb->range.upper_rad + 1e-9) continue;
      const std::string key = options.numbers("angle_deg").empty() ? "state" : "angle_deg";
      return mistakes.error(options, "limb-range",
                            fmt::format("`{}`: there is no state at {:.6g} deg", key, s.theta_rad / degree),
                            fmt::format("angles from {:.6g} to {:.6g} deg", limb->range.lower_rad / degree,
                                        limb->range.upper_rad / degree));
    }
    check_design(asked, bounds_of(asked, options, limb->range), options.text("surrogate"));
  });
  return std::move(mistakes).list();
}

void run_muscle_map(const StageContext& context, StageOutput& out) {
  if (context.progress) context.progress(0.0, "limb");
  Study(context, out).run();
}

}  // namespace brachium::pipelines
