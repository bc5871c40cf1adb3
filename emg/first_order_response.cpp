#include <algorithm>
#include <cmath>

#include "emg/activation_response.hpp"

namespace brachium::emg {
namespace {

// A value and its derivatives with respect to gain, τ1 and τ2. (The delay's derivative is the time derivative.)
struct Dual {
  double a = 0.0, gain = 0.0, tau1 = 0.0, tau2 = 0.0;

  Dual plus(double h, const Dual& rate) const {
    return {a + h * rate.a, gain + h * rate.gain, tau1 + h * rate.tau1, tau2 + h * rate.tau2};
  }
};

struct Dynamics {
  double tau1, tau2, gain;

  // f = (γ e - a)/τ: while rising τ = τ1 s, while falling τ = τ2/s, s = 0.5 + 1.5 a. f is continuous at γ e = a.
  Dual rate(const Dual& x, double e) const {
    const double s = 0.5 + 1.5 * x.a;
    const double gap = gain * e - x.a;
    if (gap > 0.0) {
      const double k = 1.0 / (tau1 * s);
      const double f = gap * k;
      const double f_a = -k - 1.5 * f / s;
      return {f, f_a * x.gain + k * e, f_a * x.tau1 - f / tau1, f_a * x.tau2};
    }
    const double k = s / tau2;
    const double f = gap * k;
    const double f_a = -k + 1.5 * gap / tau2;
    return {f, f_a * x.gain + k * e, f_a * x.tau1, f_a * x.tau2 - f / tau2};
  }

  // Classical Runge-Kutta steps over an interval in which e goes from e0 to e1 in a straight line.
  Dual advance(Dual x, double interval, int steps, double e0, double e1) const {
    const double h = interval / steps;
    for (int i = 0; i < steps; ++i) {
      const double a = e0 + (e1 - e0) * i / steps;
      const double b = e0 + (e1 - e0) * (i + 1) / steps;
      const double middle = 0.5 * (a + b);
      const Dual k1 = rate(x, a);
      const Dual k2 = rate(x.plus(0.5 * h, k1), middle);
      const Dual k3 = rate(x.plus(0.5 * h, k2), middle);
      const Dual k4 = rate(x.plus(h, k3), b);
      x = x.plus(h / 6, k1).plus(h / 3, k2).plus(h / 3, k3).plus(h / 6, k4);
    }
    return x;
  }
};

}  // namespace

void first_order_response(StartUp start_up, const data::ActivationParameters& p, std::span<const double> e,
                          double rate_hz, double gain, std::span<double> u, std::span<double> du_dgain,
                          const ResponseTangents& tangents) {
  const std::size_t n = e.size();
  if (n == 0) return;
  const auto [whole, fraction] = split_delay(p.delay_s, rate_hz);
  const double dt = 1.0 / rate_hz;
  const double look = (1.0 - fraction) * dt;
  // The fastest time constant is τ1/2 (rising from 0) or τ2/2 (falling from 1); 32 steps to it leave an error
  // below 1e-6 of a, most of it from the step in which rising turns into falling.
  const double fastest = 0.5 * std::min(p.time_constant_1_s, p.time_constant_2_s);
  const int steps = static_cast<int>(std::ceil(32.0 * dt / fastest));
  const Dynamics dynamics{p.time_constant_1_s, p.time_constant_2_s, gain};

  const double before = start_up == StartUp::rest ? 0.0 : e[0];
  Dual x{gain * before, before, 0.0, 0.0};
  const auto put = [&](std::size_t k, const Dual& y, double y_rate) {
    u[k] = y.a;
    if (!du_dgain.empty()) du_dgain[k] = y.gain;
    if (!tangents.delay.empty()) tangents.delay[k] = -y_rate;
    if (!tangents.dynamics_1.empty()) tangents.dynamics_1[k] = y.tau1;
    if (!tangents.dynamics_2.empty()) tangents.dynamics_2[k] = y.tau2;
  };
  const std::size_t first = std::min(n, whole + 1);
  for (std::size_t k = 0; k < first; ++k) put(k, x, 0.0);
  for (std::size_t k = first; k < n; ++k) {
    const std::size_t j = k - first;
    const double e_look = e[j] + (1.0 - fraction) * (e[j + 1] - e[j]);
    const Dual y = dynamics.advance(x, look, steps, e[j], e_look);
    put(k, y, dynamics.rate(y, e_look).a);
    x = fraction == 0.0 ? y : dynamics.advance(x, dt, steps, e[j], e[j + 1]);
  }
}

}  // namespace brachium::emg
