#include <algorithm>
#include <cmath>
#include <numbers>

#include "emg/normalisation.hpp"

namespace brachium::emg {
namespace {

// Zeroth and second moment of |G|^2 sinc^2(f T) over f >= 0, G = 1/(1 + (f/f0)^4) the zero-lag Butterworth envelope
// filter of effective order 4, f0 = f_c/C its edge of one pass.
struct Moments {
  double zeroth = 0.0, second = 0.0;
};

Moments moments(double window_s, double lowpass_hz) {
  const double f0 = lowpass_hz / std::pow(std::numbers::sqrt2 - 1.0, 0.25);
  constexpr int intervals = 20000;
  const double top = 20.0 * f0, h = top / intervals;
  Moments m;
  for (int i = 0; i <= intervals; ++i) {  // Simpson
    const double f = i * h;
    const double x4 = std::pow(f / f0, 4);
    const double phase = std::numbers::pi * f * window_s;
    const double sinc = phase == 0.0 ? 1.0 : std::sin(phase) / phase;
    const double power = sinc * sinc / ((1.0 + x4) * (1.0 + x4));
    const double weight = (i == 0 || i == intervals ? 1.0 : i % 2 == 1 ? 4.0 : 2.0) * h / 3.0;
    m.zeroth += weight * power;
    m.second += weight * f * f * power;
  }
  return m;
}

}  // namespace

double envelope_variation(double window_s, double lowpass_hz, double bandwidth_hz) {
  return std::sqrt(1.05 * moments(window_s, lowpass_hz).zeroth / (2.0 * bandwidth_hz));
}

double expected_bias(double window_s, double lowpass_hz, double plateau_s, std::size_t trials,
                     double bandwidth_hz) {
  const Moments m = moments(window_s, lowpass_hz);
  const double searched = static_cast<double>(trials) * std::max(0.0, plateau_s - window_s);
  const double crossings = std::sqrt(m.second / m.zeroth) * searched;
  // Davenport's asymptote holds for many crossings; below two it is brought linearly to 0.
  const double n = std::max(2.0, crossings);
  const double c = std::sqrt(2.0 * std::log(n));
  const double factor = (c + std::numbers::egamma / c) * std::min(1.0, crossings / 2.0);
  return std::sqrt(1.05 * m.zeroth / (2.0 * bandwidth_hz)) * factor;
}

}  // namespace brachium::emg
