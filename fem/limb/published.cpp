#include "fem/limb/published.hpp"

#include <numbers>

namespace brachium::fem {
namespace {

double polynomial_mm(double q_rad, double c2, double c1, double c0) {
  const double theta = q_rad * 180.0 / std::numbers::pi;
  return 1e-3 * ((c2 * theta + c1) * theta + c0);
}

}  // namespace

// l_B = -0.001482 theta^2 + 0.1776 theta + 35.02,  l_T = -0.0009399 theta^2 + 0.1126 theta + 22.21   [mm,
// theta in deg]
double published_biceps_lever_arm_m(double q) {
  return polynomial_mm(q, -0.001482, 0.1776, 35.02);
}
double published_triceps_lever_arm_m(double q) {
  return polynomial_mm(q, -0.0009399, 0.1126, 22.21);
}

}  // namespace brachium::fem
