#include "pipelines/stages/moment_frames.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "data/model/error.hpp"

namespace brachium::pipelines {

CommonFrames CommonFrames::piece(std::size_t from, std::size_t count) const {
  return {{time.rate_hz, time.time_s(from), count}, first + from};
}

CommonFrames common_frames(const data::SignalInfo& activation, const data::Signal& angle,
                           const std::optional<data::Signal>& other, const std::string& trial) {
  const data::SignalInfo& a = activation;
  double from = std::max(a.start_time_s, angle.info.start_time_s),
         to = std::min(a.end_time_s(), angle.info.end_time_s());
  if (other) {
    from = std::max(from, other->info.start_time_s);
    to = std::min(to, other->info.end_time_s());
  }
  const double slack = 1e-6;  // of a sample: time stamps are decimal numbers
  const double first = std::ceil((from - a.start_time_s) * a.rate_hz - slack),
               last = std::floor((to - a.start_time_s) * a.rate_hz + slack);
  if (!(last - first >= 8)) {
    throw data::InputError(
        "no-common-window",
        fmt::format(
            "activation ({:.3f}-{:.3f} s) and joint angle ({:.3f}-{:.3f} s) of trial `{}` do not overlap",
            a.start_time_s, a.end_time_s(), angle.info.start_time_s, angle.info.end_time_s(), trial),
        "check the start times in the session description");
  }
  return {{a.rate_hz, a.start_time_s + first / a.rate_hz, static_cast<std::size_t>(last - first) + 1},
          static_cast<std::size_t>(first)};
}

MomentFrames kinematics_at(const CommonFrames& common, const data::Signal& angle,
                           const std::optional<data::Signal>& velocity) {
  MomentFrames frames{common, {}, {}};
  std::vector<double> times(frames.time.count);
  for (std::size_t i = 0; i < times.size(); ++i) times[i] = frames.time.time_s(i);
  frames.angle_rad = data::evaluate_at(angle, times);
  if (velocity) frames.velocity_rad_s = data::evaluate_at(*velocity, times);
  return frames;
}

void check_angles(const MomentFrames& frames, const data::Coordinate& coordinate, const std::string& trial) {
  const double deg = 180.0 / std::numbers::pi;
  for (std::size_t i = 0; i < frames.angle_rad.size(); ++i) {
    const double q = frames.angle_rad[i];
    if (q >= coordinate.lower_rad && q <= coordinate.upper_rad) continue;
    throw data::InputError(
        "angle-out-of-range",
        fmt::format("`{}` of trial `{}` is {:.1f} deg at {:.6g} s; the scene's geometry holds from {:.1f} to "
                    "{:.1f} deg",
                    coordinate.name, trial, q * deg, frames.time.time_s(i), coordinate.lower_rad * deg,
                    coordinate.upper_rad * deg),
        "widen `range_deg` with geometry that is valid there, check the angle's zero, or leave the trial "
        "out");
  }
}

data::SignalInfo signal_on(const data::TimeGrid& grid, const std::string& name, data::Quantity quantity,
                           const std::string& unit) {
  data::SignalInfo info;
  info.name = name;
  info.quantity = quantity;
  info.unit = unit;
  info.rate_hz = grid.rate_hz;
  info.start_time_s = grid.start_s;
  info.count = grid.count;
  return info;
}

std::vector<double> activation_at(const CommonFrames& frames, const data::SessionSource& source,
                                  std::size_t trial, std::size_t signal, bool clamp, std::size_t& brought) {
  std::vector<double> a(frames.time.count);
  source.read(trial, signal, frames.first, a);
  for (double& value : a) {
    if (value >= 0.0 && value <= 1.0) continue;
    if (!clamp && value > 1.0) {
      throw data::InputError("activation-range",
                             fmt::format("activation of `{}` in trial `{}` is {:.4f}, above 1",
                                         source.info().trials[trial].signals[signal].name,
                                         source.info().trials[trial].name, value),
                             "the maximum contraction was not maximal; choose `outside_activation = "
                             "\"clamp\"` to count and clamp such samples");
    }
    value = std::clamp(value, 0.0, 1.0);
    ++brought;
  }
  return a;
}

}  // namespace brachium::pipelines
