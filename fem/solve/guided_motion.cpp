#include "fem/solve/guided_motion.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace brachium::fem {
namespace {

using Row = Eigen::Vector4d;  ///< place, angle

Row row(const GuidedMotion& m, Eigen::Index i) {
  Row r;
  r << m.place_m.col(i), m.angle_rad[i];
  return r;
}

/// Slope at knot i of the parabola through it and its neighbours; at the ends of the chord.
Row slope(const GuidedMotion& m, Eigen::Index i) {
  const Eigen::Index last = m.amplitude.size() - 1;
  const auto chord = [&](Eigen::Index k) -> Row {
    return (row(m, k + 1) - row(m, k)) / (m.amplitude[k + 1] - m.amplitude[k]);
  };
  if (i == 0) return chord(0);
  if (i == last) return chord(last - 1);
  const double before = m.amplitude[i] - m.amplitude[i - 1], after = m.amplitude[i + 1] - m.amplitude[i];
  return (after * chord(i - 1) + before * chord(i)) / (before + after);
}

}  // namespace

GuidedPlace guided_place(const GuidedMotion& m, double amplitude) {
  const Eigen::Index last = m.amplitude.size() - 1;
  const double a = std::clamp(amplitude, m.amplitude[0], m.amplitude[last]);
  const double* begin = m.amplitude.data();
  const Eigen::Index i =
      std::clamp<Eigen::Index>(std::upper_bound(begin, begin + last + 1, a) - begin - 1, 0, last - 1);
  const double h = m.amplitude[i + 1] - m.amplitude[i], t = (a - m.amplitude[i]) / h, s = 1.0 - t;
  // Cubic Hermite polynomials: exact at both knots.
  const Row value = s * s * (1.0 + 2.0 * t) * row(m, i) + t * t * (1.0 + 2.0 * s) * row(m, i + 1) +
                    t * s * s * h * slope(m, i) - t * t * s * h * slope(m, i + 1);
  return {value.head<3>(), value[3]};
}

std::string guided_motion_fault(const GuidedMotion& m) {
  const Eigen::Index n = m.amplitude.size();
  if (n < 2 || m.place_m.cols() != n || m.angle_rad.size() != n) {
    return fmt::format("{} amplitudes, {} places and {} angles: as many of each are needed, at least 2", n,
                       m.place_m.cols(), m.angle_rad.size());
  }
  if (!(m.amplitude.allFinite() && m.place_m.allFinite() && m.angle_rad.allFinite() &&
        m.centre_m.allFinite()))
    return "a value is not finite";
  if (!(m.axis.allFinite() && m.axis.norm() > 0.0)) return "the axis of rotation has no direction";
  for (Eigen::Index i = 1; i < n; ++i) {
    if (!(m.amplitude[i] > m.amplitude[i - 1]))
      return fmt::format("amplitude {} does not rise ({} after {})", i, m.amplitude[i], m.amplitude[i - 1]);
  }
  if (m.amplitude[0] != 0.0 || m.angle_rad[0] != 0.0 || (m.place_m.col(0) - m.centre_m).norm() > 1e-12) {
    return "the first entry must be amplitude 0 with the place of the centre and angle 0";
  }
  return {};
}

}  // namespace brachium::fem
