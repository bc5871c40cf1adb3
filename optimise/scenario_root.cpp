#include "optimise/scenario_root.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "data/model/error.hpp"

namespace brachium::optimise {

Root root_between(const RootFunction& f, double a, double b, double fa, double start,
                  const ScenarioOptions& options) {
  Root root;
  if (a > b) {
    std::swap(a, b);
    fa = -fa;  // only the sign is used, and the other end has the other one
  }
  double x = start > a && start < b ? start : 0.5 * (a + b);
  double step = 0.0, width = b - a;
  for (int i = 0; i <= options.max_iterations; ++i) {
    const RootPoint p = f(x);
    root.history.push_back({i, x, p.moment, step});
    root.at = x;
    root.point = p;
    if (std::abs(p.moment) <= p.tolerance) return root;
    if ((p.moment > 0.0) == (fa > 0.0)) {
      a = x;
    } else {
      b = x;
    }
    double next = x - p.moment / p.slope;
    // Bisect where Newton leaves the bracket, or the bracket has not halved twice in four steps and Newton
    // does not either.
    const bool slow =
        i > 0 && i % 4 == 0 && b - a > 0.25 * width && std::abs(next - x) > 0.5 * std::abs(step);
    if (i % 4 == 0) width = b - a;
    if (!(next > a && next < b) || slow) next = 0.5 * (a + b);
    step = next - x;
    // As close to the change of sign as numbers allow, and what is left of M is their rounding.
    const double rounding = 1e-14 * std::max(std::abs(a), std::abs(b));
    if (next == x || b - a <= rounding ||
        (std::abs(step) <= rounding && std::abs(p.moment) <= std::abs(p.slope) * rounding)) {
      if (std::abs(p.moment) <= 10.0 * std::abs(p.slope) * rounding) return root;
      if (next == x || b - a <= rounding) break;
    }
    x = next;
  }
  throw data::ConvergenceFailure(
      {"static equilibrium",
       fmt::format("the moment at {:.9g} stays at {:.3g} N m, above its tolerance of {:.3g} N m", root.at,
                   root.point.moment, root.point.tolerance),
       static_cast<int>(root.history.size()),
       root.point.moment,
       step,
       {}});
}

RootFunction moment_of_angle(const StaticSystem& system, const Eigen::VectorXd& activation, double load,
                             const ScenarioOptions& options) {
  return [&system, activation, load, options](double q) {
    const MomentState m = moment_at(system, q, activation, load);
    return RootPoint{m.moment_N_m, m.dangle_N_m_per_rad, stopping_moment(m, options)};
  };
}

EquilibriumAngle describe_equilibrium(const StaticSystem& system, double angle,
                                      const Eigen::VectorXd& activation, double load,
                                      std::vector<ConvergenceRow> history) {
  const MomentState m = moment_at(system, angle, activation, load);
  EquilibriumAngle e;
  e.angle_rad = angle;
  e.stiffness_N_m_per_rad = m.dangle_N_m_per_rad;
  e.stable = m.dangle_N_m_per_rad < 0.0;
  e.moment_N_m = m.moment_N_m;
  e.dangle_dactivation_rad = -m.dactivation_N_m / m.dangle_N_m_per_rad;
  e.dangle_dload_rad_per_N = -m.dload_m / m.dangle_N_m_per_rad;
  e.angle_error_rad = m.error_bound_N_m / std::abs(m.dangle_N_m_per_rad);
  e.history = std::move(history);
  return e;
}

}  // namespace brachium::optimise
