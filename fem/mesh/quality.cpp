#include "fem/mesh/quality.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "fem/element/quadrature.hpp"
#include "fem/element/shape.hpp"

namespace brachium::fem {
namespace {

using data::CellType;
using data::Mesh;

/// Where J is looked at: quadrature points (first, with weights) and nodes; derivatives of the shape
/// functions there.
struct Samples {
  std::vector<Eigen::MatrixXd> derivative;
  Eigen::VectorXd weights;
};

Quadrature quadrature_of(CellType type) {
  switch (type) {
    case CellType::tet4:
      return cell_quadrature(Formulation::p2_p1_taylor_hood);
    case CellType::tet10:
      return cell_quadrature(Formulation::p2b_p1_discontinuous);
    case CellType::hex8:
      return gauss_hexahedron(2);
    case CellType::hex20:
    case CellType::hex27:
      return gauss_hexahedron(3);
  }
  return {};
}

Samples samples_of(CellType type) {
  Samples samples;
  const Quadrature rule = quadrature_of(type);
  for (int q = 0; q < rule.size(); ++q)
    samples.derivative.push_back(cell_shape(type, rule.points.col(q)).derivative);
  for (const auto xi : node_coordinates(type).colwise())
    samples.derivative.push_back(cell_shape(type, xi).derivative);
  samples.weights = rule.weights;
  return samples;
}

/// Neighbours along edges of each corner, right-handed.
constexpr int hexahedron_corner[8][3] = {{1, 3, 4}, {2, 0, 5}, {3, 1, 6}, {0, 2, 7},
                                         {7, 5, 0}, {4, 6, 1}, {5, 7, 2}, {6, 4, 3}};
constexpr int tetrahedron_corner[4][3] = {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}};

double scaled_jacobian(const Eigen::Matrix3Xd& x, bool hexahedron) {
  double worst = std::numeric_limits<double>::infinity();
  for (int i = 0; i < (hexahedron ? 8 : 4); ++i) {
    const int* next = hexahedron ? hexahedron_corner[i] : tetrahedron_corner[i];
    Eigen::Matrix3d edges;
    double lengths = 1.0;
    for (int k = 0; k < 3; ++k) {
      edges.col(k) = x.col(next[k]) - x.col(i);
      lengths *= edges.col(k).norm();
    }
    worst = std::min(worst, lengths > 0.0 ? edges.determinant() / lengths : 0.0);
  }
  return hexahedron ? worst : std::numbers::sqrt2 * worst;
}

double hexahedron_aspect(const Eigen::Matrix3Xd& x) {
  const auto axis = [&](std::array<int, 4> from, std::array<int, 4> to) {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (std::size_t i = 0; i < 4; ++i) sum += x.col(to[i]) - x.col(from[i]);
    return sum.norm();
  };
  const double length[3] = {axis({0, 3, 7, 4}, {1, 2, 6, 5}), axis({0, 1, 5, 4}, {3, 2, 6, 7}),
                            axis({0, 1, 2, 3}, {4, 5, 6, 7})};
  const auto [low, high] = std::minmax_element(length, length + 3);
  return *low > 0.0 ? *high / *low : std::numeric_limits<double>::infinity();
}

double tetrahedron_aspect(const Eigen::Matrix3Xd& x) {
  double longest = 0.0, area = 0.0;
  for (int i = 0; i < 4; ++i) {
    for (int j = i + 1; j < 4; ++j) longest = std::max(longest, (x.col(i) - x.col(j)).norm());
    const auto f = data::face_nodes(CellType::tet4, i);
    area +=
        0.5 *
        Eigen::Vector3d(x.col(f[1]) - x.col(f[0])).cross(Eigen::Vector3d(x.col(f[2]) - x.col(f[0]))).norm();
  }
  Eigen::Matrix3d edges;
  for (int k = 0; k < 3; ++k) edges.col(k) = x.col(k + 1) - x.col(0);
  const double inradius = 3.0 * std::abs(edges.determinant() / 6.0) / area;
  return inradius > 0.0 ? longest / (2.0 * std::sqrt(6.0) * inradius)
                        : std::numeric_limits<double>::infinity();
}

double longest_edge(const Mesh& mesh, int cell) {
  const Eigen::Matrix3Xd x =
      mesh.points(Eigen::all, mesh.cells.col(cell).head(data::corners_per_cell(mesh.type)));
  return (x.rowwise().maxCoeff() - x.rowwise().minCoeff()).norm();
}

const std::string& region_of(const Mesh& mesh, int cell) {
  return mesh.regions[static_cast<std::size_t>(mesh.region_of_cell[static_cast<std::size_t>(cell)])];
}

/// One finding about cells, the worst first: `value` orders them (smaller is worse).
void report(std::vector<data::Diagnostic>& findings, const Mesh& mesh, const std::string& code,
            const std::string& sentence, std::vector<int> cells, const Eigen::VectorXd& value,
            const std::string& value_name, const std::string& help, bool large_is_worse = false) {
  if (cells.empty()) return;
  const std::size_t named = std::min<std::size_t>(5, cells.size());
  std::partial_sort(cells.begin(), cells.begin() + static_cast<std::ptrdiff_t>(named), cells.end(),
                    [&](int a, int b) {
                      if (value[a] != value[b])
                        return large_is_worse ? value[a] > value[b] : value[a] < value[b];
                      return a < b;
                    });
  std::string text = fmt::format("{} of {} cells {}:", cells.size(), mesh.cell_count(), sentence);
  for (std::size_t i = 0; i < named; ++i) {
    const int c = cells[i];
    const Eigen::Vector3d centre =
        mesh.points(Eigen::all, mesh.cells.col(c).head(data::corners_per_cell(mesh.type))).rowwise().mean();
    text += fmt::format("{} cell {} of `{}` at ({:.4g}, {:.4g}, {:.4g}) m, {} {:.3g}", i ? ";" : "", c,
                        region_of(mesh, c), centre.x(), centre.y(), centre.z(), value_name, value[c]);
  }
  if (cells.size() > named) text += fmt::format("; and {} more", cells.size() - named);
  findings.push_back({data::Severity::error, code, std::move(text), std::nullopt, help});
}

void check_cells(const Mesh& mesh, const QualityLimits& limits, std::vector<data::Diagnostic>& findings) {
  const CellQuality quality = cell_quality(mesh);
  std::vector<int> inverted, degenerate, distorted, sheared, stretched;
  for (int c = 0; c < mesh.cell_count(); ++c) {
    const double size = longest_edge(mesh, c);
    if (!(std::abs(quality.jacobian_min_m3[c]) > 1e-12 * size * size * size)) {
      degenerate.push_back(c);
    } else if (quality.jacobian_min_m3[c] < 0.0) {
      inverted.push_back(c);
    } else if (quality.jacobian_ratio[c] < limits.jacobian_ratio_min) {
      distorted.push_back(c);
    } else if (quality.scaled_jacobian[c] < limits.scaled_jacobian_min) {
      sheared.push_back(c);
    } else if (!(quality.aspect[c] <= limits.aspect_max)) {
      stretched.push_back(c);
    }
  }
  const bool all = std::ssize(inverted) == mesh.cell_count();
  report(
      findings, mesh, "inverted-cells", "are inverted", inverted, quality.jacobian_ratio, "Jacobian ratio",
      all ? "all are: the mesh is mirrored, or its nodes are numbered in another order than the format says"
          : "mesh finer there, or straighten the curved edges");
  report(findings, mesh, "degenerate-cells", "have no volume", degenerate, quality.jacobian_ratio,
         "Jacobian ratio", "collapsed cells are not supported: remove them, or mesh with tetrahedra there");
  report(findings, mesh, "distorted-cells",
         fmt::format("have a Jacobian ratio below {}", limits.jacobian_ratio_min), distorted,
         quality.jacobian_ratio, "Jacobian ratio", "smooth the mesh there, or lower the limit knowingly");
  report(findings, mesh, "distorted-cells",
         fmt::format("have a scaled Jacobian below {}", limits.scaled_jacobian_min), sheared,
         quality.scaled_jacobian, "scaled Jacobian", "smooth the mesh there, or lower the limit knowingly");
  report(findings, mesh, "stretched-cells", fmt::format("have an aspect ratio above {}", limits.aspect_max),
         stretched, quality.aspect, "aspect ratio",
         "use more cells along the long direction, or raise the limit knowingly", true);
}

void check_connection(const Mesh& mesh, const QualityLimits& limits,
                      std::vector<data::Diagnostic>& findings) {
  if (!limits.several_parts) {
    const std::vector<int> part = connected_parts(mesh);
    const int count = part.empty() ? 0 : *std::max_element(part.begin(), part.end()) + 1;
    if (count > 1) {
      std::string text = fmt::format("the mesh falls into {} parts that share no points:", count);
      std::vector<int> cells(static_cast<std::size_t>(count), 0), first(static_cast<std::size_t>(count), -1);
      for (std::size_t c = 0; c < part.size(); ++c) {
        const auto p = static_cast<std::size_t>(part[c]);
        if (cells[p]++ == 0) first[p] = static_cast<int>(c);
      }
      for (std::size_t p = 0; p < cells.size() && p < 5; ++p)
        text += fmt::format("{} {} cells with cell {} of `{}`", p ? ";" : "", cells[p], first[p],
                            region_of(mesh, first[p]));
      findings.push_back({data::Severity::error, "disconnected-mesh", std::move(text), std::nullopt,
                          "merge coincident points where the parts should hold together"});
    }
  }
  if (!limits.unused_points) {
    const std::vector<int> points = unused_points(mesh);
    if (!points.empty()) {
      findings.push_back(
          {data::Severity::error, "unused-points",
           fmt::format("{} points belong to no cell, the first is point {}", points.size(), points.front()),
           std::nullopt, "remove them; they would have no stiffness"});
    }
  }
}

}  // namespace

