#pragma once
/// Fibre directions and blending of tissues at the quadrature points of all cells, as the assembly reads
/// them.

#include <Eigen/Core>

namespace brachium::fem {

/// Column q + n_q c belongs to quadrature point q of cell c (fem/element/quadrature.hpp).
struct TissueField {
  Eigen::Matrix3Xd fibre;  ///< unit vectors a0, reference placement; any value where a region's law has none;
                           ///< empty: none has
  Eigen::VectorXd muscle;  ///< gamma_M in [0, 1]; empty: 1 everywhere
  Eigen::VectorXd soft_tissue;  ///< gamma_ST in [0, 1]; empty: 0 everywhere
};

}  // namespace brachium::fem
