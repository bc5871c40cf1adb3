#include "tests/fem/verification/box_mesh.hpp"

#include <cmath>
#include <map>
#include <random>
#include <stdexcept>

#include "fem/element/shape.hpp"

namespace brachium::fem::verification {
namespace {

using Lattice = std::array<int, 3>;  // corners at even coordinates
using Eigen::Vector3d;

bool tetrahedral(data::CellType type) {
  return data::corners_per_cell(type) == 4;
}

class Builder {
 public:
  explicit Builder(const Box& box) : box_(box), noise_(box.seed) {
    mesh_->type = box.type;
    mesh_->regions = {"body"};
    const auto [nx, ny, nz] = box.cells;
    for (int k = 0; k <= nz; ++k) {
      for (int j = 0; j <= ny; ++j) {
        for (int i = 0; i <= nx; ++i) corner_[{2 * i, 2 * j, 2 * k}] = corner_position({2 * i, 2 * j, 2 * k});
      }
    }
    for (int k = 0; k < nz; ++k) {
      for (int j = 0; j < ny; ++j) {
        for (int i = 0; i < nx; ++i) brick({2 * i, 2 * j, 2 * k});
      }
    }
  }

  std::shared_ptr<data::Mesh> finish() {
    mesh_->points.resize(3, static_cast<Eigen::Index>(points_.size()));
    for (std::size_t i = 0; i < points_.size(); ++i)
      mesh_->points.col(static_cast<Eigen::Index>(i)) = points_[i];
    mesh_->cells.resize(data::nodes_per_cell(box_.type), static_cast<Eigen::Index>(cells_.size()));
    for (std::size_t c = 0; c < cells_.size(); ++c) {
      for (std::size_t a = 0; a < cells_[c].size(); ++a) {
        mesh_->cells(static_cast<Eigen::Index>(a), static_cast<Eigen::Index>(c)) = cells_[c][a];
      }
    }
    mesh_->region_of_cell.assign(cells_.size(), 0);
    surfaces();
    return mesh_;
  }

 private:
  /// The unmapped position of a lattice point, without distortion.
  Vector3d regular(const Lattice& p) const {
    Vector3d x;
    for (std::size_t d = 0; d < 3; ++d) {
      x[static_cast<Eigen::Index>(d)] =
          box_.size_m[static_cast<Eigen::Index>(d)] * p[d] / (2.0 * box_.cells[d]);
    }
    return x;
  }

  Vector3d mapped(const Vector3d& x) const { return box_.map ? box_.map(x) : x; }

  Vector3d corner_position(const Lattice& p) {
    Vector3d x = regular(p);
    std::uniform_real_distribution<double> uniform(-1.0, 1.0);
    for (std::size_t d = 0; d < 3; ++d) {
      const double step = uniform(noise_);
      if (p[d] == 0 || p[d] == 2 * box_.cells[d]) continue;
      const auto e = static_cast<Eigen::Index>(d);
      x[e] += box_.distortion * step * box_.size_m[e] / box_.cells[d];
    }
    return mapped(x);
  }

  /// A node between the corners around it: two on an edge (the ends of a diagonal in tetrahedra), four or
  /// eight.
  Vector3d position(const Lattice& p) const {
    if (box_.curved) return mapped(regular(p));
    Vector3d sum = Vector3d::Zero();
    double count = 0.0;
    for (int bits = 0; bits < 8; ++bits) {
      if (tetrahedral(box_.type) && bits != 0 && bits != 7) continue;
      Lattice q = p;
      for (std::size_t d = 0; d < 3; ++d) {
        if (p[d] % 2 != 0) q[d] += (bits >> d & 1) != 0 ? 1 : -1;
      }
      sum += corner_.at(q);
      count += 1.0;
    }
    return sum / count;
  }

  int point(const Lattice& p) {
    const auto [entry, is_new] = number_.try_emplace(p, static_cast<int>(points_.size()));
    if (is_new) {
      points_.push_back(corner_.contains(p) ? corner_.at(p) : position(p));
      lattice_.push_back(p);
    }
    return entry->second;
  }