CellQuality cell_quality(const Mesh& mesh) {
  const Samples samples = samples_of(mesh.type);
  const bool hexahedron = data::corners_per_cell(mesh.type) == 8;
  const Eigen::Index n = mesh.cell_count();
  CellQuality quality{Eigen::VectorXd(n), Eigen::VectorXd(n), Eigen::VectorXd(n), Eigen::VectorXd(n),
                      Eigen::VectorXd(n)};
  for (int c = 0; c < n; ++c) {
    const Eigen::Matrix3Xd x = mesh.points(Eigen::all, mesh.cells.col(c));
    double low = std::numeric_limits<double>::infinity(), high = -low, volume = 0.0;
    for (std::size_t s = 0; s < samples.derivative.size(); ++s) {
      const Eigen::Matrix3d gradient = x * samples.derivative[s];
      const double jacobian = gradient.determinant();
      low = std::min(low, jacobian);
      high = std::max(high, jacobian);
      const auto q = static_cast<Eigen::Index>(s);
      if (q < samples.weights.size()) volume += samples.weights[q] * jacobian;
    }
    quality.volume_m3[c] = volume;
    quality.jacobian_min_m3[c] = low;
    // A cell that is inverted throughout counts as -1, one without volume as 0.
    quality.jacobian_ratio[c] = high > 0.0 ? low / high : (low < 0.0 ? -1.0 : 0.0);
    quality.scaled_jacobian[c] = scaled_jacobian(x, hexahedron);
    quality.aspect[c] = hexahedron ? hexahedron_aspect(x) : tetrahedron_aspect(x);
  }
  return quality;
}

