#include "pipelines/stages/fem_map_table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "fem/quantities/point_fields.hpp"
#include "pipelines/stages/common.hpp"

namespace brachium::pipelines {
namespace {

constexpr double degree = std::numbers::pi / 180.0;
constexpr double stretch_interval = 0.02;

/// To a billionth of a degree, so that an angle that went through radians is the same number again.
double degrees(double q_rad) {
  return std::round(1e9 * q_rad / degree) / 1e9;
}

struct Field {
  const char* name;
  const char* unit;
  double& (*of)(MapRow&);
};

const std::vector<Field>& fields() {
  using R = MapRow&;
  static const std::vector<Field> all{
      {"force_N", "N", [](R r) -> double& { return r.reading.force_n; }},
      {"tension_N", "N", [](R r) -> double& { return r.reading.tension_n; }},
      {"moment_N_m", "N m", [](R r) -> double& { return r.reading.moment_n_m; }},
      {"dforce_dangle_N_per_rad", "N/rad", [](R r) -> double& { return r.reading.force_slope_n.by_q; }},
      {"dforce_dactivation_N", "N", [](R r) -> double& { return r.reading.force_slope_n.by_activation; }},
      {"dmoment_dangle_N_m_per_rad", "N m/rad",
       [](R r) -> double& { return r.reading.moment_slope_n_m.by_q; }},
      {"dmoment_dactivation_N_m", "N m",
       [](R r) -> double& { return r.reading.moment_slope_n_m.by_activation; }},
      {"length_m", "m", [](R r) -> double& { return r.reading.length_m; }},
      {"tdm_m", "m", [](R r) -> double& { return r.tdm_m; }},
      {"vrla_m", "m", [](R r) -> double& { return r.reading.arms.vrla_m; }},
      {"vrla_plus_m", "m", [](R r) -> double& { return r.reading.arms.vrla_plus_m; }},
      {"contact_force_N", "N", [](R r) -> double& { return r.contact_force_n; }},
      {"greatest_pressure_Pa", "Pa", [](R r) -> double& { return r.greatest_pressure_pa; }},
      {"greatest_penetration_m", "m", [](R r) -> double& { return r.greatest_penetration_m; }},
      {"least_gap_left_out_m", "m", [](R r) -> double& { return r.reading.least_gap_left_out_m; }},
      {"least_fibre_stretch", "1", [](R r) -> double& { return r.reading.stretch_min; }},
      {"mean_fibre_stretch", "1", [](R r) -> double& { return r.reading.stretch_mean; }},
      {"greatest_fibre_stretch", "1", [](R r) -> double& { return r.reading.stretch_max; }},
      {"fibre_stretch_deviation", "1", [](R r) -> double& { return r.stretch_deviation; }},
      {"energy_J", "J", [](R r) -> double& { return r.reading.energy_j; }},
      {"resultant_x_N", "N", [](R r) -> double& { return r.reading.wrench.force_n[0]; }},
      {"resultant_y_N", "N", [](R r) -> double& { return r.reading.wrench.force_n[1]; }},
      {"resultant_z_N", "N", [](R r) -> double& { return r.reading.wrench.force_n[2]; }},
      {"couple_x_N_m", "N m", [](R r) -> double& { return r.reading.wrench.moment_n_m[0]; }},
      {"couple_y_N_m", "N m", [](R r) -> double& { return r.reading.wrench.moment_n_m[1]; }},
      {"couple_z_N_m", "N m", [](R r) -> double& { return r.reading.wrench.moment_n_m[2]; }},
      {"end_x_m", "m", [](R r) -> double& { return r.reading.end_m[0]; }},
      {"end_y_m", "m", [](R r) -> double& { return r.reading.end_m[1]; }},
      {"end_z_m", "m", [](R r) -> double& { return r.reading.end_m[2]; }},
      {"moment_of_wrench_N_m", "N m", [](R r) -> double& { return r.reading.arms.moment_n_m; }},
      {"moment_by_stress_N_m", "N m", [](R r) -> double& { return r.reading.moment_by_stress_n_m; }},
      {"identity_error_m", "m", [](R r) -> double& { return r.reading.identity_error; }},
      {"relative_residual", "1", [](R r) -> double& { return r.reading.relative_residual; }},
      {"solve_s", "s", [](R r) -> double& { return r.reading.seconds; }},
  };
  return all;
}

std::vector<double> shares(const fem::MapState& state, const fem::PointFields& fields) {
  std::vector<double> weight(static_cast<std::size_t>(fields.fibre_stretch.size()), 0.0);
  const int points = state.discretisation.quadrature().size();
  Eigen::MatrixX3d gradient;
  for (int c = 0; c < state.discretisation.cell_count(); ++c) {
    for (int q = 0; q < points; ++q) {
      const auto k = static_cast<std::size_t>(q + points * c);
      state.discretisation.reference_gradients(c, q, gradient, weight[k]);
      if (state.problem.tissue.muscle.size() > 0)
        weight[k] *= state.problem.tissue.muscle[static_cast<Eigen::Index>(k)];
    }
  }
  double sum = 0.0;
  for (const double w : weight) sum += w;
  for (double& w : weight) w /= sum;
  return weight;
}

}  // namespace

MapRow map_row(const std::string& muscle, const fem::MapState& state) {
  MapRow row;
  row.muscle = muscle;
  row.reading = state.reading;
  const fem::PointFields at =
      fem::point_fields(state.problem, state.discretisation, state.solved.configuration);
  const std::vector<double> share = shares(state, at);
  double mean = 0.0, square = 0.0;
  for (std::size_t k = 0; k < share.size(); ++k) {
    const double stretch = at.fibre_stretch[static_cast<Eigen::Index>(k)];
    mean += share[k] * stretch;
    square += share[k] * stretch * stretch;
  }
  row.reading.stretch_mean = mean;  // of muscle tissue, as the distribution
  row.stretch_deviation = std::sqrt(std::max(0.0, square - mean * mean));
  for (const fem::BoneContact& c : state.reading.contacts) {
    row.contact_force_n += c.force_n;
    row.greatest_pressure_pa = std::max(row.greatest_pressure_pa, c.greatest_pressure_pa);
    row.greatest_penetration_m = std::max(row.greatest_penetration_m, c.greatest_penetration_m);
  }
  if (!std::isfinite(row.reading.least_gap_left_out_m))
    row.reading.least_gap_left_out_m = std::numeric_limits<double>::quiet_NaN();  // no bone is left out
  row.outcome = state.reading.stability;
  return row;
}

MapRow failed_row(const std::string& muscle, const fem::FailedState& failed) {
  MapRow row;
  for (const Field& f : fields()) f.of(row) = std::numeric_limits<double>::quiet_NaN();
  row.muscle = muscle;
  row.reading.q_rad = failed.at.theta_rad;
  row.reading.activation = failed.at.activation;
  row.outcome = "failed: " + failed.reason;
  return row;
}

data::Table map_table(const std::vector<MapRow>& rows) {
  std::vector<std::string> order;
  for (const MapRow& r : rows) {
    if (std::find(order.begin(), order.end(), r.muscle) == order.end()) order.push_back(r.muscle);
  }
  std::vector<const MapRow*> sorted;
  for (const MapRow& r : rows) sorted.push_back(&r);
  const auto key = [&](const MapRow* r) {
    return std::tuple(std::find(order.begin(), order.end(), r->muscle) - order.begin(),
                      degrees(r->reading.q_rad), r->reading.activation);
  };
  std::stable_sort(sorted.begin(), sorted.end(),
                   [&](const MapRow* a, const MapRow* b) { return key(a) < key(b); });
  TableBuilder table("states");
  table.text("muscle").number("angle_deg", "deg").number("activation", "1").number("asked", "1");
  for (const Field& f : fields()) table.number(f.name, f.unit);
  table.number("load_steps", "1")
      .number("newton_iterations", "1")
      .number("chord_iterations", "1")
      .text("outcome");
  for (const MapRow* r : sorted) {
    MapRow row = *r;
    std::vector<std::variant<double, std::string>> values{row.muscle, degrees(row.reading.q_rad),
                                                          row.reading.activation, row.asked ? 1.0 : 0.0};
    for (const Field& f : fields()) values.emplace_back(f.of(row));
    values.emplace_back(static_cast<double>(row.reading.steps));
    values.emplace_back(static_cast<double>(row.reading.newton_iterations));
    values.emplace_back(static_cast<double>(row.reading.chord_iterations));
    values.emplace_back(row.outcome);
    table.row(std::move(values));
  }
  return table.take();
}

std::vector<MapRow> map_rows(const data::Table& table) {
  std::vector<MapRow> rows(table.rows());
  for (std::size_t k = 0; k < rows.size(); ++k) {
    MapRow& row = rows[k];
    row.muscle = table.texts("muscle")[k];
    row.outcome = table.texts("outcome")[k];
    row.reading.stability = row.outcome;
    row.reading.q_rad = table.numbers("angle_deg")[k] * degree;
    row.reading.activation = table.numbers("activation")[k];
    row.asked = table.numbers("asked")[k] != 0.0;
    row.reading.steps = static_cast<int>(table.numbers("load_steps")[k]);
    row.reading.newton_iterations = static_cast<long>(table.numbers("newton_iterations")[k]);
    row.reading.chord_iterations = static_cast<long>(table.numbers("chord_iterations")[k]);
    for (const Field& f : fields()) f.of(row) = table.numbers(f.name)[k];
  }
  return rows;
}

data::Table contact_rows(const std::string& muscle, const fem::MapState& state) {
  TableBuilder table("contacts");
  table.text("muscle")
      .number("angle_deg", "deg")
      .number("activation", "1")
      .text("bone")
      .number("force_N", "N")
      .number("force_x_N", "N")
      .number("force_y_N", "N")
      .number("force_z_N", "N")
      .number("greatest_pressure_Pa", "Pa")
      .number("greatest_penetration_m", "m")
      .number("area_m2", "m^2");
  for (const fem::BoneContact& c : state.reading.contacts)
    table.row({muscle, degrees(state.reading.q_rad), state.reading.activation, c.bone, c.force_n,
               c.force_on_muscle_n[0], c.force_on_muscle_n[1], c.force_on_muscle_n[2], c.greatest_pressure_pa,
               c.greatest_penetration_m, c.area_m2});
  return table.take();
}

data::Table stretch_rows(const std::string& muscle, const fem::MapState& state) {
  const fem::PointFields at =
      fem::point_fields(state.problem, state.discretisation, state.solved.configuration);
  const std::vector<double> share = shares(state, at);
  std::map<int, double> by_interval;
  for (std::size_t k = 0; k < share.size(); ++k)
    by_interval[static_cast<int>(
        std::floor(at.fibre_stretch[static_cast<Eigen::Index>(k)] / stretch_interval))] += share[k];
  TableBuilder table("distribution of fibre stretch");
  table.text("muscle")
      .number("angle_deg", "deg")
      .number("activation", "1")
      .number("stretch", "1")
      .number("share", "1");
  for (const auto& [interval, part] : by_interval)
    table.row({muscle, degrees(state.reading.q_rad), state.reading.activation,
               (interval + 0.5) * stretch_interval, part});
  return table.take();
}

void add_tendon_displacement(std::vector<MapRow>& rows) {
  std::map<std::string, std::vector<fem::SolvedMuscle>> by_muscle;
  for (const MapRow& r : rows) {
    if (std::isfinite(r.reading.length_m)) by_muscle[r.muscle].push_back(r.reading);
  }
  for (const auto& [muscle, readings] : by_muscle) {
    for (const auto& [q, arm] : fem::passive_lever_arms(readings)) {
      for (MapRow& r : rows) {
        if (r.muscle == muscle && std::abs(r.reading.q_rad - q) < 1e-9) r.tdm_m = arm;
      }
    }
  }
}

std::vector<std::string> muscles_of(const data::Table& states) {
  std::vector<std::string> names;
  for (const std::string& m : states.texts("muscle")) {
    if (std::find(names.begin(), names.end(), m) == names.end()) names.push_back(m);
  }
  return names;
}

fem::MuscleMap muscle_map_of(const data::Table& states, const std::string& muscle,
                             const std::string& variant) {
  fem::MuscleMap map;
  map.muscle = muscle;
  map.variant = variant;
  map.bounds = {HUGE_VAL, -HUGE_VAL, HUGE_VAL, -HUGE_VAL};
  for (const MapRow& r : map_rows(states)) {
    if (r.muscle != muscle || !r.asked) continue;
    const fem::StatePoint at{r.reading.q_rad, r.reading.activation};
    map.bounds.theta_lower_rad = std::min(map.bounds.theta_lower_rad, at.theta_rad);
    map.bounds.theta_upper_rad = std::max(map.bounds.theta_upper_rad, at.theta_rad);
    map.bounds.activation_lower = std::min(map.bounds.activation_lower, at.activation);
    map.bounds.activation_upper = std::max(map.bounds.activation_upper, at.activation);
    if (r.outcome.starts_with("failed: ")) {
      map.failed.push_back({at, r.outcome.substr(8)});
      continue;
    }
    fem::MuscleState s = fem::map_state(r.reading, {});
    s.contact_force_n = r.contact_force_n;
    s.fibre_stretch->deviation = r.stretch_deviation;
    if (std::isfinite(r.tdm_m)) s.tdm_m = r.tdm_m;
    map.states.push_back(s);
  }
  if (map.states.empty() && map.failed.empty())
    throw data::InputError("missing-muscle", fmt::format("the map has no muscle `{}`", muscle),
                           data::suggest(muscle, muscles_of(states)));
  return map;
}

}  // namespace brachium::pipelines
