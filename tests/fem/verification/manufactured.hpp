#pragma once
/// Manufactured solutions in the unit cube: a displacement, a pressure and a fibre field given in closed
/// form, and the body force -Div P that makes them the solution.
///
/// Isochoric (incompressible tissue), s = 1 - x, X'(x) = 1 + a s², η = y + d s³ sin kz:
///   x̂ = x + a/3 (1 - s³),   ŷ = η/X' + b s³,   ẑ = z + c s³ sin kη,   det F = 1
///   p = p0 + p1 s sin ky cos kz
/// At x = 1 F = 1 and the fibres are uniform, so that this side carries the uniform dead traction
///   t = p0 e_x + alpha sigma_max f_l(1) (a0 · e_x) a0.
///
/// Compressible: u = g (sin kx cos ky, sin ky cos kz, sin kz cos kx + x y), p = kappa (J - 1), prescribed all
/// round.

#include <Eigen/Core>

#include "fem/material/material.hpp"

namespace brachium::fem::verification {

class Manufactured {
 public:
  enum class Kind { isochoric, compressible };
  explicit Manufactured(Kind kind);

  Kind kind() const { return kind_; }
  const MuscleTendon& law() const { return law_; }
  double activation() const { return 0.5; }
  double bulk_modulus() const;

  Eigen::Vector3d displacement(const Eigen::Vector3d& X) const;
  Eigen::Matrix3d deformation_gradient(const Eigen::Vector3d& X) const;
  Eigen::Vector3d fibre(const Eigen::Vector3d& X) const;
  double pressure(const Eigen::Vector3d& X) const;  ///< tension positive
  Eigen::Matrix3d first_piola(const Eigen::Vector3d& X) const;
  Eigen::Vector3d body_force(const Eigen::Vector3d& X) const;  ///< -Div P by differences of sixth order
  Eigen::Vector3d end_traction() const;                        ///< at x = 1, isochoric

 private:
  Kind kind_;
  MuscleTendon law_;
};

}  // namespace brachium::fem::verification
