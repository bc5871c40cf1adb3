#pragma once
/// The distance to a closed triangle mesh as a smooth field: sampled on a regular grid around the body and
/// interpolated by tri-cubic B-splines, so that normals are continuous over facets, edges and corners and
/// contact has a potential. (Unser, Aldroubi & Eden 1993, doi:10.1109/78.193220, for the interpolation's
/// prefilter.)
///
/// The field agrees with the mesh's own distance to about the grid's spacing times the angle between facets;
/// it is stated
/// (`greatest_error_m`), measured at the triangles' corners and centres.

#include <Eigen/Core>
#include <vector>

#include "fem/contact/distance.hpp"
#include "fem/contact/triangle_tree.hpp"

namespace brachium::fem {

class DistanceGrid {
 public:
  /// Samples with `spacing_m` in the body's box and `margin_m` around it (at least three spacings are added).
  /// `smoothing_m`
  /// >= 0 rounds facets: the samples are filtered with a Gaussian of that width. `threads`: 0 all cores.
  /// Throws InputError as TriangleTree does, and "contact-grid" where spacing is not above 0 or the grid
  /// would have more than 5e7 samples.
  DistanceGrid(const TriangleTree& tree, double spacing_m, double margin_m, double smoothing_m = 0.0,
               std::size_t threads = 0);

  Distance evaluate(const Eigen::Vector3d& x_m) const;

  double greatest_error_m() const { return greatest_error_; }  ///< |field| on the mesh
  double spacing_m() const { return spacing_; }
  Eigen::Vector3i samples() const { return size_; }

 private:
  double spacing_;
  Eigen::Vector3d origin_;
  Eigen::Vector3i size_;
  std::vector<double> coefficient_;  ///< of the B-splines, x fastest
  double greatest_error_ = 0.0;
};

}  // namespace brachium::fem
