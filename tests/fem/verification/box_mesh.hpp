#pragma once
/// Boxes of every cell type for the verification problems: regular, distorted at random, or mapped; made here
/// and not by the generators under test elsewhere.

#include <Eigen/Core>
#include <array>
#include <functional>
#include <memory>

#include "data/model/mesh.hpp"

namespace brachium::fem::verification {

struct Box {
  data::CellType type = data::CellType::hex27;  ///< tetrahedra: six to a brick (Kuhn)
  std::array<int, 3> cells{1, 1, 1};
  Eigen::Vector3d size_m = Eigen::Vector3d::Ones();
  double distortion =
      0.0;  ///< corners moved at random by up to this share of the spacing; those on a side stay in it
  unsigned seed = 1;
  std::function<Eigen::Vector3d(const Eigen::Vector3d&)> map{};  ///< applied to corners last; empty: identity
  bool curved = false;  ///< edge and face nodes are mapped as well, instead of lying between their corners
};

/// Surfaces x0 x1 y0 y1 z0 z1 (sides of the box before mapping), `boundary` (all faces) and `clamp` (all but
/// x1); one region, `body`.
std::shared_ptr<data::Mesh> box_mesh(const Box& box);

/// Divides the region of a box: cells whose centre (mean of corners) fulfils `inside` become region `name`.
void split_region(data::Mesh& mesh, const std::string& name,
                  const std::function<bool(const Eigen::Vector3d&)>& inside);

}  // namespace brachium::fem::verification
