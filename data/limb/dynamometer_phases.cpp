#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "data/limb/dynamometer.hpp"
#include "data/model/error.hpp"

namespace brachium::limb {
namespace {

using Eigen::Index;

Index samples_of(double duration_s, double rate_hz) {
  return std::max<Index>(1, static_cast<Index>(std::ceil(duration_s * rate_hz)));
}

Phase phase_over(const Eigen::VectorXd& values, Index first, Index last) {
  Phase p;
  p.first = first;
  p.last = last;
  const auto part = values.segment(first, last - first);
  p.mean = part.mean();
  p.sd = std::sqrt((part.array() - p.mean).square().mean());
  return p;
}

void require_positive(double value, const char* what) {
  if (!(value > 0.0) || !std::isfinite(value)) {
    throw data::InputError("out-of-range", fmt::format("the {} must be greater than 0, not {}", what, value));
  }
}

}  // namespace

std::vector<Phase> isokinetic_phases(const DynamometerRecord& record, const IsokineticOptions& options) {
  require_positive(options.speed_rad_per_s, "isokinetic speed");
  require_positive(options.relative_tolerance, "isokinetic tolerance");
  const Eigen::VectorXd& v = record.velocity_rad_per_s;
  const Index shortest = samples_of(options.min_duration_s, record.rate_hz);
  // +1 or -1 where the machine runs at its set speed, 0 in ramps and at rest.
  const auto direction = [&](Index i) {
    if (!(std::abs(std::abs(v(i)) - options.speed_rad_per_s) <=
          options.relative_tolerance * options.speed_rad_per_s))
      return 0;
    return v(i) > 0.0 ? 1 : -1;
  };
  std::vector<Phase> phases;
  for (Index first = 0; first < v.size();) {
    const int way = direction(first);
    Index last = first + 1;
    while (last < v.size() && direction(last) == way) ++last;
    if (way != 0 && last - first >= shortest) phases.push_back(phase_over(v, first, last));
    first = last;
  }
  return phases;
}

std::vector<Phase> isometric_holds(const DynamometerRecord& record, const HoldOptions& options) {
  require_positive(options.max_speed_rad_per_s, "hold's highest speed");
  require_positive(options.relative_tolerance, "hold's torque tolerance");
  const Eigen::VectorXd& t = record.torque_N_m;
  const Index shortest = samples_of(options.min_duration_s, record.rate_hz);
  std::vector<Phase> holds;
  for (Index first = 0; first + shortest <= t.size();) {
    double lowest = t(first), highest = t(first);
    Index last = first;
    for (; last < t.size(); ++last) {
      const double low = std::min(lowest, t(last)), high = std::max(highest, t(last)),
                   middle = 0.5 * (low + high);
      if (!(std::abs(record.velocity_rad_per_s(last)) <= options.max_speed_rad_per_s)) break;
      if (!(std::abs(middle) >= options.min_torque_N_m)) break;
      if (!(0.5 * (high - low) <= options.relative_tolerance * std::abs(middle))) break;
      lowest = low;
      highest = high;
    }
    if (last - first < shortest) {
      ++first;
      continue;
    }
    holds.push_back(phase_over(t, first, last));
    first = last;
  }
  return holds;
}

Eigen::VectorXd phase_mask(const std::vector<Phase>& phases, Index count) {
  Eigen::VectorXd mask = Eigen::VectorXd::Zero(count);
  for (const Phase& p : phases) {
    if (p.first < 0 || p.last > count || p.first > p.last) {
      throw data::InputError("wrong-size",
                             fmt::format("a phase from sample {} to {} of {}", p.first, p.last, count));
    }
    mask.segment(p.first, p.last - p.first).setOnes();
  }
  return mask;
}

}  // namespace brachium::limb
