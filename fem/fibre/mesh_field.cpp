#include "fem/fibre/mesh_field.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace brachium::fem {
namespace {

constexpr double unit_tolerance = 1e-3;  // files carry single precision, or a few digits of text

struct Found {
  const Eigen::MatrixXd* values;
  bool by_point;
};

Found find(const data::Mesh& mesh, const std::string& name, int components) {
  const auto point = mesh.point_fields.find(name);
  const auto cell = mesh.cell_fields.find(name);
  const bool by_point = point != mesh.point_fields.end(), by_cell = cell != mesh.cell_fields.end();
  if (!by_point && !by_cell) {
    std::vector<std::string> names;
    for (const auto& [key, value] : mesh.point_fields) names.push_back(key);
    for (const auto& [key, value] : mesh.cell_fields) names.push_back(key);
    throw data::InputError("missing-mesh-field", "the mesh has no field `" + name + "`",
                           names.empty() ? "the mesh brings no fields along" : data::suggest(name, names));
  }
  const Eigen::MatrixXd& values = by_point ? point->second : cell->second;
  const int expected = by_point ? mesh.point_count() : mesh.cell_count();
  if (values.rows() != components || values.cols() != expected) {
    throw data::InputError("bad-mesh-field",
                           fmt::format("field `{}` has {} components for {} {}", name, values.rows(),
                                       values.cols(), by_point ? "points" : "cells"),
                           fmt::format("{} components for {} are needed", components, expected));
  }
  return {&values, by_point};
}

void check_unit(const std::string& name, const char* what, int index, const Eigen::Vector3d& a) {
  if (std::abs(a.norm() - 1.0) <= unit_tolerance) return;
  throw data::InputError("bad-fibre",
                         fmt::format("`{}` at {} {} has length {:.6g}", name, what, index, a.norm()),
                         "fibre directions must have length 1 to within 0.001");
}

void check_fraction(const std::string& name, const char* what, int index, double value) {
  if (value >= 0.0 && value <= 1.0) return;
  throw data::InputError("bad-fraction", fmt::format("`{}` at {} {} is {:.6g}", name, what, index, value),
                         "it must be in [0, 1]");
}

}  // namespace

void fibres_from_field(const CellPoints& points, const std::string& field, const std::vector<int>& cells,
                       Eigen::Matrix3Xd& fibre) {
  const data::Mesh& mesh = points.mesh();
  const Found found = find(mesh, field, 3);
  const int n_q = points.per_cell();
  for (int c : cells) {
    if (!found.by_point) {
      const Eigen::Vector3d a = found.values->col(c);
      check_unit(field, "cell", c, a);
      for (int q = 0; q < n_q; ++q) fibre.col(q + n_q * c) = a.normalized();
      continue;
    }
    Eigen::Matrix3Xd a(3, mesh.cells.rows());
    for (int n = 0; n < a.cols(); ++n) {
      a.col(n) = found.values->col(mesh.cells(n, c));
      check_unit(field, "point", mesh.cells(n, c), a.col(n));
      if (a.col(n).dot(a.col(0)) < 0.0) a.col(n) *= -1.0;
    }
    for (int q = 0; q < n_q; ++q) {
      const Eigen::Vector3d between = a * points.shape(q).value;
      if (!(between.norm() > 0.5)) {
        throw data::InputError(
            "bad-fibre",
            fmt::format("directions `{}` at the points of cell {} differ so much that they "
                        "cancel inside it",
                        field, c),
            "refine the mesh there, or give directions by cell");
      }
      fibre.col(q + n_q * c) = between.normalized();
    }
  }
}

int fractions_from_field(const CellPoints& points, const std::string& field, const std::vector<int>& cells,
                         Eigen::VectorXd& fraction) {
  const data::Mesh& mesh = points.mesh();
  const Found found = find(mesh, field, 1);
  const int n_q = points.per_cell();
  int brought_back = 0;
  for (int c : cells) {
    if (!found.by_point) {
      check_fraction(field, "cell", c, (*found.values)(0, c));
      fraction.segment(n_q * c, n_q).setConstant((*found.values)(0, c));
      continue;
    }
    Eigen::VectorXd value(mesh.cells.rows());
    for (int n = 0; n < value.size(); ++n) {
      value[n] = (*found.values)(0, mesh.cells(n, c));
      check_fraction(field, "point", mesh.cells(n, c), value[n]);
    }
    for (int q = 0; q < n_q; ++q) {
      const double between = points.shape(q).value.dot(value);
      fraction[q + n_q * c] = std::clamp(between, 0.0, 1.0);
      if (between < -1e-12 || between > 1.0 + 1e-12) ++brought_back;
    }
  }
  return brought_back;
}

}  // namespace brachium::fem
