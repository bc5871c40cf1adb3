#include "optimise/twin_programme.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numbers>

#include "data/model/error.hpp"
#include "emg/random.hpp"

namespace brachium::optimise {
namespace {

using std::numbers::pi;

constexpr std::array<const char*, 7> programme_name = {
    "mvc", "isometric_ramp", "isometric_hold", "curl", "isokinetic", "passive_sweep", "random"};

/// Value and rate of an angle course.
struct Motion {
  double angle = 0.0;
  double rate = 0.0;
};

/// 0 -> 1 between t0 and t0 + ramp, twice differentiable.
double rise(double t, double t0, double ramp) {
  const double s = std::clamp((t - t0) / ramp, 0.0, 1.0);
  return s * s * s * (10.0 + s * (6.0 * s - 15.0));
}

double burst(double t, double from, double to, double ramp) {
  return rise(t, from, ramp) - rise(t, to - ramp, ramp);
}

/// Sum of six sines, mean 0, |value| <= 1, with its rate.
struct Sines {
  std::array<double, 6> frequency_hz, phase, amplitude;

  Sines(double lowest_hz, double highest_hz, std::uint64_t seed, std::uint64_t stream) {
    emg::Random random(seed, stream);
    double total = 0.0;
    for (std::size_t k = 0; k < frequency_hz.size(); ++k) {
      frequency_hz[k] =
          lowest_hz + (highest_hz - lowest_hz) * (static_cast<double>(k) + random.uniform()) / 6.0;
      phase[k] = 2.0 * pi * random.uniform();
      amplitude[k] = 0.5 + random.uniform();
      total += amplitude[k];
    }
    for (double& a : amplitude) a /= total;
  }

