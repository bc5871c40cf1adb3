#include "fem/limb/strap.hpp"

#include <fmt/format.h>

#include <numbers>

#include "data/model/curve.hpp"
#include "data/model/error.hpp"
#include "fem/material/material.hpp"

namespace brachium::fem {

double uniaxial_stress_pa(const MuscleTendon& law, double stretch, double activation) {
  MaterialPoint<double> point{};
  point.C[0] = stretch * stretch;
  point.C[1] = point.C[2] = 1.0 / stretch;
  point.fibre[0] = 1.0;
  point.muscle = 1.0;
  point.activation = activation;
  point.stretch_before = stretch;
  MaterialResponse<double> out{};
  evaluate(law, point, out);
  // The pressure that makes the sides free: S_22 + p/C_22 = 0.
  const double pressure = -out.S[1] * point.C[1];
  return stretch * (out.S[0] + pressure / point.C[0]);
}

double mean_area_m2(const MuscleBody& body) {
  std::vector<double> s(body.profile_m.size());
  for (std::size_t i = 0; i < s.size(); ++i)
    s[i] = static_cast<double>(i) / static_cast<double>(s.size() - 1);
  const auto radius = data::PiecewiseCubic::monotone(s, body.profile_m);
  constexpr int n = 200;  // Simpson's rule on cubics
  double sum = 0.0;
  for (int i = 0; i <= n; ++i) {
    const double r = radius(static_cast<double>(i) / n).value;
    sum += (i == 0 || i == n ? 1.0 : (i % 2 == 1 ? 4.0 : 2.0)) * r * r;
  }
  return std::numbers::pi * body.flatness * sum / (3.0 * n);
}

double strap_stretch(const MuscleBody& body, double q) {
  return (CablePath(body.cable, q).length_m() - body.cable_length_m()) / body.stress_free_length_m();
}

double strap_force_n(const MuscleBody& body, double q, double activation) {
  if (body.tendon_origin_m > 0.0 || body.tendon_insertion_m > 0.0) {
    throw data::InputError("limb-geometry", fmt::format("{}: a strap has no meshed tendons", body.name),
                           "compare with the rigid-tendon variant");
  }
  return mean_area_m2(body) * uniaxial_stress_pa(body.material, strap_stretch(body, q), activation);
}

}  // namespace brachium::fem
