#pragma once
/// How the fibres of a region lie: figures for the log.

#include "data/model/table.hpp"
#include "fem/fibre/points.hpp"

namespace brachium::fem {

/// One row a region in which all points have fibres. Fibres count as axes, so the mean is the first
/// eigenvector of the orientation tensor A = sum V a0 x a0/sum V (Advani & Tucker 1987,
/// doi:10.1122/1.549945), signed by the first fibre; `alignment` is its eigenvalue (1 parallel, 1/3 without
/// order). Angles to the mean lie in [0, 90] degrees. Columns: region, points, volume_m3, mean_x, mean_y,
/// mean_z, alignment, angle_rms_deg, angle_min_deg, angle_max_deg, angle_max_cell.
data::Table direction_table(const CellPoints& points, const Eigen::Matrix3Xd& fibre);

}  // namespace brachium::fem
