#include "tests/fem/verification/manufactured.hpp"

#include <Eigen/LU>
#include <cmath>

#include "tests/fem/verification/study.hpp"

namespace brachium::fem::verification {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double a = 0.25, b = 0.1, c = 0.12, d = 0.08, k = 2.2, g = 0.12;
constexpr double p0 = 0.3, p1 = 1.5;

}  // namespace

Manufactured::Manufactured(Kind kind) : kind_(kind) {
  law_.muscle = {.c1_pa = 1.0, .c2_pa = 0.3, .c3_pa = 0.2, .c4 = 6.0};
  law_.tendon = law_.muscle;
  law_.max_stress_pa = 1.2;
  law_.force_length = {.optimal_stretch = 1.1,
                       .ascending_width = 0.6,
                       .ascending_exponent = 4.0,
                       .descending_width = 0.7,
                       .descending_exponent = 4.0};
  if (kind == Kind::compressible)
    law_.muscle.c3_pa = law_.tendon.c3_pa = 0.0;  // its kink at stretch 1 would run through cells
}

double Manufactured::bulk_modulus() const {
  return kind_ == Kind::isochoric ? incompressible : 8.0;
}

Vector3d Manufactured::displacement(const Vector3d& X) const {
  const double x = X[0], y = X[1], z = X[2];
  if (kind_ == Kind::compressible) {
    return g * Vector3d(std::sin(k * x) * std::cos(k * y), std::sin(k * y) * std::cos(k * z),
                        std::sin(k * z) * std::cos(k * x) + x * y);
  }
  const double s = 1.0 - x, s3 = s * s * s, stretch = 1.0 + a * s * s;
  const double eta = y + d * s3 * std::sin(k * z);
  return {a / 3.0 * (1.0 - s3), eta / stretch + b * s3 - y, c * s3 * std::sin(k * eta)};
}

Matrix3d Manufactured::deformation_gradient(const Vector3d& X) const {
  const double x = X[0], y = X[1], z = X[2];
  if (kind_ == Kind::compressible) {
    Matrix3d H;
    H << k * std::cos(k * x) * std::cos(k * y), -k * std::sin(k * x) * std::sin(k * y), 0.0,  //
        0.0, k * std::cos(k * y) * std::cos(k * z), -k * std::sin(k * y) * std::sin(k * z),   //
        -k * std::sin(k * z) * std::sin(k * x) + y, x, k * std::cos(k * z) * std::cos(k * x);
    return Matrix3d::Identity() + g * H;
  }
  const double s = 1.0 - x, s2 = s * s, s3 = s2 * s, stretch = 1.0 + a * s2;
  const double eta = y + d * s3 * std::sin(k * z);
  Matrix3d first = Matrix3d::Identity(), second = first, third = first;
  first(1, 0) = -3.0 * d * s2 * std::sin(k * z);  // (x, y, z) -> (x, eta, z)
  first(1, 2) = d * s3 * k * std::cos(k * z);
  second(2, 0) = -3.0 * c * s2 * std::sin(k * eta);  // -> (x, eta, z + c s^3 sin k eta)
  second(2, 1) = c * s3 * k * std::cos(k * eta);
  third(0, 0) = stretch;  // -> (x + a/3 (1 - s^3), eta/X' + b s^3, .)
  third(1, 0) = 2.0 * a * s * eta / (stretch * stretch) - 3.0 * b * s2;
  third(1, 1) = 1.0 / stretch;
  return third * second * first;
}

Vector3d Manufactured::fibre(const Vector3d& X) const {
  const double s = 1.0 - X[0];
  return Vector3d(1.0, 0.2 + 0.3 * s * X[2], -0.1 + 0.2 * s * std::sin(k * X[1])).normalized();
}

double Manufactured::pressure(const Vector3d& X) const {
  if (kind_ == Kind::compressible) return bulk_modulus() * (deformation_gradient(X).determinant() - 1.0);
  return p0 + p1 * (1.0 - X[0]) * std::sin(k * X[1]) * std::cos(k * X[2]);
}

Matrix3d Manufactured::first_piola(const Vector3d& X) const {
  const Matrix3d F = deformation_gradient(X), C = F.transpose() * F;
  const Vector3d a0 = fibre(X);
  MaterialPoint<double> point{};
  const double components[6] = {C(0, 0), C(1, 1), C(2, 2), C(0, 1), C(1, 2), C(0, 2)};
  std::copy(components, components + 6, point.C);
  for (int i = 0; i < 3; ++i) point.fibre[i] = a0[i];
  point.activation = activation();
  point.muscle = 1.0;
  point.soft_tissue = 0.0;
  point.stretch_before = 1.0;
  MaterialResponse<double> r{};
  evaluate(law_, point, r);
  Matrix3d S;
  S << r.S[0], r.S[3], r.S[5], r.S[3], r.S[1], r.S[4], r.S[5], r.S[4], r.S[2];
  return F * S + pressure(X) * F.determinant() * F.inverse().transpose();
}

Vector3d Manufactured::body_force(const Vector3d& X) const {
  // f'(0) = (45 (f1 - f-1) - 9 (f2 - f-2) + (f3 - f-3)) / (60 h)
  constexpr double h = 2e-3;
  Vector3d divergence = Vector3d::Zero();
  for (int J = 0; J < 3; ++J) {
    const Vector3d e = h * Vector3d::Unit(J);
    const Matrix3d difference = 45.0 * (first_piola(X + e) - first_piola(X - e)) -
                                9.0 * (first_piola(X + 2 * e) - first_piola(X - 2 * e)) +
                                (first_piola(X + 3 * e) - first_piola(X - 3 * e));
    divergence += difference.col(J) / (60.0 * h);
  }
  return -divergence;
}

Vector3d Manufactured::end_traction() const {
  const Vector3d a0 = fibre(Vector3d::UnitX());
  return p0 * Vector3d::UnitX() +
         activation() * law_.max_stress_pa * force_length(law_.force_length, 1.0) * a0[0] * a0;
}

}  // namespace brachium::fem::verification
