#include <algorithm>
#include <array>

#include "emg/activation_response.hpp"
#include "emg/second_order.hpp"

namespace brachium::emg {
namespace {

// The undelayed solution runs on the grid of the samples, t_j = j dt. The answer at t_k looks back to t_k - d, which lies
// (1 - fraction) dt after t_j, j = k - whole - 1: an exact step of that length from the state at t_j gives it. So the
// delay is exact for the piecewise linear e, and ∂u/∂d = -u'(t_k - d) = -(x1 - x2)/τ2 is exact and continuous.
template <bool with_time_constants>
void run(StartUp start_up, const data::ActivationParameters& p, std::span<const double> e, double rate_hz,
         std::span<double> u, const ResponseTangents& tangents) {
  const std::size_t n = e.size();
  const auto [whole, fraction] = split_delay(p.delay_s, rate_hz);
  const double dt = 1.0 / rate_hz;
  const SecondOrderStep step = second_order_step(p.time_constant_1_s, p.time_constant_2_s, dt);
  const SecondOrderStep look =
      second_order_step(p.time_constant_1_s, p.time_constant_2_s, (1.0 - fraction) * dt);
  const auto& S = step.transition;
  const auto& L = look.transition;
  const double inverse_tau1 = 1.0 / p.time_constant_1_s;
  const double inverse_tau2 = 1.0 / p.time_constant_2_s;

  const double before = start_up == StartUp::rest || n == 0 ? 0.0 : e[0];
  const std::size_t first = std::min(n, whole + 1);  // until then t_k - d <= 0
  std::fill(u.begin(), u.begin() + static_cast<std::ptrdiff_t>(first), before);
  for (const std::span<double>& tangent : {tangents.delay, tangents.dynamics_1, tangents.dynamics_2}) {
    if (!tangent.empty())
      std::fill(tangent.begin(), tangent.begin() + static_cast<std::ptrdiff_t>(first), 0.0);
  }

  double x1 = before, x2 = before, w1 = before, w2 = before;
  for (std::size_t k = first; k < n; ++k) {
    const std::size_t j = k - first;
    const double e0 = e[j];
    const double de = e[j + 1] - e0;
    const double de_look = (1.0 - fraction) * de;

    const double y2 = L[1][0] * x1 + L[1][1] * x2 + (look.from_start[1] * e0 + look.from_change[1] * de_look);
    u[k] = y2;
    if (!tangents.delay.empty()) {
      const double y1 = L[0][0] * x1 + (look.from_start[0] * e0 + look.from_change[0] * de_look);
      tangents.delay[k] = -(y1 - y2) * inverse_tau2;
    }
    if constexpr (with_time_constants) {
      const double v1 = L[2][0] * x1 + L[2][1] * x2 + L[2][2] * w1 +
                        (look.from_start[2] * e0 + look.from_change[2] * de_look);
      const double v2 = L[3][0] * x1 + L[3][1] * x2 + L[3][3] * w2 +
                        (look.from_start[3] * e0 + look.from_change[3] * de_look);
      if (!tangents.dynamics_1.empty()) tangents.dynamics_1[k] = -(y2 - v1) * inverse_tau1;
      if (!tangents.dynamics_2.empty()) tangents.dynamics_2[k] = -(y2 - v2) * inverse_tau2;
      const double next_w1 =
          S[2][0] * x1 + S[2][1] * x2 + S[2][2] * w1 + (step.from_start[2] * e0 + step.from_change[2] * de);
      const double next_w2 =
          S[3][0] * x1 + S[3][1] * x2 + S[3][3] * w2 + (step.from_start[3] * e0 + step.from_change[3] * de);
      w1 = next_w1;
      w2 = next_w2;
    }
    const double next_x2 = S[1][0] * x1 + S[1][1] * x2 + (step.from_start[1] * e0 + step.from_change[1] * de);
    x1 = S[0][0] * x1 + (step.from_start[0] * e0 + step.from_change[0] * de);
    x2 = next_x2;
  }
}

}  // namespace

void continuous_response(StartUp start_up, const data::ActivationParameters& parameters,
                         std::span<const double> e, double rate_hz, std::span<double> u,
                         const ResponseTangents& tangents) {
  if (tangents.dynamics_1.empty() && tangents.dynamics_2.empty()) {
    run<false>(start_up, parameters, e, rate_hz, u, tangents);
  } else {
    run<true>(start_up, parameters, e, rate_hz, u, tangents);
  }
}

}  // namespace brachium::emg