  Motion operator()(double t) const {
    Motion out;
    for (std::size_t k = 0; k < frequency_hz.size(); ++k) {
      const double w = 2.0 * pi * frequency_hz[k];
      out.angle += amplitude[k] * std::sin(w * t + phase[k]);
      out.rate += amplitude[k] * w * std::cos(w * t + phase[k]);
    }
    return out;
  }
};

/// Constant velocity with raised-cosine turns that take a fifth of each half cycle.
Motion isokinetic(double t, const TwinTrial& trial) {
  const double half = 0.5 * trial.cycle_s, turn = 0.2 * half;
  const double phase = std::fmod(t, trial.cycle_s);
  const double sign = phase < half ? 1.0 : -1.0;
  const double s = phase < half ? phase : phase - half;
  const double top = (trial.upper_rad - trial.lower_rad) / (half - turn);
  // Velocity: 0 -> top over `turn`, constant, top -> 0 over `turn`; distance covered up to s.
  const auto ramp_distance = [&](double x) {
    return top * (0.5 * x - turn / (2.0 * pi) * std::sin(pi * x / turn));
  };
  double velocity = top, distance = 0.0;
  if (s < turn) {
    velocity = 0.5 * top * (1.0 - std::cos(pi * s / turn));
    distance = ramp_distance(s);
  } else if (s <= half - turn) {
    distance = 0.5 * top * turn + top * (s - turn);
  } else {
    velocity = 0.5 * top * (1.0 - std::cos(pi * (half - s) / turn));
    distance = trial.upper_rad - trial.lower_rad - ramp_distance(half - s);
  }
  return sign > 0.0 ? Motion{trial.lower_rad + distance, velocity}
                    : Motion{trial.upper_rad - distance, -velocity};
}

}  // namespace

std::string to_string(Programme programme) {
  return programme_name[static_cast<std::size_t>(programme)];
}

Programme parse_programme(const std::string& name) {
  for (std::size_t i = 0; i < programme_name.size(); ++i)
    if (name == programme_name[i]) return static_cast<Programme>(i);
  throw data::InputError(
      "unknown-programme", fmt::format("`{}` is not a programme of the twin", name),
      data::suggest(name, std::vector<std::string>(programme_name.begin(), programme_name.end())));
}

std::vector<double> smooth_course(std::size_t count, double rate_hz, double lowest_hz, double highest_hz,
                                  std::uint64_t seed, std::uint64_t stream) {
  const Sines sines(lowest_hz, highest_hz, seed, stream);
  std::vector<double> out(count);
  // Six sines rarely add up: twice their sum, smoothly limited, uses the whole of [0, 1].
  for (std::size_t i = 0; i < count; ++i)
    out[i] = 0.5 * (1.0 + std::tanh(2.5 * sines(static_cast<double>(i) / rate_hz).angle));
  return out;
}

ProgrammeTraces run_programme(const TwinTrial& trial, const TwinOptions& options, std::size_t index) {
  const double T = trial.duration_s, mid = 0.5 * (trial.lower_rad + trial.upper_rad),
               half = 0.5 * (trial.upper_rad - trial.lower_rad), cycle = trial.cycle_s;
  const std::uint64_t stream = (static_cast<std::uint64_t>(index) + 1) << 16;
  const Sines angle(0.08, 0.6, options.seed, stream + 1);
  std::function<Motion(double)> motion = [&](double) { return Motion{trial.lower_rad, 0.0}; };
  std::function<double(double)> flexion = [](double) { return 0.0; }, extension = flexion;
  const auto sweep = [&](double t) {
    return Motion{mid - half * std::cos(2.0 * pi * t / cycle),
                  half * 2.0 * pi / cycle * std::sin(2.0 * pi * t / cycle)};
  };
  switch (trial.programme) {
    case Programme::mvc: {  // six equal slots: three of flexors, three of extensors; contraction in 60 % of
                            // each
      const double slot = T / 6.0;
      flexion = [=](double t) {
        return t < 0.5 * T ? burst(std::fmod(t, slot), 0.2 * slot, 0.8 * slot, 0.1 * slot) : 0.0;
      };
      extension = [=](double t) {
        return t >= 0.5 * T ? burst(std::fmod(t, slot), 0.2 * slot, 0.8 * slot, 0.1 * slot) : 0.0;
      };
      break;
    }
    case Programme::isometric_ramp:
      flexion = [&trial, T](double t) { return trial.effort * burst(t, 0.05 * T, 0.55 * T, 0.22 * T); };
      extension = [&trial, T](double t) { return trial.effort * burst(t, 0.5 * T, 0.95 * T, 0.2 * T); };
      break;
    case Programme::isometric_hold: {
      const double slot = T / 6.0;
      const auto level = [&trial, slot](double t) {
        return trial.effort * std::min(3.0, 1.0 + std::floor(t / slot)) / 3.0;
      };
      flexion = [=](double t) {
        return t < 0.5 * T ? level(t) * burst(std::fmod(t, slot), 0.1 * slot, 0.9 * slot, 0.15 * slot) : 0.0;
      };
      extension = [=](double t) {
        return t >= 0.5 * T
                   ? level(t - 0.5 * T) * burst(std::fmod(t, slot), 0.1 * slot, 0.9 * slot, 0.15 * slot)
                   : 0.0;
      };
      break;
    }
    case Programme::curl:
      motion = sweep;
      flexion = [&, sweep](double t) {
        const Motion m = sweep(t);
        return trial.effort * (0.25 + 0.6 * std::sin(m.angle) * (1.0 + 0.2 * std::tanh(m.rate))) / 0.97;
      };
      extension = [&, sweep](double t) {
        return 0.15 * trial.effort * (1.0 - std::sin(sweep(t).angle) * 0.8);
      };
      break;
    case Programme::isokinetic:
      motion = [&trial](double t) { return isokinetic(t, trial); };
      flexion = [&, cycle](double t) {
        return trial.effort * burst(std::fmod(t, cycle), 0.0, 0.5 * cycle, 0.08 * cycle);
      };
      extension = [&, cycle](double t) {
        return trial.effort * burst(std::fmod(t, cycle), 0.5 * cycle, cycle, 0.08 * cycle);
      };
      break;
    case Programme::passive_sweep:
      motion = sweep;
      break;
    case Programme::random:
      motion = [&](double t) {
        const Motion m = angle(t);
        const double s = std::tanh(2.0 * m.angle);
        return Motion{mid + half * s, half * 2.0 * (1.0 - s * s) * m.rate};
      };
      break;
  }
  ProgrammeTraces out;
  const auto frames = static_cast<std::size_t>(std::floor(T * options.motion_rate_hz + 1e-9)) + 1;
  for (std::size_t i = 0; i < frames; ++i) {
    const Motion m = motion(static_cast<double>(i) / options.motion_rate_hz);
    out.angle_rad.push_back(m.angle);
    out.velocity_rad_s.push_back(m.rate);
  }
  const auto samples = static_cast<std::size_t>(std::floor(T * options.excitation_rate_hz + 1e-9)) + 1;
  if (trial.programme == Programme::random) {
    out.flexion = smooth_course(samples, options.excitation_rate_hz, 0.1, 1.2, options.seed, stream + 2);
    out.extension = smooth_course(samples, options.excitation_rate_hz, 0.1, 1.2, options.seed, stream + 3);
    for (double& e : out.flexion) e *= trial.effort;
    for (double& e : out.extension) e *= trial.effort;
    return out;
  }
  for (std::size_t i = 0; i < samples; ++i) {
    const double t = static_cast<double>(i) / options.excitation_rate_hz;
    out.flexion.push_back(flexion(t));
    out.extension.push_back(extension(t));
  }
  return out;
}

}  // namespace brachium::optimise
