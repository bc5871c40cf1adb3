#pragma once
// Smooth stand-ins for a muscle, with exact derivatives, and samples of them.

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>
#include <random>

#include "fem/surrogate/leave_out.hpp"
#include "fem/surrogate/samples.hpp"
#include "fem/surrogate/surrogate.hpp"

namespace brachium::fem::test {

constexpr double deg = std::numbers::pi / 180.0;

inline StateBounds elbow() {
  return {10.0 * deg, 150.0 * deg, 0.0, 1.0};
}

/// F, dF/dtheta, dF/dalpha of one output.
using Truth = std::function<OutputValue(double theta, double alpha)>;

/// A muscle like the published triceps: a passive part that rises and falls, an active part nearly linear in
/// alpha.
inline OutputValue muscle(double t, double a) {
  const double passive = 260.0 + 240.0 * std::tanh(1.6 * (t - 1.1)),
               dp = 240.0 * 1.6 / std::pow(std::cosh(1.6 * (t - 1.1)), 2);
  const double bell = 600.0 * std::exp(-std::pow((t - 1.9) / 1.4, 2)),
               db = -2.0 * (t - 1.9) / (1.4 * 1.4) * bell;
  const double g = a + 0.05 * std::sin(3.0 * a + t), ga = 1.0 + 0.15 * std::cos(3.0 * a + t),
               gt = 0.05 * std::cos(3.0 * a + t);
  return {passive + bell * g, dp + db * g + bell * gt, bell * ga};
}

/// sum c_ij t^i a^j with fixed random coefficients, degrees in each variable.
class Polynomial {
 public:
  Polynomial(int p, int q) : c_(p + 1, q + 1) {
    std::mt19937 random(7);
    std::uniform_real_distribution<double> u(-1.0, 1.0);
    for (int i = 0; i <= p; ++i) {
      for (int j = 0; j <= q; ++j) c_(i, j) = u(random);
    }
  }
  OutputValue operator()(double t, double a) const {
    OutputValue v;
    for (Eigen::Index i = 0; i < c_.rows(); ++i) {
      for (Eigen::Index j = 0; j < c_.cols(); ++j) {
        const auto power = [](double x, Eigen::Index n) {
          return n < 0 ? 0.0 : std::pow(x, static_cast<double>(n));
        };
        v.value += c_(i, j) * power(t, i) * power(a, j);
        v.dtheta += c_(i, j) * static_cast<double>(i) * power(t, i - 1) * power(a, j);
        v.dalpha += c_(i, j) * static_cast<double>(j) * power(t, i) * power(a, j - 1);
      }
    }
    return v;
  }

 private:
  Eigen::MatrixXd c_;
};

inline SampleSet sample(const std::vector<StatePoint>& states, const std::vector<Truth>& truths,
                        bool derivatives = true) {
  SampleSet set;
  for (std::size_t o = 0; o < truths.size(); ++o) set.outputs.push_back("output_" + std::to_string(o));
  const auto n = static_cast<Eigen::Index>(truths.size());
  for (const StatePoint& s : states) {
    Sample x{s, Eigen::VectorXd(n), Eigen::VectorXd(n), Eigen::VectorXd(n)};
    for (Eigen::Index o = 0; o < n; ++o) {
      const OutputValue v = truths[static_cast<std::size_t>(o)](s.theta_rad, s.activation);
      x.value(o) = v.value, x.dtheta(o) = v.dtheta, x.dalpha(o) = v.dalpha;
    }
    if (!derivatives) x.dtheta.resize(0), x.dalpha.resize(0);
    set.samples.push_back(std::move(x));
  }
  return set;
}

inline SampleGrid sample_grid(const std::vector<double>& theta, const std::vector<double>& alpha,
                              const std::vector<Truth>& truths) {
  return as_grid(sample(grid_states(theta, alpha), truths));
}

/// Greatest differences to the truth over a dense grid of states inside the bounds.
struct Differences {
  double value = 0.0, dtheta = 0.0, dalpha = 0.0;
};
inline Differences differences(const Surrogate& s, const Truth& truth, std::size_t output = 0,
                               std::size_t n = 41) {
  Differences d;
  std::vector<OutputValue> out(s.outputs().size());
  const StateBounds& b = s.bounds();
  for (const StatePoint& p : grid_states(equidistant(b.theta_lower_rad, b.theta_upper_rad, n),
                                         equidistant(b.activation_lower, b.activation_upper, n))) {
    s.evaluate(p.theta_rad, p.activation, out);
    const OutputValue t = truth(p.theta_rad, p.activation), v = out[output];
    d.value = std::max(d.value, std::abs(v.value - t.value));
    d.dtheta = std::max(d.dtheta, std::abs(v.dtheta - t.dtheta));
    d.dalpha = std::max(d.dalpha, std::abs(v.dalpha - t.dalpha));
  }
  return d;
}

/// Greatest difference between the surrogate's derivatives and central differences of its values, away from
/// mesh lines by chance; `wrong` scales the derivatives first, for the twin that must fail.
inline double derivative_mismatch(const Surrogate& s, double wrong = 1.0) {
  std::mt19937 random(11);
  const StateBounds& b = s.bounds();
  std::uniform_real_distribution<double> u(0.01, 0.99);
  std::vector<OutputValue> at(s.outputs().size()), low(at), high(at);
  double most = 0.0;
  for (int i = 0; i < 300; ++i) {
    const double t = b.theta_lower_rad + u(random) * b.theta_span(),
                 a = b.activation_lower + u(random) * b.activation_span(), h = 1e-5;
    s.evaluate(t, a, at);
    s.evaluate(t - h, a, low), s.evaluate(t + h, a, high);
    for (std::size_t o = 0; o < at.size(); ++o) {
      most = std::max(most, std::abs(wrong * at[o].dtheta - (high[o].value - low[o].value) / (2.0 * h)) /
                                (1.0 + std::abs(at[o].dtheta)));
    }
    s.evaluate(t, a - h, low), s.evaluate(t, a + h, high);
    for (std::size_t o = 0; o < at.size(); ++o) {
      most = std::max(most, std::abs(wrong * at[o].dalpha - (high[o].value - low[o].value) / (2.0 * h)) /
                                (1.0 + std::abs(at[o].dalpha)));
    }
  }
  return most;
}

}  // namespace brachium::fem::test