data::Table quality_table(const Mesh& mesh, const CellQuality& quality) {
  struct Row {
    std::string region;
    double cells = 0, volume = 0;
    double worst[4] = {std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity(),
                       std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
    int cell[4] = {-1, -1, -1, -1};
  };
  std::vector<Row> rows;
  for (const std::string& region : mesh.regions) rows.push_back({.region = region});
  rows.push_back({.region = "all"});
  const auto add = [&](Row& row, int c) {
    row.cells += 1.0;
    row.volume += quality.volume_m3[c];
    const double value[4] = {quality.jacobian_min_m3[c], quality.jacobian_ratio[c],
                             quality.scaled_jacobian[c], quality.aspect[c]};
    for (int m = 0; m < 4; ++m) {
      if (row.cell[m] >= 0 && !(m == 3 ? value[m] > row.worst[m] : value[m] < row.worst[m])) continue;
      row.worst[m] = value[m];
      row.cell[m] = c;
    }
  };
  for (int c = 0; c < mesh.cell_count(); ++c) {
    add(rows[static_cast<std::size_t>(mesh.region_of_cell[static_cast<std::size_t>(c)])], c);
    add(rows.back(), c);
  }
  std::erase_if(rows, [](const Row& row) { return row.cells == 0.0; });
  data::Table table{"mesh quality by region, worst cells", {}};
  std::vector<std::string> names;
  for (const Row& row : rows) names.push_back(row.region);
  table.columns.push_back({"region", "", names});
  const auto column = [&](const std::string& name, const std::string& unit, auto value) {
    std::vector<double> list;
    for (const Row& row : rows) list.push_back(value(row));
    table.columns.push_back({name, unit, std::move(list)});
  };
  column("cells", "1", [](const Row& r) { return r.cells; });
  column("volume_m3", "m^3", [](const Row& r) { return r.volume; });
  constexpr std::array<const char*, 4> measures{"jacobian_min_m3", "jacobian_ratio_min",
                                                "scaled_jacobian_min", "aspect_max"};
  constexpr std::array<const char*, 4> units{"m^3", "1", "1", "1"};
  for (std::size_t m = 0; m < 4; ++m) {
    column(measures[m], units[m], [&](const Row& r) { return r.worst[m]; });
    column(std::string(measures[m]) + "_cell", "1", [&](const Row& r) { return r.cell[m]; });
  }
  return table;
}

std::vector<int> connected_parts(const Mesh& mesh) {
  std::vector<int> parent(static_cast<std::size_t>(mesh.point_count()));
  for (std::size_t p = 0; p < parent.size(); ++p) parent[p] = static_cast<int>(p);
  const auto root = [&](int p) {
    while (parent[static_cast<std::size_t>(p)] != p) {
      auto& up = parent[static_cast<std::size_t>(p)];
      up = parent[static_cast<std::size_t>(up)];
      p = up;
    }
    return p;
  };
  for (const auto cell : mesh.cells.colwise()) {
    for (const int p : cell) parent[static_cast<std::size_t>(root(p))] = root(cell[0]);
  }
  std::vector<int> number(parent.size(), -1), part;
  int count = 0;
  for (const auto cell : mesh.cells.colwise()) {
    int& n = number[static_cast<std::size_t>(root(cell[0]))];
    if (n < 0) n = count++;
    part.push_back(n);
  }
  return part;
}

std::vector<int> unused_points(const Mesh& mesh) {
  std::vector<char> used(static_cast<std::size_t>(mesh.point_count()), 0);
  for (const int p : mesh.cells.reshaped()) used[static_cast<std::size_t>(p)] = 1;
  std::vector<int> list;
  for (std::size_t p = 0; p < used.size(); ++p) {
    if (!used[p]) list.push_back(static_cast<int>(p));
  }
  return list;
}

std::vector<data::Diagnostic> check_quality(const Mesh& mesh, const QualityLimits& limits) {
  std::vector<data::Diagnostic> findings = data::check_structure(mesh);
  if (!findings.empty()) return findings;  // geometry needs indices that hold
  check_cells(mesh, limits, findings);
  check_connection(mesh, limits, findings);
  return findings;
}

void require_quality(const Mesh& mesh, const QualityLimits& limits) {
  auto findings = check_quality(mesh, limits);
  if (!findings.empty()) throw data::InputError(std::move(findings));
}

}  // namespace brachium::fem
