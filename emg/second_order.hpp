#pragma once
/// Exact solution of τ1 τ2 u'' + (τ1 + τ2) u' + u = e(t) over an interval in which e is a straight line, and of its
/// derivatives with respect to τ1 and τ2.
///
/// | symbol     | identifier | unit | meaning                                     |
/// |------------|------------|------|---------------------------------------------|
/// | p1, p2     | -          | 1/s  | 1/τ1, 1/τ2                                  |
/// | x1, x2     | x[0], x[1] | 1    | τ1 x1' = e - x1, τ2 x2' = x1 - x2, u = x2   |
/// | w1, w2     | x[2], x[3] | 1    | τ1 w1' = u - w1, τ2 w2' = u - w2            |
/// | h          | interval_s | s    | length of the interval                      |
///
/// In the Laplace domain U = E/((1 + τ1 s)(1 + τ2 s)), so ∂U/∂τi = -s U/(1 + τi s) = -(U - Wi)/τi with
/// Wi = U/(1 + τi s): the derivatives are two more first-order lags, exact also where τ1 = τ2.
/// The lags form a triangular matrix whose exponential is computed after a shift that makes every entry >= 0
/// (scaling and squaring then only adds and multiplies positive numbers): no cancellation, whether τ1 and τ2 are far
/// apart, close or equal.

#include <array>

namespace brachium::emg {

/// State at the end of the interval = transition x + from_start e(0) + from_change (e(h) - e(0)).
struct SecondOrderStep {
  std::array<std::array<double, 4>, 4> transition{};  ///< lower triangular
  std::array<double, 4> from_start{};
  std::array<double, 4> from_change{};

  std::array<double, 4> operator()(const std::array<double, 4>& x, double e_start, double e_change) const;
};

/// time constants > 0, interval >= 0 [s].
SecondOrderStep second_order_step(double time_constant_1_s, double time_constant_2_s, double interval_s);

}  // namespace brachium::emg
