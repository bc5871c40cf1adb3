#include "fem/solve/rigid_support.hpp"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <Eigen/QR>
#include <Eigen/SVD>
#include <cmath>

namespace brachium::fem {
namespace {

using Matrix6 = Eigen::Matrix<double, 6, 6>;
using Vector6 = Eigen::Matrix<double, 6, 1>;

constexpr double null_tolerance = 1e-12;

double clean(double v) {
  return std::abs(v) < 1e-9 ? 0.0 : v;
}

std::string direction_name(Eigen::Vector3d d) {
  d.normalize();
  Eigen::Index largest = 0;
  d.cwiseAbs().maxCoeff(&largest);
  if (d[largest] < 0.0) d = -d;
  if (std::abs(d[largest] - 1.0) < 1e-9) return std::string(1, "xyz"[largest]);
  return fmt::format("({:.4g}, {:.4g}, {:.4g})", clean(d[0]), clean(d[1]), clean(d[2]));
}

/// An orthonormal basis of a subspace that consists of coordinate axes where they lie in it.
std::vector<Eigen::Vector3d> readable_basis(const Eigen::Matrix3Xd& orthonormal) {
  std::vector<Eigen::Vector3d> basis;
  const auto wanted = static_cast<std::size_t>(orthonormal.cols());
  const auto add = [&](Eigen::Vector3d v) {
    for (const Eigen::Vector3d& b : basis) v -= b.dot(v) * b;
    if (basis.size() < wanted && v.norm() > 1e-6) basis.push_back(v.normalized());
  };
  for (int i = 0; i < 3; ++i) {
    const Eigen::Vector3d axis = Eigen::Vector3d::Unit(i);
    if ((orthonormal.transpose() * axis).norm() > 1.0 - 1e-9) add(axis);
  }
  for (Eigen::Index k = 0; k < orthonormal.cols(); ++k) add(orthonormal.col(k));
  return basis;
}

}  // namespace

std::vector<std::string> free_motions(const data::Mesh& mesh, const std::vector<int>& nodes,
                                      const std::vector<Hold>& holds) {
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  for (const int n : nodes) centre += mesh.points.col(n);
  centre /= static_cast<double>(nodes.size());
  double size = 0.0;
  for (const int n : nodes) size = std::max(size, (mesh.points.col(n) - centre).norm());
  Matrix6 gram = Matrix6::Zero();
  for (const Hold& hold : holds) {
    const Eigen::Vector3d arm = (mesh.points.col(hold.node) - centre) / size;
    Vector6 row;
    row << hold.direction, arm.cross(hold.direction);
    gram += row * row.transpose();
  }
  const Eigen::SelfAdjointEigenSolver<Matrix6> modes(gram);
  const double largest = std::max(modes.eigenvalues()[5], 1.0);
  int free = 0;
  while (free < 6 && modes.eigenvalues()[free] <= null_tolerance * largest) ++free;
  std::vector<std::string> names;
  if (free == 0) return names;
  const Eigen::MatrixXd null = modes.eigenvectors().leftCols(free);

  // Translations: (t, 0) in the null space.
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> directions(
      Eigen::Matrix3d(gram.topLeftCorner<3, 3>()));
  int translations = 0;
  while (translations < 3 && directions.eigenvalues()[translations] <= null_tolerance * largest)
    ++translations;
  for (const Eigen::Vector3d& d : readable_basis(directions.eigenvectors().leftCols(translations))) {
    names.push_back("translation along " + direction_name(d));
  }
  if (free == translations) return names;

  // Rotations: the ω parts of the null space, each with the translation that belongs to it.
  const Eigen::MatrixXd turns = null.bottomRows(3);
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(turns, Eigen::ComputeThinU | Eigen::ComputeThinV);
  for (const Eigen::Vector3d& axis : readable_basis(svd.matrixU().leftCols(free - translations))) {
    const Vector6 motion = null * turns.completeOrthogonalDecomposition().solve(Eigen::MatrixXd(axis));
    const Eigen::Vector3d omega = motion.tail<3>() / size, t = motion.head<3>();
    const Eigen::Vector3d point = centre + omega.cross(t) / omega.squaredNorm();
    names.push_back(fmt::format("rotation about the axis along {} through ({:.4g}, {:.4g}, {:.4g}) m",
                                direction_name(axis), clean(point[0]), clean(point[1]), clean(point[2])));
  }
  return names;
}

}  // namespace brachium::fem
