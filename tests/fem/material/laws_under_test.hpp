#pragma once
/// Every law and option, for the properties that all of them share.

#include <Eigen/Dense>
#include <ostream>
#include <string>
#include <vector>

#include "fem/material/material.hpp"

namespace brachium::fem::test {

using Eigen::Matrix3d;
using Eigen::Vector3d;

/// A law at a place: what does not change while C does.
struct Case {
  std::string name;
  Material material;
  double activation = 0.0;
  double muscle = 1.0;
  double soft_tissue = 0.0;
  double inverse_dt = 0.0;
  double stretch_before = 1.0;
  bool isochoric = false;  ///< energy of J^(-2/3) C
};

inline MuscleTendon muscle_tendon() {
  MuscleTendon m;
  m.muscle = {3.5e4, 3.8e3, 40.0, 12.0};
  m.tendon = {2.3e5, 1.1, 8.0e4, 7.5};
  m.max_stress_pa = 3e5;
  m.force_length = {1.15, 0.57, 4.0, 0.14, 3.0};
  return m;
}

inline std::vector<Case> all_cases() {
  std::vector<Case> cases;
  const MuscleTendon base = muscle_tendon();
  cases.push_back({"muscle", base});
  cases.push_back({"tendon", base, 0.0, 0.0});
  cases.push_back({"active", base, 0.7});
  cases.push_back({"transition", base, 0.7, 0.6});
  cases.push_back({"soft_tissue", base, 0.7, 1.0, 1.0});
  cases.push_back({"part_soft_tissue", base, 0.7, 0.8, 0.3});
  MuscleTendon m = base;
  m.blending = Blending::parameters;
  cases.push_back({"blended_parameters", m, 0.7, 0.6});
  m = base;
  m.active_stress = ActiveStress::cauchy;
  cases.push_back({"cauchy", m, 0.7});
  m.force_length = {1.2, 0.3, 2.5, 0.3, 1.5};
  cases.push_back({"cauchy_other_exponents", m, 1.0});
  m = base;
  m.rate_dependent = true;
  m.force_velocity = {5.0, 0.25, 1.5};
  cases.push_back({"rate_dependent", m, 0.7, 1.0, 0.0, 2.0, 1.02});
  m.active_stress = ActiveStress::cauchy;
  cases.push_back({"rate_dependent_cauchy", m, 0.7, 1.0, 0.0, 2.0, 1.02});
  cases.push_back({"neo_hooke", NeoHooke{2e4, false}});
  cases.push_back({"neo_hooke_isochoric", NeoHooke{2e4, true}, 0, 1, 0, 0, 1, true});
  cases.push_back({"mooney_rivlin", MooneyRivlin{1e4, 3e3, false}});
  cases.push_back({"mooney_rivlin_isochoric", MooneyRivlin{1e4, 3e3, true}, 0, 1, 0, 0, 1, true});
  cases.push_back({"fung", FungGuccione{2e3, 8.0, 2.0, 4.0, false}});
  cases.push_back({"fung_isochoric", FungGuccione{2e3, 8.0, 2.0, 4.0, true}, 0, 1, 0, 0, 1, true});
  const BlemkerMuscle b{500.0, 700.0, 0.05, 6.6, 1.0, 3e5, 1.15};
  cases.push_back({"blemker", b, 0, 1, 0, 0, 1, true});
  cases.push_back({"blemker_active", b, 0.6, 1, 0, 0, 1, true});
  return cases;
}

/// For messages of the test program.
inline void PrintTo(const Case& c, std::ostream* out) {
  *out << c.name;
}

inline Matrix3d tensor(const double s[6]) {
  Matrix3d A;
  A << s[0], s[3], s[5], s[3], s[1], s[4], s[5], s[4], s[2];
  return A;
}

inline void components(const Matrix3d& A, double s[6]) {
  s[0] = A(0, 0), s[1] = A(1, 1), s[2] = A(2, 2), s[3] = A(0, 1), s[4] = A(1, 2), s[5] = A(0, 2);
}

inline MaterialPoint<double> point(const Case& c, const Matrix3d& C, const Vector3d& a0) {
  MaterialPoint<double> p;
  components(C, p.C);
  for (int i = 0; i < 3; ++i) p.fibre[i] = a0[i];
  p.activation = c.activation, p.muscle = c.muscle, p.soft_tissue = c.soft_tissue;
  p.stretch_before = c.stretch_before, p.inverse_dt = c.inverse_dt;
  return p;
}

inline MaterialResponse<double> respond(const Case& c, const Matrix3d& C, const Vector3d& a0) {
  MaterialResponse<double> r;
  evaluate(c.material, point(c, C, a0), r);
  return r;
}

/// CC : B for a symmetric B.
inline Matrix3d apply(const MaterialResponse<double>& r, const Matrix3d& B) {
  double b[6], s[6];
  components(B, b);
  for (int i = 0; i < 6; ++i) {
    s[i] = 0.0;
    for (int j = 0; j < 6; ++j) s[i] += (j < 3 ? 1.0 : 2.0) * r.CC[i <= j ? upper(i, j) : upper(j, i)] * b[j];
  }
  return tensor(s);
}

/// Placements with stretches about .7 to 1.4, shears and a change of volume; stretch along a0 below and above
/// 1, but nowhere so near a kink of a law that differences would step over it.
inline std::vector<Matrix3d> gradients() {
  std::vector<Matrix3d> list;
  Matrix3d F;
  F << 1.08, 0.11, -0.05, 0.03, 0.95, 0.07, -0.12, 0.04, 1.02;
  list.push_back(F);
  F << 1.31, -0.2, 0.1, 0.15, 0.84, 0.05, 0.02, -0.1, 0.97;
  list.push_back(F);
  F << 0.8, 0.1, 0.02, -0.1, 1.15, 0.2, 0.06, 0.05, 1.1;
  list.push_back(F);
  F << 1.05, 0.03, -0.02, 0.02, 1.0, 0.015, 0.008, 0.03, 0.96;
  list.push_back(F);
  return list;
}

inline std::vector<Vector3d> directions() {
  return {Vector3d(1, 0, 0), Vector3d(0.6, 0.64, 0.48).normalized(), Vector3d(-0.3, 0.2, 0.9).normalized()};
}

}  // namespace brachium::fem::test
