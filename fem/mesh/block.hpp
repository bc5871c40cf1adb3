#pragma once
/// A block along the axes.

#include <optional>

#include "data/model/mesh.hpp"
#include "fem/mesh/axis.hpp"

namespace brachium::fem {

/// Regions one after the other along x, each with its own length and cells.
struct Slab {
  std::string region;
  Axis x;
};

struct BlockOptions {
  data::CellType type = data::CellType::hex27;
  Axis x, y, z;
  std::string region = "block";
  std::vector<Slab> slabs;                             ///< if given, instead of x and region
  Eigen::Vector3d corner_m = Eigen::Vector3d::Zero();  ///< lowest corner
  std::optional<Eigen::Vector3d> fibre;                ///< cell field `fibre`, normalised
};

/// Surfaces x0 x1 y0 y1 z0 z1. Throws InputError("bad-mesh-option").
data::Mesh block(const BlockOptions& options);

/// n_x x n_y x n_z equal cells over [0, size].
data::Mesh block(const Eigen::Vector3d& size_m, int nx, int ny, int nz,
                 data::CellType type = data::CellType::hex27);

}  // namespace brachium::fem