  void brick(const Lattice& low) {
    if (!tetrahedral(box_.type)) {
      const Eigen::Matrix3Xd& local = node_coordinates(box_.type);
      std::vector<int> nodes;
      for (Eigen::Index a = 0; a < local.cols(); ++a) {
        Lattice p = low;
        for (std::size_t d = 0; d < 3; ++d)
          p[d] += 1 + static_cast<int>(std::lround(local(static_cast<Eigen::Index>(d), a)));
        nodes.push_back(point(p));
      }
      cells_.push_back(nodes);
      return;
    }
    constexpr std::array<std::array<std::size_t, 3>, 6> paths{
        {{0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {1, 0, 2}, {0, 2, 1}, {2, 1, 0}}};
    for (std::size_t k = 0; k < paths.size(); ++k) {
      std::array<Lattice, 4> corner;
      corner[0] = low;
      for (std::size_t step = 0; step < 3; ++step) {
        corner[step + 1] = corner[step];
        corner[step + 1][paths[k][step]] += 2;
      }
      if (k >= 3) std::swap(corner[2], corner[3]);  // odd permutations are mirrored
      std::vector<int> nodes;
      for (const Lattice& p : corner) nodes.push_back(point(p));
      if (box_.type == data::CellType::tet10) {
        for (const auto& [a, b] : {std::pair{0, 1}, {1, 2}, {2, 0}, {0, 3}, {1, 3}, {2, 3}}) {
          Lattice p{};
          for (std::size_t d = 0; d < 3; ++d)
            p[d] = (corner[static_cast<std::size_t>(a)][d] + corner[static_cast<std::size_t>(b)][d]) / 2;
          nodes.push_back(point(p));
        }
      }
      cells_.push_back(nodes);
    }
  }

  void surfaces() {
    const std::array<std::string, 6> names{"x0", "x1", "y0", "y1", "z0", "z1"};
    std::array<data::NamedSurface, 6> sides;
    data::NamedSurface boundary{"boundary", {}}, clamp{"clamp", {}};
    for (const data::CellFace& face : data::boundary_faces(*mesh_)) {
      boundary.faces.push_back(face);
      for (std::size_t side = 0; side < 6; ++side) {
        const std::size_t d = side / 2;
        const int plane = side % 2 == 0 ? 0 : 2 * box_.cells[d];
        bool on = true;
        for (const int a : data::face_nodes(box_.type, face.face)) {
          on = on && lattice_[static_cast<std::size_t>(mesh_->cells(a, face.cell))][d] == plane;
        }
        if (!on) continue;
        sides[side].faces.push_back(face);
        if (side != 1) clamp.faces.push_back(face);
      }
    }
    for (std::size_t side = 0; side < 6; ++side) {
      sides[side].name = names[side];
      mesh_->surfaces.push_back(sides[side]);
    }
    mesh_->surfaces.push_back(boundary);
    mesh_->surfaces.push_back(clamp);
  }

  Box box_;
  std::mt19937 noise_;
  std::shared_ptr<data::Mesh> mesh_ = std::make_shared<data::Mesh>();
  std::map<Lattice, Vector3d> corner_;
  std::map<Lattice, int> number_;
  std::vector<Lattice> lattice_;
  std::vector<Vector3d> points_;
  std::vector<std::vector<int>> cells_;
};

}  // namespace

std::shared_ptr<data::Mesh> box_mesh(const Box& box) {
  return Builder(box).finish();
}

void split_region(data::Mesh& mesh, const std::string& name,
                  const std::function<bool(const Vector3d&)>& inside) {
  const int index = static_cast<int>(mesh.regions.size());
  mesh.regions.push_back(name);
  const int corners = data::corners_per_cell(mesh.type);
  for (int c = 0; c < mesh.cell_count(); ++c) {
    Vector3d centre = Vector3d::Zero();
    for (int a = 0; a < corners; ++a) centre += mesh.points.col(mesh.cells(a, c)) / corners;
    if (inside(centre)) mesh.region_of_cell[static_cast<std::size_t>(c)] = index;
  }
}

}  // namespace brachium::fem::verification
