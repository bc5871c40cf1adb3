#pragma once
/// Fields that a mesh brings along, at quadrature points.

#include <string>
#include <vector>

#include "fem/fibre/points.hpp"

namespace brachium::fem {

/// Fills columns q + n_q c of `fibre` for the cells given. Throws as build_tissue() says.
void fibres_from_field(const CellPoints& points, const std::string& field, const std::vector<int>& cells,
                       Eigen::Matrix3Xd& fibre);

/// Fills entries q + n_q c of `fraction`. Quadratic shape functions may leave [0, 1] between points that do
/// not: such values are brought back to the nearer end. Returns how many were.
int fractions_from_field(const CellPoints& points, const std::string& field, const std::vector<int>& cells,
                         Eigen::VectorXd& fraction);

}  // namespace brachium::fem
