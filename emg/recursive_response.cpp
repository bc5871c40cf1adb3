#include "emg/activation_response.hpp"

namespace brachium::emg {
namespace {

// The filter 1/(1 + b2 z^-1 + b3 z^-2) with its two past values.
struct Recursion {
  double b2, b3;
  double y1 = 0.0, y2 = 0.0;  // values one and two samples ago

  double operator()(double input) {
    const double y = input - b2 * y1 - b3 * y2;
    y2 = y1;
    y1 = y;
    return y;
  }
};

}  // namespace

void recursive_response(StartUp start_up, const RecursionParameters& p, std::span<const double> e,
                        std::span<double> u, const ResponseTangents& tangents) {
  const std::size_t n = e.size();
  if (n == 0) return;
  const auto [whole, fraction] = split_delay(p.delay_s, p.rate_hz);
  const double before = start_up == StartUp::rest ? 0.0 : e[0];
  const auto sample = [&](std::size_t k, std::size_t back) { return k < back ? before : e[k - back]; };

  const double b2 = p.g1 + p.g2, b3 = p.g1 * p.g2, b1 = 1.0 + b2 + b3;
  const double past = start_up == StartUp::steady_state ? e[0] : 0.0;
  Recursion neural{b2, b3, past, past};
  Recursion by_delay{b2, b3}, by_g1{b2, b3}, by_g2{b2, b3};

  double v1 = 0.0, v2 = 0.0, dv1 = 0.0,
         dv2 = 0.0;  // delayed excitation and its slope, one and two samples ago
  for (std::size_t k = 0; k < n; ++k) {
    // v = e(t_k - d), linear between samples;  ∂v/∂d = -e'(t_k - d), the slope of the piece towards a longer delay
    const double newer = sample(k, whole), older = sample(k, whole + 1);
    const double v = newer + fraction * (older - newer);
    const double dv = (older - newer) * p.rate_hz;
    if (start_up == StartUp::ceinms && k == 2) {
      neural.y1 = neural.y2 = 0.5 * (v1 + v2);
      by_delay.y1 = by_delay.y2 = 0.5 * (dv1 + dv2);
      by_g1.y1 = by_g1.y2 = by_g2.y1 = by_g2.y2 = 0.0;
    }
    // u_k = b1 v - b2 u1 - b3 u2;  ∂/∂g1: (1 + g2) v - u1 - g2 u2 drives the same recursion, and so for g2
    const double u1 = neural.y1, u2 = neural.y2;
    u[k] = neural(b1 * v);
    if (!tangents.delay.empty()) tangents.delay[k] = by_delay(b1 * dv);
    if (!tangents.dynamics_1.empty()) tangents.dynamics_1[k] = by_g1((1.0 + p.g2) * v - u1 - p.g2 * u2);
    if (!tangents.dynamics_2.empty()) tangents.dynamics_2[k] = by_g2((1.0 + p.g1) * v - u1 - p.g1 * u2);
    v2 = v1, v1 = v;
    dv2 = dv1, dv1 = dv;
  }
}

}  // namespace brachium::emg
