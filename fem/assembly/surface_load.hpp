#pragma once
/// Forces of a loaded surface by dof: tractions fixed in direction, and pressure that follows the deformed
/// surface.
///
/// | symbol   | meaning                                                                         | unit |
/// |----------|---------------------------------------------------------------------------------|------|
/// | X, x     | reference and deformed position of the surface, Σ N_a(r, s) X_a                 | m    |
/// | t        | force per reference area                                                        | Pa   |
/// | p        | pressure on the deformed surface, against its outward normal x,r × x,s          | Pa   |
///
///   dead      f_a = ∫ N_a t |X,r × X,s| dr ds
///   follower  f_a = -p ∫ N_a x,r × x,s dr ds
///             ∂f_a/∂u_b = -p ∫ N_a (N_b,s [x,r]× - N_b,r [x,s]×) dr ds
/// (Bonet & Wood 2008, doi:10.1017/CBO9780511755446, section 8.5.2). The tangent is symmetric over a surface
/// that is closed, or whose edge cannot move.

#include <Eigen/Core>
#include <string>
#include <vector>

#include "fem/assembly/discretisation.hpp"

namespace brachium::fem {

/// Tangent of one face: ∂f/∂u over its nodes' three components, 3 m x 3 m (node-major).
struct FaceTangent {
  std::vector<int> nodes;
  Eigen::MatrixXd values;
};

class LoadedSurface {
 public:
  /// Throws InputError("missing-surface") with the nearest name.
  LoadedSurface(const Discretisation& discretisation, const std::string& surface);

  double reference_area() const { return area_; }  ///< m2
  int face_count() const { return static_cast<int>(faces_.cols()); }

  /// force += the dead traction's [Pa]; force by dof [N].
  void add_traction(const Eigen::Vector3d& traction_pa, Eigen::VectorXd& force) const;

  /// force += the pressure's at the positions X + u; dofs by dof [m].
  void add_pressure(double pressure_pa, const Eigen::VectorXd& dofs, Eigen::VectorXd& force) const;

  /// ∂(force of the pressure)/∂u, face by face.
  std::vector<FaceTangent> pressure_tangent(double pressure_pa, const Eigen::VectorXd& dofs) const;

 private:
  const Discretisation* discretisation_;
  Eigen::MatrixXi faces_;                    ///< nodes per face x faces
  std::vector<Eigen::VectorXd> value_;       ///< N by quadrature point
  std::vector<Eigen::MatrixXd> derivative_;  ///< N,r N,s by quadrature point
  Eigen::VectorXd weight_;
  double area_ = 0.0;

  Eigen::Matrix3Xd reference(int face) const;
  Eigen::Matrix3Xd deformed(int face, const Eigen::VectorXd& dofs) const;
};

/// force += ∫ N_a b dV for a force per reference volume b [N/m3]: one column, or one per quadrature point (q
/// + n_q c).
void add_body_force(const Discretisation& discretisation, const Eigen::Matrix3Xd& force_n_m3,
                    double amplitude, Eigen::VectorXd& force);

}  // namespace brachium::fem
