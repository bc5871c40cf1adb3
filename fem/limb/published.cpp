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

const std::vector<PublishedForce>& published_forces() {
  static const std::vector<PublishedForce> forces = [] {
    constexpr double deg = std::numbers::pi / 180.0;
    constexpr double table[7][5] = {// angle, triceps passive and active, biceps passive and active
                                    {10, 24.5, 337.9, 391.7, 716.7},   {45, 157.2, 632.2, 242.2, 600.0},
                                    {60, 242.8, 773.0, 182.6, 535.8},  {80, 368.6, 948.8, 124.9, 428.2},
                                    {90, 424.8, 1021.3, 102.0, 366.8}, {115, 499.6, 1114.4, 50.0, 202.5},
                                    {150, 452.7, 1013.0, 1.0, 35.4}};
    std::vector<PublishedForce> out;
    for (int active = 0; active < 2; ++active) {
      for (const auto& row : table)
        out.push_back({row[0] * deg, static_cast<double>(active), row[1 + active], row[3 + active]});
    }
    return out;
  }();
  return forces;
}

}  // namespace brachium::fem
