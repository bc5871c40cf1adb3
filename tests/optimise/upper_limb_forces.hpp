#pragma once
// The published forces of the Upper Limb Model as a muscle model: Valentin 2019, doi:10.18419/opus-10504, ch.
// 7 - muscle forces of the continuum model at seven angles, passive and fully active, and lever arms as
// polynomials of the angle.

#include <cmath>
#include <memory>
#include <numbers>

#include "fem/surrogate/surrogate_model.hpp"
#include "fem/surrogate/tensor.hpp"
#include "optimise/scenario.hpp"
#include "optimise/scenario_signs.hpp"

namespace brachium::optimise::test {

constexpr double deg = std::numbers::pi / 180.0;

// The tables' signs: F_T >= 0, F_B <= 0.
struct PublishedForces {
  double angle_deg, triceps_passive, triceps_active, biceps_passive, biceps_active;
};
constexpr PublishedForces published_forces[] = {
    {10, 24.5, 337.9, -391.7, -716.7},   {45, 157.2, 632.2, -242.2, -600.0},
    {60, 242.8, 773.0, -182.6, -535.8},  {80, 368.6, 948.8, -124.9, -428.2},
    {90, 424.8, 1021.3, -102.0, -366.8}, {115, 499.6, 1114.4, -50.0, -202.5},
    {150, 452.7, 1013.0, -1.0, -35.4}};

// c2 theta^2 + c1 theta + c0 in mm, theta in degrees.
inline data::CurveValue published_lever(double c2, double c1, double c0, double q) {
  const double t = q / deg;
  return {1e-3 * (c2 * t * t + c1 * t + c0), 1e-3 * (2.0 * c2 * t + c1) / deg};
}

inline fem::SurrogateMuscle published_muscle(bool biceps, fem::ThetaCurve curve) {
  const thesis::Action action = biceps ? thesis::Action::flexor : thesis::Action::extensor;
  fem::SampleSet set{{"force_n"}, {}};
  for (const PublishedForces& row : published_forces) {
    const double forces[] = {biceps ? row.biceps_passive : row.triceps_passive,
                             biceps ? row.biceps_active : row.triceps_active};
    for (int a = 0; a < 2; ++a) {
      set.samples.push_back({{row.angle_deg * deg, static_cast<double>(a)},
                             Eigen::VectorXd::Constant(1, thesis::tension_from_force(action, forces[a]))});
    }
  }
  auto surrogate = std::make_shared<fem::Surrogate>(
      fem::tensor_spline(fem::as_grid(set), {curve, fem::AlphaCurve::linear}));
  const auto arm = [biceps, action](double q) {
    return thesis::moment_arm(action, biceps ? published_lever(-0.001482, 0.1776, 35.02, q)
                                             : published_lever(-0.0009399, 0.1126, 22.21, q));
  };
  return {biceps ? "biceps" : "triceps", std::move(surrogate), "force_n", fem::ArmOfAngle{arm}};
}

/// Activations in the order triceps, biceps.
inline fem::SurrogateModel published_model(fem::ThetaCurve curve = fem::ThetaCurve::monotone) {
  return fem::SurrogateModel("elbow_flexion",
                             {published_muscle(false, curve), published_muscle(true, curve)});
}

inline StaticSystem published_system(const fem::SurrogateModel& model) {
  StaticSystem system;
  system.model = &model;
  system.load_arm = [](double q) { return thesis::load_arm({0.2825 * std::sin(q), 0.2825 * std::cos(q)}); };
  system.lower_rad = 10.0 * deg;
  system.upper_rad = 150.0 * deg;
  return system;
}

}  // namespace brachium::optimise::test
