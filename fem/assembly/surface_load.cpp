#include "fem/assembly/surface_load.hpp"

#include <Eigen/Geometry>

#include "fem/element/shape.hpp"

namespace brachium::fem {
namespace {

Eigen::Matrix3d cross_matrix(const Eigen::Vector3d& v) {
  Eigen::Matrix3d m;
  m << 0.0, -v[2], v[1], v[2], 0.0, -v[0], -v[1], v[0], 0.0;
  return m;
}

}  // namespace

LoadedSurface::LoadedSurface(const Discretisation& discretisation, const std::string& surface)
    : discretisation_(&discretisation) {
  const data::Mesh& mesh = discretisation.mesh();
  const data::NamedSurface& named = mesh.surface(surface);
  const auto count = static_cast<Eigen::Index>(named.faces.size());
  const auto nodes = static_cast<Eigen::Index>(data::face_nodes(mesh.type, 0).size());
  faces_.resize(nodes, count);
  for (Eigen::Index f = 0; f < count; ++f) {
    const data::CellFace& face = named.faces[static_cast<std::size_t>(f)];
    const auto local = data::face_nodes(mesh.type, face.face);
    for (Eigen::Index a = 0; a < nodes; ++a)
      faces_(a, f) = mesh.cells(local[static_cast<std::size_t>(a)], face.cell);
  }
  const Quadrature& rule = face_quadrature(mesh.type);
  weight_ = rule.weights;
  for (Eigen::Index q = 0; q < rule.points.cols(); ++q) {
    Shape shape = face_shape(mesh.type, rule.points.col(q));
    value_.push_back(std::move(shape.value));
    derivative_.push_back(std::move(shape.derivative));
  }
  for (int f = 0; f < face_count(); ++f) {
    const Eigen::Matrix3Xd X = reference(f);
    for (std::size_t q = 0; q < value_.size(); ++q) {
      const Eigen::Matrix<double, 3, 2> T = X * derivative_[q];
      area_ += weight_[static_cast<Eigen::Index>(q)] * T.col(0).cross(T.col(1)).norm();
    }
  }
}

Eigen::Matrix3Xd LoadedSurface::reference(int face) const {
  Eigen::Matrix3Xd X(3, faces_.rows());
  for (Eigen::Index a = 0; a < faces_.rows(); ++a)
    X.col(a) = discretisation_->mesh().points.col(faces_(a, face));
  return X;
}

Eigen::Matrix3Xd LoadedSurface::deformed(int face, const Eigen::VectorXd& dofs) const {
  Eigen::Matrix3Xd x = reference(face);
  for (Eigen::Index a = 0; a < faces_.rows(); ++a) x.col(a) += dofs.segment<3>(3 * faces_(a, face));
  return x;
}

void LoadedSurface::add_traction(const Eigen::Vector3d& traction_pa, Eigen::VectorXd& force) const {
  for (int f = 0; f < face_count(); ++f) {
    const Eigen::Matrix3Xd X = reference(f);
    for (std::size_t q = 0; q < value_.size(); ++q) {
      const Eigen::Matrix<double, 3, 2> T = X * derivative_[q];
      const double area = weight_[static_cast<Eigen::Index>(q)] * T.col(0).cross(T.col(1)).norm();
      for (Eigen::Index a = 0; a < faces_.rows(); ++a) {
        force.segment<3>(3 * faces_(a, f)) += (value_[q][a] * area) * traction_pa;
      }
    }
  }
}

void LoadedSurface::add_pressure(double pressure_pa, const Eigen::VectorXd& dofs,
                                 Eigen::VectorXd& force) const {
  for (int f = 0; f < face_count(); ++f) {
    const Eigen::Matrix3Xd x = deformed(f, dofs);
    for (std::size_t q = 0; q < value_.size(); ++q) {
      const Eigen::Matrix<double, 3, 2> t = x * derivative_[q];
      const Eigen::Vector3d normal = weight_[static_cast<Eigen::Index>(q)] * t.col(0).cross(t.col(1));
      for (Eigen::Index a = 0; a < faces_.rows(); ++a) {
        force.segment<3>(3 * faces_(a, f)) -= (pressure_pa * value_[q][a]) * normal;
      }
    }
  }
}

std::vector<FaceTangent> LoadedSurface::pressure_tangent(double pressure_pa,
                                                         const Eigen::VectorXd& dofs) const {
  const Eigen::Index m = faces_.rows();
  std::vector<FaceTangent> tangents(static_cast<std::size_t>(face_count()));
  for (int f = 0; f < face_count(); ++f) {
    FaceTangent& tangent = tangents[static_cast<std::size_t>(f)];
    tangent.values.setZero(3 * m, 3 * m);
    for (Eigen::Index a = 0; a < m; ++a) tangent.nodes.push_back(faces_(a, f));
    const Eigen::Matrix3Xd x = deformed(f, dofs);
    for (std::size_t q = 0; q < value_.size(); ++q) {
      const Eigen::Matrix<double, 3, 2> t = x * derivative_[q];
      const double w = pressure_pa * weight_[static_cast<Eigen::Index>(q)];
      const Eigen::Matrix3d along_r = cross_matrix(t.col(0)), along_s = cross_matrix(t.col(1));
      for (Eigen::Index b = 0; b < m; ++b) {
        const Eigen::Matrix3d turned = derivative_[q](b, 1) * along_r - derivative_[q](b, 0) * along_s;
        for (Eigen::Index a = 0; a < m; ++a)
          tangent.values.block<3, 3>(3 * a, 3 * b) -= (w * value_[q][a]) * turned;
      }
    }
  }
  return tangents;
}

void add_body_force(const Discretisation& discretisation, const Eigen::Matrix3Xd& force_n_m3,
                    double amplitude, Eigen::VectorXd& force) {
  const Quadrature& rule = discretisation.quadrature();
  const Eigen::MatrixXi& nodes = discretisation.nodes_of_cell();
  const data::CellType type = discretisation.mesh().type;
  std::vector<Eigen::VectorXd> value;
  for (int q = 0; q < rule.size(); ++q) {
    Eigen::VectorXd N(nodes.rows());
    const Shape shape = cell_shape(type, rule.points.col(q));
    N.head(shape.value.size()) = shape.value;
    if (nodes.rows() > shape.value.size()) N.tail<1>() = bubble_shape(rule.points.col(q)).value;
    value.push_back(std::move(N));
  }
  Eigen::MatrixX3d gradient;
  for (int c = 0; c < discretisation.cell_count(); ++c) {
    for (int q = 0; q < rule.size(); ++q) {
      double weight = 0.0;
      discretisation.reference_gradients(c, q, gradient, weight);
      const Eigen::Index column = force_n_m3.cols() == 1 ? 0 : q + static_cast<Eigen::Index>(rule.size()) * c;
      const Eigen::Vector3d b = (amplitude * weight) * force_n_m3.col(column);
      const Eigen::VectorXd& N = value[static_cast<std::size_t>(q)];
      for (Eigen::Index a = 0; a < nodes.rows(); ++a) force.segment<3>(3 * nodes(a, c)) += N[a] * b;
    }
  }
}

}  // namespace brachium::fem
