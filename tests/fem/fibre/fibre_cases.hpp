#pragma once
/// What the tests of this folder share.

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <functional>
#include <numbers>
#include <string>

#include "fem/element/quadrature.hpp"
#include "fem/element/shape.hpp"
#include "fem/fibre/tissue.hpp"
#include "fem/mesh/block.hpp"
#include "fem/mesh/convert.hpp"

namespace brachium::fem::test {

using Eigen::Vector3d;

inline Formulation formulation_for(data::CellType type) {
  switch (type) {
    case data::CellType::hex8:
      return Formulation::q1_p0;
    case data::CellType::tet10:
      return Formulation::p2_p1_taylor_hood;
    default:
      return Formulation::q2_p1_discontinuous;
  }
}

inline Tissue build(const data::Mesh& mesh, const TissueRules& rules) {
  return build_tissue(mesh, formulation_for(mesh.type), rules);
}

inline TissueRules fibres(FibreRule rule) {
  return TissueRules{{std::move(rule)}, {}, {}};
}

/// A block in two regions along x: left, right.
inline data::Mesh two_regions(data::CellType type = data::CellType::hex27) {
  BlockOptions o;
  o.type = type;
  o.y = {1.0, 2}, o.z = {1.0, 2};
  o.slabs = {{"left", {1.0, 2}}, {"right", {1.0, 2}}};
  return block(o);
}

/// A quarter of a ring about z, radii 1 to 2, height .5; y0 and y1 are its ends at angle 0 and 90 degrees.
/// `uneven` cells are not alike: where they are, symmetry makes too much exact.
inline data::Mesh quarter_ring(int radial, int around, data::CellType type, bool uneven = true) {
  data::Mesh mesh = block({1.0, 1.0, 0.5}, radial, around, 1, data::CellType::hex27);
  for (int p = 0; p < mesh.point_count(); ++p) {
    Vector3d x = mesh.points.col(p);
    if (uneven) {
      const double u = x[0], v = x[1];
      x[0] += 0.4 * u * (1 - u) * (0.5 - v);
      x[1] += 0.4 * v * (1 - v) * (1 - 1.5 * u);
    }
    const double r = 1.0 + x[0], angle = (1.0 - x[1]) * std::numbers::pi / 2;
    mesh.points.col(p) = Vector3d(r * std::sin(angle), r * std::cos(angle), x[2]);
  }
  return as_type(mesh, type);
}

inline Vector3d position(const data::Mesh& mesh, int cell, int q) {
  const Quadrature& rule = cell_quadrature(formulation_for(mesh.type));
  Vector3d x = Vector3d::Zero();
  const Shape s = cell_shape(mesh.type, rule.points.col(q));
  for (int a = 0; a < mesh.cells.rows(); ++a) x += s.value[a] * mesh.points.col(mesh.cells(a, cell));
  return x;
}

/// Largest angle between the fibres, as axes, and those expected at their places.
inline double largest_angle(const data::Mesh& mesh, const Eigen::Matrix3Xd& fibre,
                            const std::function<Vector3d(const Vector3d&)>& expected) {
  const int n_q = cell_quadrature(formulation_for(mesh.type)).size();
  EXPECT_EQ(fibre.cols(), n_q * mesh.cell_count());
  double worst = 0.0;
  for (int c = 0; c < mesh.cell_count(); ++c) {
    for (int q = 0; q < n_q; ++q) {
      const Vector3d a = fibre.col(q + n_q * c), e = expected(position(mesh, c, q)).normalized();
      EXPECT_NEAR(a.norm(), 1.0, 1e-14);
      worst = std::max(worst, std::atan2(a.cross(e).norm(), std::abs(a.dot(e))));
    }
  }
  return worst;
}

inline data::Diagnostic complaint(const data::Mesh& mesh, const TissueRules& rules) {
  try {
    build(mesh, rules);
  } catch (const data::InputError& error) {
    return error.diagnostics().front();
  }
  ADD_FAILURE() << "nothing was refused";
  return {};
}

}  // namespace brachium::fem::test
