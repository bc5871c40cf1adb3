#include "fem/fibre/statistics.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace brachium::fem {
namespace {

struct Row {
  int points = 0;
  double volume = 0.0;
  Eigen::Matrix3d tensor = Eigen::Matrix3d::Zero();
  Eigen::Vector3d first = Eigen::Vector3d::Zero(), mean = Eigen::Vector3d::Zero();
  double alignment = 0.0, squares = 0.0, least = 180.0, most = -1.0;
  int most_cell = -1;
  bool whole = true;  // no point without fibres
};

// Angle between axes; atan2 keeps small angles exact.
double angle_deg(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return std::atan2(a.cross(b).norm(), std::abs(a.dot(b))) * 180.0 / std::numbers::pi;
}

}  // namespace

data::Table direction_table(const CellPoints& points, const Eigen::Matrix3Xd& fibre) {
  const data::Mesh& mesh = points.mesh();
  const int n_q = points.per_cell();
  std::vector<Row> rows(mesh.regions.size());
  std::vector<double> volume(static_cast<std::size_t>(fibre.cols()), 0.0);
  const int cells = fibre.cols() == 0 ? 0 : mesh.cell_count();
  for (int c = 0; c < cells; ++c) {
    Row& r = rows[static_cast<std::size_t>(mesh.region_of_cell[static_cast<std::size_t>(c)])];
    const Eigen::Matrix3Xd X = points.nodes(c);
    for (int q = 0; q < n_q; ++q) {
      const int k = q + n_q * c;
      const Eigen::Vector3d a = fibre.col(k);
      if (a.isZero()) r.whole = false;
      const double v = volume[static_cast<std::size_t>(k)] = points.volume(points.jacobian(X, q), q);
      if (r.points++ == 0) r.first = a;
      r.volume += v;
      r.tensor += v * a * a.transpose();
    }
  }
  for (Row& r : rows) {
    if (r.points == 0 || !r.whole) continue;
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(r.tensor / r.volume);
    r.mean = eigen.eigenvectors().col(2);
    r.alignment = eigen.eigenvalues()[2];
    if (r.mean.dot(r.first) < 0.0) r.mean = -r.mean;
  }
  for (int c = 0; c < cells; ++c) {
    Row& r = rows[static_cast<std::size_t>(mesh.region_of_cell[static_cast<std::size_t>(c)])];
    for (int q = 0; q < n_q && r.whole; ++q) {
      const double angle = angle_deg(fibre.col(q + n_q * c), r.mean);
      r.squares += volume[static_cast<std::size_t>(q + n_q * c)] * angle * angle;
      r.least = std::min(r.least, angle);
      if (angle > r.most) r.most = angle, r.most_cell = c;
    }
  }

  std::vector<std::string> region;
  std::vector<std::vector<double>> n(10);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const Row& r = rows[i];
    if (r.points == 0 || !r.whole) continue;
    region.push_back(mesh.regions[i]);
    const double values[] = {double(r.points),
                             r.volume,
                             r.mean[0],
                             r.mean[1],
                             r.mean[2],
                             r.alignment,
                             std::sqrt(r.squares / r.volume),
                             r.least,
                             r.most,
                             double(r.most_cell)};
    for (std::size_t k = 0; k < n.size(); ++k) n[k].push_back(values[k]);
  }
  data::Table table{"Fibre directions", {{"region", "", std::move(region)}}};
  const char* names[][2] = {{"points", "1"},          {"volume_m3", "m3"},      {"mean_x", "1"},
                            {"mean_y", "1"},          {"mean_z", "1"},          {"alignment", "1"},
                            {"angle_rms_deg", "deg"}, {"angle_min_deg", "deg"}, {"angle_max_deg", "deg"},
                            {"angle_max_cell", "1"}};
  for (std::size_t k = 0; k < n.size(); ++k)
    table.columns.push_back({names[k][0], names[k][1], std::move(n[k])});
  return table;
}

}  // namespace brachium::fem
