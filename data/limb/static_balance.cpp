#include "data/limb/static_balance.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "data/model/error.hpp"

namespace brachium::limb {
namespace {

using Moment = std::function<double(double)>;

double checked(const Moment& moment, double q) {
  const double m = moment(q);
  if (!std::isfinite(m)) {
    throw data::ConvergenceFailure(
        {"static balance", fmt::format("the moment at {:.6g} rad is not a finite number", q), 0, m, 0.0, {}});
  }
  return m;
}

// Bisection with secant steps where they fall inside the bracket (the Illinois variant of regula falsi):
// never leaves it.
double bracketed_root(const Moment& moment, double a, double b, double fa, double fb,
                      const BalanceOptions& options) {
  for (int i = 0; i < 200 && std::abs(b - a) > options.angle_tolerance_rad; ++i) {
    double c = (a * fb - b * fa) / (fb - fa);
    if (!(c > std::min(a, b) && c < std::max(a, b)) || i % 3 == 2) c = 0.5 * (a + b);
    const double fc = checked(moment, c);
    if (fc == 0.0) return c;
    if ((fc > 0.0) == (fb > 0.0)) {
      fa *= 0.5;
    } else {
      a = b;
      fa = fb;
    }
    b = c;
    fb = fc;
    if (std::abs(fc) < 1e-3 * options.moment_tolerance_N_m) break;
  }
  return b;
}

// Smallest |M| between a and b by golden section (Kiefer 1953); stops early where M changes sign.
double smallest(const Moment& moment, double a, double b, double sign, const BalanceOptions& options) {
  const double golden = 0.5 * (std::sqrt(5.0) - 1.0);
  double c = b - golden * (b - a), d = a + golden * (b - a);
  double fc = sign * checked(moment, c), fd = sign * checked(moment, d);
  while (b - a > options.angle_tolerance_rad && fc > 0.0 && fd > 0.0) {
    if (fc < fd) {
      b = d;
      d = c;
      fd = fc;
      c = b - golden * (b - a);
      fc = sign * checked(moment, c);
    } else {
      a = c;
      c = d;
      fc = fd;
      d = a + golden * (b - a);
      fd = sign * checked(moment, d);
    }
  }
  return fc < fd ? c : d;
}

Equilibrium describe(const Moment& moment, double q, double lower, double upper) {
  const double h = 1e-5 * (upper - lower);
  const double left = std::max(lower, q - h), right = std::min(upper, q + h);
  Equilibrium e;
  e.angle_rad = q;
  e.residual_N_m = checked(moment, q);
  e.stiffness_N_m_per_rad = (checked(moment, right) - checked(moment, left)) / (right - left);
  e.stable = e.stiffness_N_m_per_rad < 0.0;
  return e;
}

}  // namespace

Balance balance_of(const Moment& moment, double lower, double upper, const BalanceOptions& options) {
  if (!(lower < upper) || options.scan_points < 3 || !(options.angle_tolerance_rad > 0.0) ||
      !(options.moment_tolerance_N_m > 0.0)) {
    throw data::InputError(
        "out-of-range",
        "static balance needs a range of angles, at least 3 scan points and tolerances above 0");
  }
  const std::size_t n = options.scan_points;
  std::vector<double> q(n), m(n);
  for (std::size_t i = 0; i < n; ++i) {
    q[i] = i + 1 == n ? upper : lower + (upper - lower) * static_cast<double>(i) / static_cast<double>(n - 1);
    m[i] = checked(moment, q[i]);
  }
  std::vector<double> roots;
  double nearest = q[0], off = std::abs(m[0]);
  const auto consider = [&](double angle, double value) {
    if (std::abs(value) >= off) return;
    nearest = angle;
    off = std::abs(value);
  };
  for (std::size_t i = 0; i < n; ++i) {
    consider(q[i], m[i]);
    if (m[i] == 0.0) {
      roots.push_back(q[i]);
      continue;
    }
    if (i + 1 < n && m[i + 1] != 0.0 && (m[i] > 0.0) != (m[i + 1] > 0.0)) {
      roots.push_back(bracketed_root(moment, q[i], q[i + 1], m[i], m[i + 1], options));
    }
    // A dip of |M| that does not change sign on the grid may hide two roots, or one that is only touched.
    if (i == 0 || i + 1 == n || m[i - 1] == 0.0 || m[i + 1] == 0.0) continue;
    const double sign = m[i] > 0.0 ? 1.0 : -1.0;
    // `<=` on one side only: of two equal lowest points, one speaks for both.
    if (!(sign * m[i] <= sign * m[i - 1] && sign * m[i] < sign * m[i + 1] && sign * m[i - 1] > 0.0 &&
          sign * m[i + 1] > 0.0))
      continue;
    const double c = smallest(moment, q[i - 1], q[i + 1], sign, options);
    const double mc = checked(moment, c);
    consider(c, mc);
    if (sign * mc < 0.0) {
      roots.push_back(bracketed_root(moment, q[i - 1], c, m[i - 1], mc, options));
      roots.push_back(bracketed_root(moment, c, q[i + 1], mc, m[i + 1], options));
    } else if (std::abs(mc) <= options.moment_tolerance_N_m) {
      roots.push_back(c);
    }
  }
  std::sort(roots.begin(), roots.end());
  Balance result;
  for (const double root : roots) {
    result.equilibria.push_back(describe(moment, root, lower, upper));
    consider(root, result.equilibria.back().residual_N_m);
  }
  result.nearest = describe(moment, nearest, lower, upper);
  return result;
}

Balance static_balance(const MuscleModel& model, const Eigen::VectorXd& activation,
                       const ExternalMoment& external, const Eigen::VectorXd& q, double lower, double upper,
                       const BalanceOptions& options) {
  if (model.traits().state_size != 0) {
    throw data::InputError(
        "not-quasi-static",
        fmt::format("static balance needs a model without internal state; `{}` has {} states",
                    model.traits().rung, model.traits().state_size));
  }
  if (static_cast<std::size_t>(q.size()) != model.coordinates().size() ||
      options.coordinate >= model.coordinates().size()) {
    throw data::InputError("wrong-size",
                           fmt::format("{} angles and coordinate {} for a model of {} coordinates", q.size(),
                                       options.coordinate + 1, model.coordinates().size()));
  }
  const auto at = static_cast<Eigen::Index>(options.coordinate);
  const Eigen::VectorXd still = Eigen::VectorXd::Zero(q.size());
  const Eigen::VectorXd no_state;
  Eigen::VectorXd angles = q;
  Evaluation evaluation;
  return balance_of(
      [&](double angle) {
        angles(at) = angle;
        model.evaluate(angles, still, activation, no_state, evaluation);
        return evaluation.moment(at) + (external ? external(angles) : 0.0);
      },
      lower, upper, options);
}

}  // namespace brachium::limb
