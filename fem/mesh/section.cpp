#include "fem/mesh/section.hpp"

#include <cmath>
#include <map>
#include <numbers>

#include "fem/mesh/axis.hpp"

namespace brachium::fem {
namespace {

using Tag = std::array<int, 2>;

/// Knots and the middles between them: 2 n + 1 values.
std::vector<double> with_middles(const std::vector<double>& knots) {
  std::vector<double> all;
  all.reserve(2 * knots.size());
  for (std::size_t i = 0; i < knots.size(); ++i) {
    if (i > 0) all.push_back(0.5 * (knots[i - 1] + knots[i]));
    all.push_back(knots[i]);
  }
  return all;
}

/// The nine nodes of a quadrilateral from a 3 x 3 patch of points, node(a, b) with a along the first
/// direction.
template <class Node>
Eigen::Matrix<int, 9, 1> nine_nodes(Node node) {
  Eigen::Matrix<int, 9, 1> q;
  q << node(0, 0), node(2, 0), node(2, 2), node(0, 2), node(1, 0), node(2, 1), node(1, 2), node(0, 1),
      node(1, 1);
  return q;
}

}  // namespace

Section grid_section(const std::vector<double>& u, const std::vector<double>& v,
                     const std::function<bool(int, int)>& keep) {
  const std::vector<double> all_u = with_middles(u), all_v = with_middles(v);
  const int nu = static_cast<int>(u.size()) - 1, nv = static_cast<int>(v.size()) - 1;
  const int row = 2 * nu + 1;
  std::vector<int> number(all_u.size() * all_v.size(), -1);
  Section section;
  std::vector<Eigen::Matrix<int, 9, 1>> quads;
  for (int j = 0; j < nv; ++j) {
    for (int i = 0; i < nu; ++i) {
      if (keep && !keep(i, j)) continue;
      quads.push_back(nine_nodes([&](int a, int b) { return (2 * i + a) + row * (2 * j + b); }));
      section.tags.push_back({i, j});
      for (const int p : quads.back()) number[static_cast<std::size_t>(p)] = 0;
    }
  }
  int count = 0;
  for (int& n : number) {
    if (n == 0) n = count++;
  }
  section.points.resize(2, count);
  for (std::size_t p = 0; p < number.size(); ++p) {
    if (number[p] >= 0) section.points.col(number[p]) << all_u[p % all_u.size()], all_v[p / all_u.size()];
  }
  section.quads.resize(9, static_cast<Eigen::Index>(quads.size()));
  for (std::size_t q = 0; q < quads.size(); ++q)
    section.quads.col(static_cast<Eigen::Index>(q)) =
        quads[q].unaryExpr([&](int p) { return number[static_cast<std::size_t>(p)]; });
  return section;
}

Section disk_section(int core_cells, const std::vector<double>& ring_radii, double core_radius) {
  check_option("disk: core_cells", core_cells, 1, 1e4, false);
  check_option("disk: core_radius", core_radius, 0.2, 0.8, false);
  double inner = core_radius;
  for (const double r : ring_radii) {
    check_option("disk: ring radius", r, inner, 1.0, true);
    inner = r;
  }
  check_option("disk: outermost ring radius", inner, 1.0, 1.0, false);

  // The core: the square with corners at core_radius, its sides bulging a third of the way to the circle
  // through the corners; straight coordinates s, t in [-1, 1].
  const double half = core_radius / std::numbers::sqrt2;
  const double bulge = (core_radius - half) / 3.0;
  const auto core = [&](double s, double t) -> Eigen::Vector2d {
    return {half * s + bulge * s * (1.0 - t * t), half * t + bulge * t * (1.0 - s * s)};
  };
  const int n = 2 * core_cells, side = n + 1, perimeter = 4 * n;
  const int rings = static_cast<int>(ring_radii.size());
  Section section;
  section.points.resize(2, side * side + perimeter * 2 * rings);
  const auto core_id = [&](int i, int j) { return i + side * j; };
  const auto unit = [&](int i) { return 2.0 * i / n - 1.0; };
  for (int j = 0; j <= n; ++j) {
    for (int i = 0; i <= n; ++i) section.points.col(core_id(i, j)) = core(unit(i), unit(j));
  }
  // Perimeter p counts counter-clockwise from the corner (1, -1).
  const auto perimeter_id = [&](int p) {
    p %= perimeter;
    const int k = p % n;
    switch (p / n) {
      case 0:
        return core_id(n, k);
      case 1:
        return core_id(n - k, n);
      case 2:
        return core_id(0, n - k);
      default:
        return core_id(k, 0);
    }
  };
  const auto ring_id = [&](int layer, int p) {
    return layer == 0 ? perimeter_id(p) : side * side + (layer - 1) * perimeter + p % perimeter;
  };
  std::vector<double> radii{core_radius};
  radii.insert(radii.end(), ring_radii.begin(), ring_radii.end());
  const std::vector<double> layers = with_middles(radii);
  for (int layer = 1; layer <= 2 * rings; ++layer) {
    const double share = (layers[static_cast<std::size_t>(layer)] - core_radius) / (1.0 - core_radius);
    for (int p = 0; p < perimeter; ++p) {
      const double angle = 2.0 * std::numbers::pi * p / perimeter - 0.25 * std::numbers::pi;
      const Eigen::Vector2d rim(std::cos(angle), std::sin(angle));
      section.points.col(ring_id(layer, p)) =
          share == 1.0 ? rim : (1.0 - share) * section.points.col(perimeter_id(p)) + share * rim;
    }
  }

  section.quads.resize(9, core_cells * core_cells + rings * 4 * core_cells);
  int q = 0;
  for (int j = 0; j < core_cells; ++j) {
    for (int i = 0; i < core_cells; ++i) {
      section.quads.col(q++) = nine_nodes([&](int a, int b) { return core_id(2 * i + a, 2 * j + b); });
      section.tags.push_back({-1, 0});
    }
  }
  for (int r = 0; r < rings; ++r) {
    for (int k = 0; k < 4 * core_cells; ++k) {
      section.quads.col(q++) = nine_nodes([&](int a, int b) { return ring_id(2 * r + a, 2 * k + b); });
      section.tags.push_back({r, k});
    }
  }
  return section;
}

data::Mesh sweep(const Section& section, const std::vector<double>& w,
                 const std::function<Eigen::Vector3d(double, double, double)>& map, const SweepNames& names) {
  const std::vector<double> levels = with_middles(w);
  const int layer_points = static_cast<int>(section.points.cols());
  const int quads = static_cast<int>(section.quads.cols());
  const int layers = static_cast<int>(w.size()) - 1;
  data::Mesh mesh;
  mesh.type = data::CellType::hex27;
  mesh.points.resize(3, static_cast<Eigen::Index>(levels.size()) * layer_points);
  for (int k = 0; k < static_cast<int>(levels.size()); ++k) {
    for (int p = 0; p < layer_points; ++p) {
      const Eigen::Vector2d at = section.points.col(p);
      mesh.points.col(k * layer_points + p) = map(at.x(), at.y(), levels[static_cast<std::size_t>(k)]);
    }
  }

  // Outer edges of the section stand once.
  std::map<std::array<int, 2>, int> uses;
  const auto edge_key = [&](int q, int e) {
    const int a = section.quads(e, q), b = section.quads((e + 1) % 4, q);
    return std::array<int, 2>{std::min(a, b), std::max(a, b)};
  };
  for (int q = 0; q < quads; ++q) {
    for (int e = 0; e < 4; ++e) ++uses[edge_key(q, e)];
  }

  std::vector<int> region_number(names.regions.size(), -1);
  std::map<std::string, std::size_t> surface_number;
  const auto add_face = [&](const std::vector<std::string>& face_names, int cell, int face) {
    for (const std::string& name : face_names) {
      const auto [found, is_new] = surface_number.try_emplace(name, mesh.surfaces.size());
      if (is_new) mesh.surfaces.push_back({name, {}});
      mesh.surfaces[found->second].faces.push_back({cell, face});
    }
  };
  // Nodes 0..26 of a hexahedron: layer (0 bottom, 1 middle, 2 top) and node of the quadrilateral.
  constexpr int level_of[27] = {0, 0, 0, 0, 2, 2, 2, 2, 0, 0, 0, 0, 2, 2,
                                2, 2, 1, 1, 1, 1, 1, 1, 1, 1, 0, 2, 1};
  constexpr int node_of[27] = {0, 1, 2, 3, 0, 1, 2, 3, 4, 5, 6, 7, 4, 5,
                               6, 7, 0, 1, 2, 3, 7, 5, 4, 6, 8, 8, 8};
  constexpr int face_of_edge[4] = {2, 1, 3, 0};
  mesh.cells.resize(27, static_cast<Eigen::Index>(quads) * layers);
  for (int layer = 0, cell = 0; layer < layers; ++layer) {
    for (int q = 0; q < quads; ++q, ++cell) {
      const Tag tag = section.tags[static_cast<std::size_t>(q)];
      for (int a = 0; a < 27; ++a)
        mesh.cells(a, cell) = (2 * layer + level_of[a]) * layer_points + section.quads(node_of[a], q);
      const auto region = static_cast<std::size_t>(names.region(tag, layer));
      if (region_number[region] < 0) {
        region_number[region] = static_cast<int>(mesh.regions.size());
        mesh.regions.push_back(names.regions[region]);
      }
      mesh.region_of_cell.push_back(region_number[region]);
      if (layer == 0) add_face(names.first(tag, layer), cell, 4);
      if (layer == layers - 1) add_face(names.last(tag, layer), cell, 5);
      for (int e = 0; e < 4; ++e) {
        if (uses[edge_key(q, e)] == 1) add_face(names.side(tag, e, layer), cell, face_of_edge[e]);
      }
    }
  }
  return mesh;
}

}  // namespace brachium::fem
