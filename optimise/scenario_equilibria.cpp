#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "data/model/error.hpp"
#include "optimise/scenario.hpp"
#include "optimise/scenario_root.hpp"

namespace brachium::optimise {
namespace {

// The angle between a and b where dM/dq vanishes: M turns round there. By bisection, since the second
// derivative is unknown.
double turning_point(const RootFunction& f, double a, double b, bool rising_at_a) {
  for (int i = 0; i < 60 && b - a > 1e-14 * (std::abs(a) + std::abs(b)); ++i) {
    const double c = 0.5 * (a + b);
    ((f(c).slope > 0.0) == rising_at_a ? a : b) = c;
  }
  return 0.5 * (a + b);
}

}  // namespace

Equilibria equilibria(const StaticSystem& system, const Eigen::VectorXd& activation, double load,
                      const ScenarioOptions& options) {
  if (options.scan_points < 3)
    throw data::InputError("bad-option", "a scan for equilibria needs at least 3 points");
  const RootFunction f = moment_of_angle(system, activation, load, options);
  const std::size_t n = options.scan_points;
  std::vector<double> q(n);
  std::vector<RootPoint> m(n);
  Equilibria out;
  out.nearest_moment_N_m = HUGE_VAL;
  const auto consider = [&](double at, double moment) {
    if (std::abs(moment) >= std::abs(out.nearest_moment_N_m)) return;
    out.nearest_rad = at;
    out.nearest_moment_N_m = moment;
  };
  for (std::size_t i = 0; i < n; ++i) {
    q[i] = i + 1 == n ? system.upper_rad
                      : system.lower_rad + (system.upper_rad - system.lower_rad) * static_cast<double>(i) /
                                               static_cast<double>(n - 1);
    m[i] = f(q[i]);
    consider(q[i], m[i].moment);
  }
  const auto found = [&](Root root) {
    out.all.push_back(describe_equilibrium(system, root.at, activation, load, std::move(root.history)));
  };
  const auto between = [&](double a, const RootPoint& fa, double b, const RootPoint& fb) {
    const double start = a - fa.moment * (b - a) / (fb.moment - fa.moment);  // of the chord
    found(root_between(f, a, b, fa.moment, start, options));
  };
  for (std::size_t i = 0; i < n; ++i) {
    if (m[i].moment == 0.0) found({q[i], m[i], {{0, q[i], 0.0, 0.0}}});
    if (i + 1 == n || m[i].moment == 0.0 || m[i + 1].moment == 0.0) continue;
    if ((m[i].moment > 0.0) != (m[i + 1].moment > 0.0)) {
      between(q[i], m[i], q[i + 1], m[i + 1]);
      continue;
    }
    // The same sign at both ends, but M heads for zero at both: it turns round in between.
    const double sign = m[i].moment > 0.0 ? 1.0 : -1.0;
    if (!(sign * m[i].slope < 0.0 && sign * m[i + 1].slope > 0.0)) continue;
    const double c = turning_point(f, q[i], q[i + 1], m[i].slope > 0.0);
    const RootPoint at = f(c);
    consider(c, at.moment);
    if (sign * at.moment < 0.0) {
      between(q[i], m[i], c, at);
      between(c, at, q[i + 1], m[i + 1]);
    } else if (std::abs(at.moment) <= at.tolerance) {
      found({c, at, {{0, c, at.moment, 0.0}}});
    }
  }
  for (const EquilibriumAngle& e : out.all) consider(e.angle_rad, e.moment_N_m);
  return out;
}

FromStart equilibrium_from(const StaticSystem& system, const Eigen::VectorXd& activation, double load,
                           double start, const ScenarioOptions& options) {
  if (!(start >= system.lower_rad && start <= system.upper_rad)) {
    throw data::InputError("bad-range",
                           fmt::format("the start at {:.6g} rad lies outside {:.6g} to {:.6g} rad", start,
                                       system.lower_rad, system.upper_rad));
  }
  const RootFunction f = moment_of_angle(system, activation, load, options);
  const double longest = 0.25 * (system.upper_rad - system.lower_rad);
  FromStart out;
  double x = start, step = 0.0, before = 0.0, moment_before = 0.0;
  for (int i = 0; i <= options.max_iterations; ++i) {
    const RootPoint p = f(x);
    out.history.push_back({i, x, p.moment, step});
    if (std::abs(p.moment) <= p.tolerance) {
      out.equilibrium = describe_equilibrium(system, x, activation, load, out.history);
      return out;
    }
    if (i > 0 && (p.moment > 0.0) != (moment_before > 0.0)) {  // from here on inside the bracket
      Root root = root_between(f, before, x, moment_before, x - p.moment / p.slope, options);
      for (std::size_t r = 0; r < root.history.size(); ++r) {
        ConvergenceRow row = root.history[r];
        row.iteration = i + 1 + static_cast<int>(r);
        if (r == 0) row.step = row.at - x;
        out.history.push_back(row);
      }
      out.equilibrium = describe_equilibrium(system, root.at, activation, load, out.history);
      return out;
    }
    before = x;
    moment_before = p.moment;
    const double newton = p.slope != 0.0 ? -p.moment / p.slope : std::copysign(longest, p.moment);
    const double next =
        std::clamp(x + std::clamp(newton, -longest, longest), system.lower_rad, system.upper_rad);
    step = next - x;
    if (step == 0.0) return out;  // at the end of the range, and Newton points outwards
    x = next;
  }
  return out;
}

}  // namespace brachium::optimise
