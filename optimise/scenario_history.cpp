#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "data/model/error.hpp"
#include "optimise/scenario.hpp"
#include "optimise/scenario_root.hpp"

namespace brachium::optimise {
namespace {

constexpr double degrees = 180.0 / std::numbers::pi;

// Where the limb comes to rest, from `from` in the direction of M.
struct Rest {
  double angle = 0.0;
  int iterations = 0;
  bool at_end = false;
  bool crossed = false;  // angles with dM/dq > 0 on the way
};

Rest rest_from(const StaticSystem& system, const RootFunction& f, double from,
               const ScenarioOptions& options) {
  RootPoint here = f(from);
  Rest rest{from, 1, false, false};
  if (std::abs(here.moment) <= here.tolerance) return rest;
  const double direction = here.moment > 0.0 ? 1.0 : -1.0,
               end = direction > 0.0 ? system.upper_rad : system.lower_rad;
  const double stride = (system.upper_rad - system.lower_rad) / static_cast<double>(options.scan_points - 1);
  // The first stride reaches a little beyond where the tangent sees the equilibrium.
  double length =
      here.slope < 0.0 ? std::clamp(-2.0 * std::abs(here.moment) / here.slope, 1e-9, stride) : stride;
  double x = from;
  rest.crossed = here.slope > 0.0;
  while (x != end) {
    const double next = direction > 0.0 ? std::min(x + length, end) : std::max(x - length, end);
    const RootPoint there = f(next);
    ++rest.iterations;
    if ((there.moment > 0.0) != (here.moment > 0.0) || std::abs(there.moment) <= there.tolerance) {
      double at = next;
      if (std::abs(there.moment) > there.tolerance) {
        const Root root = root_between(f, x, next, here.moment, x - here.moment / here.slope, options);
        rest.iterations += static_cast<int>(root.history.size());
        at = root.at;
      }
      rest.angle = at;
      return rest;
    }
    rest.crossed = rest.crossed || there.slope > 0.0;
    x = next;
    here = there;
    length = stride;
  }
  rest.angle = end;
  rest.at_end = true;
  return rest;
}

}  // namespace

const char* frame_kind_name(FrameKind kind) {
  switch (kind) {
    case FrameKind::followed:
      return "followed";
    case FrameKind::jumped:
      return "jumped";
    case FrameKind::at_lower:
      return "at lower end";
    case FrameKind::at_upper:
      return "at upper end";
  }
  return "";
}

AngleHistory follow(const StaticSystem& system, const std::vector<double>& time,
                    const Eigen::MatrixXd& activation, const Eigen::VectorXd& load, double start,
                    const ScenarioOptions& options) {
  const auto n = static_cast<Eigen::Index>(time.size());
  if (activation.cols() != n || load.size() != n) {
    throw data::InputError("wrong-size", fmt::format("{} times, {} columns of activations and {} loads", n,
                                                     activation.cols(), load.size()));
  }
  if (!(start >= system.lower_rad && start <= system.upper_rad)) {
    throw data::InputError("bad-range",
                           fmt::format("the start at {:.6g} rad lies outside {:.6g} to {:.6g} rad", start,
                                       system.lower_rad, system.upper_rad));
  }
  if (options.scan_points < 3)
    throw data::InputError("bad-option", "a scan for equilibria needs at least 3 points");
  AngleHistory history;
  double angle = start;
  for (Eigen::Index i = 0; i < n; ++i) {
    const Eigen::VectorXd a = activation.col(i);
    const RootFunction f = moment_of_angle(system, a, load(i), options);
    const Rest rest = rest_from(system, f, angle, options);
    const MomentState m = moment_at(system, rest.angle, a, load(i));
    Frame frame;
    frame.time_s = time[static_cast<std::size_t>(i)];
    frame.angle_rad = rest.angle;
    frame.moment_N_m = m.moment_N_m;
    frame.stiffness_N_m_per_rad = m.dangle_N_m_per_rad;
    frame.iterations = rest.iterations;
    if (rest.at_end) {
      frame.kind = m.moment_N_m > 0.0 ? FrameKind::at_upper : FrameKind::at_lower;
      frame.dangle_dactivation_rad =
          Eigen::VectorXd::Zero(a.size());  // pressed against the end: it does not move
    } else {
      frame.kind = i > 0 && rest.crossed ? FrameKind::jumped : FrameKind::followed;
      frame.dangle_dactivation_rad = -m.dactivation_N_m / m.dangle_N_m_per_rad;
      frame.dangle_dload_rad_per_N = -m.dload_m / m.dangle_N_m_per_rad;
    }
    const FrameKind before = i > 0 ? history.frames.back().kind : FrameKind::followed;
    const bool was_at_end = before == FrameKind::at_lower || before == FrameKind::at_upper;
    if (frame.kind == FrameKind::jumped) {
      history.events.push_back(fmt::format("at {:.6g} s the branch ends: jump from {:.2f} to {:.2f} deg",
                                           frame.time_s, angle * degrees, rest.angle * degrees));
    } else if (rest.at_end && before != frame.kind) {
      history.events.push_back(
          fmt::format("at {:.6g} s no equilibrium is left in the direction of the moment: from {:.2f} deg to "
                      "the end of the range at {:.2f} deg, {:.3g} N m against it",
                      frame.time_s, angle * degrees, rest.angle * degrees, std::abs(m.moment_N_m)));
    } else if (!rest.at_end && was_at_end) {
      history.events.push_back(fmt::format("at {:.6g} s it leaves the end of the range, to {:.2f} deg",
                                           frame.time_s, rest.angle * degrees));
    }
    angle = rest.angle;
    history.frames.push_back(std::move(frame));
  }
  return history;
}

}  // namespace brachium::optimise
