#include "data/limb/smoothing.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "data/model/error.hpp"

namespace brachium::limb {
namespace {

struct Biquad {
  double b0, b1, b2, a1, a2;
};

// Bilinear second-order Butterworth low-pass with tan(pi f / f_s) = w.
Biquad butterworth(double w) {
  const double scale = 1.0 / (1.0 + std::numbers::sqrt2 * w + w * w);
  return {w * w * scale, 2.0 * w * w * scale, w * w * scale, 2.0 * (w * w - 1.0) * scale,
          (1.0 - std::numbers::sqrt2 * w + w * w) * scale};
}

// One pass in the transposed direct form II, started in the steady state of a constant first sample.
void pass(const Biquad& f, std::vector<double>& x) {
  double z2 = (f.b2 - f.a2) * x.front();
  double z1 = (f.b1 - f.a1) * x.front() + z2;
  for (double& v : x) {
    const double y = f.b0 * v + z1;
    z1 = f.b1 * v - f.a1 * y + z2;
    z2 = f.b2 * v - f.a2 * y;
    v = y;
  }
}

}  // namespace

std::size_t Smoothing::edge_samples() const {
  return static_cast<std::size_t>(std::ceil(rate_hz / cutoff_hz));
}

std::vector<double> smooth(std::span<const double> samples, const Smoothing& s, const std::string& what) {
  if (!(s.rate_hz > 0.0) || !(s.cutoff_hz > 0.0) || !(s.cutoff_hz < 0.45 * s.rate_hz)) {
    throw data::InputError("cutoff-above-nyquist",
                           fmt::format("the cut-off {:.6g} Hz for {} must lie above 0 and below 0.45 of its "
                                       "rate {:.6g} Hz",
                                       s.cutoff_hz, what, s.rate_hz));
  }
  const std::size_t n = samples.size(), pad = 2 * s.edge_samples();
  if (n <= pad) {
    throw data::InputError("trial-too-short",
                           fmt::format("{} has {} samples; smoothing at {:.6g} Hz needs more than {}", what,
                                       n, s.cutoff_hz, pad),
                           "use a longer trial or a higher cut-off");
  }
  for (std::size_t i = 0; i < n; ++i) {
    if (!std::isfinite(samples[i])) {
      throw data::InputError("not-finite",
                             fmt::format("{} is not a finite number at sample {} ({:.6g} s)", what, i,
                                         static_cast<double>(i) / s.rate_hz),
                             "fill or cut the gap before");
    }
  }
  std::vector<double> x(n + 2 * pad);
  for (std::size_t i = 0; i < pad; ++i) {
    x[i] = 2.0 * samples[0] - samples[pad - i];
    x[pad + n + i] = 2.0 * samples[n - 1] - samples[n - 2 - i];
  }
  for (std::size_t i = 0; i < n; ++i) x[pad + i] = samples[i];
  const double both_passes = std::pow(std::numbers::sqrt2 - 1.0, -0.25);
  const Biquad filter = butterworth(std::tan(std::numbers::pi * s.cutoff_hz / s.rate_hz) * both_passes);
  for (int direction = 0; direction < 2; ++direction) {
    pass(filter, x);
    std::reverse(x.begin(), x.end());
  }
  return {x.begin() + static_cast<std::ptrdiff_t>(pad), x.begin() + static_cast<std::ptrdiff_t>(pad + n)};
}

Eigen::MatrixXd smooth_rows(const Eigen::MatrixXd& rows, const Smoothing& s, const std::string& what) {
  Eigen::MatrixXd out(rows.rows(), rows.cols());
  std::vector<double> row(static_cast<std::size_t>(rows.cols()));
  for (Eigen::Index r = 0; r < rows.rows(); ++r) {
    for (Eigen::Index i = 0; i < rows.cols(); ++i) row[static_cast<std::size_t>(i)] = rows(r, i);
    const std::vector<double> smoothed =
        smooth(row, s, rows.rows() == 1 ? what : fmt::format("component {} of {}", r + 1, what));
    for (Eigen::Index i = 0; i < rows.cols(); ++i) out(r, i) = smoothed[static_cast<std::size_t>(i)];
  }
  return out;
}

Eigen::MatrixXd derivative_rows(const Eigen::MatrixXd& x, double rate_hz) {
  const Eigen::Index n = x.cols();
  if (n < 5)
    throw data::InputError("trial-too-short",
                           fmt::format("a derivative needs at least 5 samples, not {}", n));
  Eigen::MatrixXd d(x.rows(), n);
  const double k = rate_hz / 12.0;
  for (Eigen::Index i = 2; i + 2 < n; ++i)
    d.col(i) = k * (x.col(i - 2) - 8.0 * x.col(i - 1) + 8.0 * x.col(i + 1) - x.col(i + 2));
  const auto end = [&](Eigen::Index i, Eigen::Index step, const double(&c)[5]) {
    const double sign = static_cast<double>(step);
    const Eigen::Index first = step > 0 ? 0 : n - 1;
    d.col(i).setZero();
    for (Eigen::Index j = 0; j < 5; ++j) d.col(i) += sign * k * c[j] * x.col(first + step * j);
  };
  constexpr double at_end[5] = {-25.0, 48.0, -36.0, 16.0, -3.0};
  constexpr double beside[5] = {-3.0, -10.0, 18.0, -6.0, 1.0};
  end(0, 1, at_end);
  end(1, 1, beside);
  end(n - 1, -1, at_end);
  end(n - 2, -1, beside);
  return d;
}

std::vector<double> derivative(std::span<const double> samples, double rate_hz) {
  Eigen::MatrixXd row(1, static_cast<Eigen::Index>(samples.size()));
  for (std::size_t i = 0; i < samples.size(); ++i) row(0, static_cast<Eigen::Index>(i)) = samples[i];
  const Eigen::MatrixXd d = derivative_rows(row, rate_hz);
  return {d.data(), d.data() + d.size()};
}

}  // namespace brachium::limb
