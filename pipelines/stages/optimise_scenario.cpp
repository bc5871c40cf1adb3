/// optimise.scenario: questions asked of the equivalent static systems of a joint.

#include "optimise/scenario.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "pipelines/stages/common.hpp"
#include "pipelines/stages/fem_quantities.hpp"
#include "pipelines/stages/optimise_scenario.hpp"

namespace brachium::pipelines {
namespace {

constexpr double deg = std::numbers::pi / 180.0;
constexpr double none = std::numeric_limits<double>::quiet_NaN();

Eigen::VectorXd activations(const Options& o, std::size_t muscles, const std::string& what) {
  const std::vector<double>& a = o.numbers("activation");
  if (a.size() != muscles)
    throw data::InputError("wrong-size",
                           fmt::format("{} has {} activations for {} muscles", what, a.size(), muscles),
                           "give one for each muscle, in their order");
  return Eigen::Map<const Eigen::VectorXd>(a.data(), static_cast<Eigen::Index>(a.size()));
}

std::string case_name(const Options& o, std::size_t number) {
  return o.text("name").empty() ? fmt::format("{}", number + 1) : o.text("name");
}

// A series of knots, linear in between.
double at_time(const std::vector<double>& time, const std::vector<double>& values, double t) {
  const auto after = std::upper_bound(time.begin(), time.end(), t);
  if (after == time.begin()) return values.front();
  if (after == time.end()) return values.back();
  const auto i = static_cast<std::size_t>(after - time.begin());
  const double s = (t - time[i - 1]) / (time[i] - time[i - 1]);
  return values[i - 1] + s * (values[i] - values[i - 1]);
}

// ---------------------------------------------------------------- tables

struct Study {
  const Options& options;
  const fem::SurrogateModel& model;
  optimise::StaticSystem system;
  optimise::ScenarioOptions scenario;
  std::vector<std::string> muscles;
};

data::Table forces(const Study& s) {
  TableBuilder table("forces and lever arms");
  table.text("muscle")
      .number("activation", "1")
      .number("angle_deg", "deg")
      .number("force_N", "N")
      .number("moment_arm_mm", "mm")
      .number("moment_N_m", "N m");
  for (std::size_t k = 0; k < s.muscles.size(); ++k) {
    for (const double a : {0.0, 0.25, 0.5, 0.75, 1.0}) {
      for (const double q : fem::equidistant(s.system.lower_rad, s.system.upper_rad, 71)) {
        const auto m = optimise::moment_at(
            s.system, q, Eigen::VectorXd::Constant(static_cast<Eigen::Index>(s.muscles.size()), a), 0.0);
        const auto i = static_cast<Eigen::Index>(k);
        table.row({s.muscles[k], a, q / deg, m.force_N(i), 1e3 * m.moment_arm_m(i),
                   m.force_N(i) * m.moment_arm_m(i)});
      }
    }
  }
  return table.take();
}

struct Found {
  std::size_t equilibria = 0, without = 0, unstable = 0;
};

Found equilibria(const Study& s, StageOutput& out) {
  TableBuilder table("equilibria"), curves("moment against angle"), iterations("convergence");
  table.text("case").number("load_N", "N");
  for (const std::string& m : s.muscles) table.number("activation_" + m, "1");
  table.text("outcome")
      .number("angle_deg", "deg")
      .number("stiffness_N_m_per_rad", "N m/rad")
      .number("dangle_dload_deg_per_N", "deg/N");
  for (const std::string& m : s.muscles) table.number("dangle_dactivation_" + m + "_deg", "deg");
  table.number("moment_N_m", "N m").number("angle_error_deg", "deg");
  curves.text("case").number("angle_deg", "deg").number("moment_N_m", "N m");
  iterations.text("case")
      .number("start_deg", "deg")
      .number("iteration", "1")
      .number("angle_deg", "deg")
      .number("moment_N_m", "N m")
      .number("step_deg", "deg");
  Found found;
  const std::vector<Options>& cases = s.options.tables("equilibrium");
  for (std::size_t c = 0; c < cases.size(); ++c) {
    const std::string name = case_name(cases[c], c);
    const Eigen::VectorXd a = activations(cases[c], s.muscles.size(), fmt::format("equilibrium `{}`", name));
    const double load = cases[c].number("load_N");
    const optimise::Equilibria all = optimise::equilibria(s.system, a, load, s.scenario);
    const auto row = [&](const std::string& outcome, double angle, double stiffness, double by_load,
                         const Eigen::VectorXd& by_activation, double moment, double error) {
      std::vector<std::variant<double, std::string>> values{name, load};
      for (const double x : a) values.emplace_back(x);
      values.insert(values.end(), {outcome, angle, stiffness, by_load});
      for (const double x : by_activation) values.emplace_back(x);
      values.insert(values.end(), {moment, error});
      table.row(std::move(values));
    };
    for (const auto& e : all.all)
      row(e.stable ? "stable" : "unstable", e.angle_rad / deg, e.stiffness_N_m_per_rad,
          e.dangle_dload_rad_per_N / deg, e.dangle_dactivation_rad / deg, e.moment_N_m,
          e.angle_error_rad / deg);
    if (all.all.empty())
      row("none in range", all.nearest_rad / deg, none, none, Eigen::VectorXd::Constant(a.size(), none),
          all.nearest_moment_N_m, none);
    found.equilibria += all.all.size();
    found.without += all.all.empty();
    for (const auto& e : all.all) found.unstable += !e.stable;
    for (const double q : fem::equidistant(s.system.lower_rad, s.system.upper_rad, 141))
      curves.row({name, q / deg, optimise::moment_at(s.system, q, a, load).moment_N_m});
    for (const double start : s.options.numbers("start_deg")) {
      for (const auto& r : optimise::equilibrium_from(s.system, a, load, start * deg, s.scenario).history) {
        iterations.row(
            {name, start, static_cast<double>(r.iteration), r.at / deg, r.moment_N_m, r.step / deg});
      }
    }
  }
  out.tables["equilibria"] = table.take();
  out.tables["moments"] = curves.take();
  out.tables["convergence"] = iterations.take();
  return found;
}

std::size_t muscle_index(const Study& s, const std::string& name) {
  const auto at = std::find(s.muscles.begin(), s.muscles.end(), name);
  if (at == s.muscles.end())
    throw data::InputError("unknown-value", fmt::format("no muscle is called `{}`", name),
                           data::suggest(name, s.muscles));
  return static_cast<std::size_t>(at - s.muscles.begin());
}

std::size_t positions(const Study& s, StageOutput& out) {
  TableBuilder table("activations that hold an angle");
  table.text("case")
      .number("angle_deg", "deg")
      .number("load_N", "N")
      .text("sought")
      .text("outcome")
      .number("activation", "1")
      .number("dactivation_dangle_per_deg", "1/deg")
      .number("dactivation_dload_per_N", "1/N")
      .number("nearest_activation", "1")
      .number("remaining_moment_N_m", "N m")
      .number("remaining_load_N", "N")
      .number("iterations", "1");
  TableBuilder iterations("convergence of activations");
  iterations.text("case")
      .number("iteration", "1")
      .number("activation", "1")
      .number("moment_N_m", "N m")
      .number("step", "1");
  std::size_t without = 0;
  const std::vector<Options>& cases = s.options.tables("position");
  for (std::size_t c = 0; c < cases.size(); ++c) {
    const Options& o = cases[c];
    const std::string name = case_name(o, c);
    const auto held = optimise::held_angle(
        s.system, o.number("angle_deg") * deg, muscle_index(s, o.text("sought")),
        activations(o, s.muscles.size(), fmt::format("position `{}`", name)), o.number("load_N"), s.scenario);
    without += !held.activation;
    table.row({name, o.number("angle_deg"), o.number("load_N"), o.text("sought"),
               held.activation ? "held" : "none in range", held.activation.value_or(none),
               held.activation ? held.dactivation_dangle * deg : none,
               held.activation ? held.dactivation_dload : none, held.nearest, held.remaining_moment_N_m,
               held.remaining_load_N.value_or(none), static_cast<double>(held.history.size())});
    for (const optimise::ConvergenceRow& r : held.history)
      iterations.row({name, static_cast<double>(r.iteration), r.at, r.moment_N_m, r.step});
  }
  out.tables["position_convergence"] = iterations.take();
  out.tables["positions"] = table.take();
  return without;
}

/// What is given over time, at the frames that are computed.
struct Course {
  std::vector<double> knots_s, time_s;
  Eigen::VectorXd load_N;
  Eigen::MatrixXd activation;  ///< n_m x n_t
};

Course course_of(const Options& o, const std::string& what, std::size_t muscles, bool may_be_steady) {
  Course out;
  out.knots_s = o.numbers("time_s");
  const std::vector<double>&knots = out.knots_s, &loads = o.numbers("load_N"), &a = o.numbers("activation");
  const bool steady = may_be_steady && loads.size() == 1, constant = a.size() == muscles;
  if (knots.size() < 2 || !std::is_sorted(knots.begin(), knots.end(), std::less_equal<>()) ||
      (!steady && loads.size() != knots.size()) || (!constant && a.size() != muscles * knots.size())) {
    throw data::InputError("wrong-size",
                           fmt::format("{} has {} times, {} loads and {} activations for {} muscles", what,
                                       knots.size(), loads.size(), a.size(), muscles),
                           "times increase, with a load at every time (a motion may have one load at all of "
                           "them); activations are one for each "
                           "muscle, or for each muscle at every time, times first");
  }
  out.time_s = fem::equidistant(knots.front(), knots.back(), static_cast<std::size_t>(o.integer("frames")));
  const auto n = static_cast<Eigen::Index>(out.time_s.size());
  out.load_N.resize(n);
  out.activation.resize(static_cast<Eigen::Index>(muscles), n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const double t = out.time_s[static_cast<std::size_t>(i)];
    out.load_N(i) = steady ? loads.front() : at_time(knots, loads, t);
    for (std::size_t k = 0; k < muscles; ++k) {
      const auto first = a.begin() + static_cast<std::ptrdiff_t>(k * knots.size());
      out.activation(static_cast<Eigen::Index>(k), i) =
          constant ? a[k] : at_time(knots, {first, first + static_cast<std::ptrdiff_t>(knots.size())}, t);
    }
  }
  return out;
}

std::size_t motions(const Study& s, StageOutput& out) {
  TableBuilder table("activations along a motion");
  table.text("case")
      .number("time_s", "s")
      .number("angle_deg", "deg")
      .number("load_N", "N")
      .text("sought")
      .text("outcome")
      .number("activation", "1")
      .number("dactivation_dangle_per_deg", "1/deg")
      .number("nearest_activation", "1")
      .number("remaining_moment_N_m", "N m")
      .number("iterations", "1");
  std::size_t without = 0;
  const std::vector<Options>& cases = s.options.tables("motion");
  for (std::size_t c = 0; c < cases.size(); ++c) {
    const Options& o = cases[c];
    const std::string name = case_name(o, c);
    const Course course = course_of(o, fmt::format("motion `{}`", name), s.muscles.size(), true);
    const std::vector<double>& angles = o.numbers("angle_deg");
    if (angles.size() != course.knots_s.size())
      throw data::InputError(
          "wrong-size",
          fmt::format("motion `{}` has {} times and {} angles", name, course.knots_s.size(), angles.size()),
          "give an angle at every time");
    Eigen::VectorXd angle(course.load_N.size());
    for (Eigen::Index i = 0; i < angle.size(); ++i)
      angle(i) = at_time(course.knots_s, angles, course.time_s[static_cast<std::size_t>(i)]) * deg;
    const auto frames = optimise::hold(s.system, course.time_s, angle, muscle_index(s, o.text("sought")),
                                       course.activation, course.load_N, s.scenario);
    for (std::size_t i = 0; i < frames.size(); ++i) {
      const optimise::HeldAngle& held = frames[i].held;
      without += !held.activation;
      table.row({name, frames[i].time_s, angle(static_cast<Eigen::Index>(i)) / deg,
                 course.load_N(static_cast<Eigen::Index>(i)), o.text("sought"),
                 held.activation ? "held" : "none in range", held.activation.value_or(none),
                 held.activation ? held.dactivation_dangle * deg : none, held.nearest,
                 held.remaining_moment_N_m, static_cast<double>(held.history.size())});
    }
  }
  out.tables["motions"] = table.take();
  return without;
}

void histories(const Study& s, StageOutput& out) {
  TableBuilder table("histories"), events("events");
  table.text("case")
      .number("time_s", "s")
      .number("load_N", "N")
      .number("angle_deg", "deg")
      .text("kind")
      .number("moment_N_m", "N m")
      .number("dangle_dload_deg_per_N", "deg/N")
      .number("evaluations", "1");
  events.text("case").text("event");
  const std::vector<Options>& cases = s.options.tables("history");
  for (std::size_t c = 0; c < cases.size(); ++c) {
    const Options& o = cases[c];
    const std::string name = case_name(o, c);
    const Course course = course_of(o, fmt::format("history `{}`", name), s.muscles.size(), false);
    const std::vector<double>& time = course.time_s;
    const Eigen::VectorXd& load = course.load_N;
    const optimise::AngleHistory history =
        optimise::follow(s.system, time, course.activation, load, o.number("start_deg") * deg, s.scenario);
    for (Eigen::Index i = 0; i < load.size(); ++i) {
      const optimise::Frame& f = history.frames[static_cast<std::size_t>(i)];
      table.row({name, f.time_s, load(i), f.angle_rad / deg, optimise::frame_kind_name(f.kind), f.moment_N_m,
                 f.dangle_dload_rad_per_N / deg, static_cast<double>(f.iterations)});
    }
    for (const std::string& e : history.events) events.row({name, e});
  }
  out.tables["histories"] = table.take();
  out.tables["events"] = events.take();
}

}  // namespace

namespace {

/// A table's rows under the name of their system.
void append_under(const std::string& system, data::Table rows, data::Table& all) {
  rows.columns.insert(rows.columns.begin(), {"system", "", std::vector<std::string>(rows.rows(), system)});
  append_rows(all, rows);
}

}  // namespace

void run_scenarios(const StageContext& context, StageOutput& out) {
  std::vector<std::string> names;
  Found found;
  std::size_t not_held = 0;
  const std::vector<ScenarioSystem> systems = scenario_systems(context);
  for (const ScenarioSystem& system : systems) {
    Study study{*context.options, *system.model, system.system, {}, system.model->muscles()};
    study.scenario.relative_tolerance = context.options->number("relative_tolerance");
    StageOutput one;
    one.tables["forces"] = forces(study);
    const Found here = equilibria(study, one);
    found.equilibria += here.equilibria;
    found.without += here.without;
    found.unstable += here.unstable;
    not_held += positions(study, one);
    not_held += motions(study, one);
    histories(study, one);
    for (auto& [name, table] : one.tables) append_under(system.name, std::move(table), out.tables[name]);
    names.push_back(system.name);
    if (context.progress)
      context.progress(static_cast<double>(names.size()) / static_cast<double>(systems.size()), system.name);
  }
  out.attributes["rung"] = systems.front().model->traits().rung;
  out.attributes["systems"] = fmt::format("{}", fmt::join(names, "\n"));
  out.attributes["signs"] = "flexion positive; a load above 0 extends";
  out.attributes["verdict"] = fmt::format(
      "{}{} equilibria ({} unstable); without one in range: {} of activations and load, {} of angles",
      systems.size() > 1 ? fmt::format("{} systems: ", systems.size()) : "", found.equilibria, found.unstable,
      found.without, not_held);
  out.attributes["verdict_tone"] = "plain";
}

}  // namespace brachium::pipelines
