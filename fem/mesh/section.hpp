#pragma once
/// Cross-sections made of quadrilaterals, and solids swept from them: what all generators of this folder
/// share.
///
///   section: points (u, v), quadrilaterals with nine nodes: corners 0-3 counter-clockwise, edge nodes 4-7 on
///   the edges
///            01 12 23 30, the centre 8
///   sweep:   layers of hexahedra with 27 nodes along w; points go where `map` puts (u, v, w)

#include <Eigen/Core>
#include <functional>
#include <string>
#include <vector>

#include "data/model/mesh.hpp"

namespace brachium::fem {

struct Section {
  Eigen::Matrix2Xd points;
  Eigen::MatrixXi quads;  ///< 9 x n
  std::vector<std::array<int, 2>>
      tags;  ///< where a quadrilateral belongs: (i, j) in a grid, (ring, -) in a disk
};

/// A grid over u x v, quadrilateral (i, j) only where keep(i, j); no keep: all.
Section grid_section(const std::vector<double>& u, const std::vector<double>& v,
                     const std::function<bool(int, int)>& keep = {});

/// The unit disk without degenerate quadrilaterals: a square core of n x n whose sides bulge, rings around it
/// (an O-grid). Tags: ring -1 in the core, then 0, 1, ... outwards.
///   core_cells n: the circumference has 4 n quadrilaterals
///   ring_radii: outer radius of each ring, rising, the last 1; the core's corners lie at core_radius
Section disk_section(int core_cells, const std::vector<double>& ring_radii, double core_radius = 0.55);

/// What a swept cell and its outer faces are called; a face can be part of several surfaces, or of none.
struct SweepNames {
  std::function<int(std::array<int, 2> tag, int layer)> region;  ///< index into `regions`
  std::vector<std::string> regions;
  std::function<std::vector<std::string>(std::array<int, 2> tag, int layer)> first;  ///< faces at the first w
  std::function<std::vector<std::string>(std::array<int, 2> tag, int layer)> last;   ///< faces at the last w
  std::function<std::vector<std::string>(std::array<int, 2> tag, int edge, int layer)>
      side;  ///< outer edge 0-3 of the section
};

/// Regions that no cell is in are left out. Surfaces stand in the order of their first face.
data::Mesh sweep(const Section& section, const std::vector<double>& w,
                 const std::function<Eigen::Vector3d(double u, double v, double w)>& map,
                 const SweepNames& names);

}  // namespace brachium::fem
