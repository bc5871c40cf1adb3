#pragma once
/// Rigid-body mechanics of a planar chain of hinges with parallel axes: an elbow is n = 1.
///
/// | symbol | identifier    | unit   | meaning                                                                |
/// |--------|---------------|--------|------------------------------------------------------------------------|
/// | q      | q             | rad    | hinge angles, flexion positive, 0 = straight (n)                       |
/// | phi_i  | -             | rad    | inclination of link i from straight down, phi_i = phi_0 + q_1 + .. + q_i |
/// | u(phi) | -             | 1      | direction of a link, (sin phi, -cos phi) in (forward, up)              |
/// | k_i    | -             | kg m   | S_i + L_i sum_{j>i} m_j: first moment of link i and all it carries     |
/// | A_ij   | -             | kg m^2 | A_ii = I_i + L_i^2 sum_{j>i} m_j;  A_ij = L_i k_j for i < j            |
/// | M      | moment        | N m    | moments that muscles exert at the hinges, flexion positive (n)         |
/// | g      | gravity       | m/s^2  | acceleration of free fall as a vector, (0, -9.80665)                   |
///
/// Lagrange's equations in the inclinations (a standard result, e.g. Murray, Li & Sastry 1994, ch. 4):
///   sum_j A_ij cos(phi_i - phi_j) phi_j'' + A_ij sin(phi_i - phi_j) phi_j'^2 - k_i (g - a_0) . u'(phi_i) = Q_i,
/// with the acceleration a_0 of the first hinge and Q_i = M_i - M_{i+1}; hence M_i = sum_{j>=i} of the left sides.

#include <Eigen/Core>
#include <cstddef>
#include <map>
#include <string>
#include <vector>

#include "data/limb/bodies.hpp"
#include "data/model/scene.hpp"

namespace brachium::limb {

/// One rigid link with all that hangs on it.
struct Link {
  BodySet bodies;
  double length_m = 0.0;  ///< to the next hinge; not used on the last link
};

/// How the body to which the first hinge is fixed moves (the upper arm, for an elbow).
struct BaseMotion {
  double inclination_rad = 0.0;  ///< phi_0, from straight down
  double rate_rad_per_s = 0.0;
  double acceleration_rad_per_s2 = 0.0;
  Eigen::Vector2d hinge_acceleration_m_per_s2{0.0, 0.0};  ///< a_0 (forward, up)
};

/// A force at a point of a link, constant in space.
struct PointForce {
  std::size_t link = 0;
  double distance_m = 0.0;            ///< from the link's hinge
  Eigen::Vector2d force_N{0.0, 0.0};  ///< (forward, up)
};

/// Const, and safe to call from several threads. All vectors have size() entries, else
/// InputError("wrong-size"); entries that are not finite give InputError("not-finite").
class PlanarChain {
 public:
  /// Throws InputError("out-of-range") for a link without mass or a length that is not positive where one is
  /// needed.
  explicit PlanarChain(std::vector<Link> links,
                       Eigen::Vector2d gravity_m_per_s2 = {0.0, -standard_gravity_m_per_s2});

  std::size_t size() const { return links_.size(); }
  const std::vector<Link>& links() const { return links_; }

  Eigen::MatrixXd mass_matrix(const Eigen::VectorXd& q) const;
  /// Moment of gravity about each hinge, flexion positive (an external moment, as conventions have it).
  Eigen::VectorXd gravity_moment(const Eigen::VectorXd& q, const BaseMotion& base = {}) const;
  /// Its derivative with respect to q (n x n, symmetric).
  Eigen::MatrixXd gravity_stiffness(const Eigen::VectorXd& q, const BaseMotion& base = {}) const;
  /// Moment of forces on the links about each hinge, flexion positive.
  Eigen::VectorXd force_moment(const Eigen::VectorXd& q, const std::vector<PointForce>& forces,
                               const BaseMotion& base = {}) const;

  /// Muscle moments that a motion needs, given what else acts.
  Eigen::VectorXd inverse_dynamics(const Eigen::VectorXd& q, const Eigen::VectorXd& qdot,
                                   const Eigen::VectorXd& qddot, const BaseMotion& base = {},
                                   const std::vector<PointForce>& forces = {}) const;
  /// Accelerations that muscle moments bring about: M(q) q'' = moment - bias.
  Eigen::VectorXd forward_dynamics(const Eigen::VectorXd& q, const Eigen::VectorXd& qdot,
                                   const Eigen::VectorXd& moment, const BaseMotion& base = {},
                                   const std::vector<PointForce>& forces = {}) const;

  double kinetic_energy_J(const Eigen::VectorXd& q, const Eigen::VectorXd& qdot) const;  ///< base at rest
  double potential_energy_J(const Eigen::VectorXd& q,
                            const BaseMotion& base = {}) const;  ///< 0 with all links' mass at the hinge

 private:
  void check(const Eigen::VectorXd& v, const char* what) const;
  Eigen::VectorXd inclinations(const Eigen::VectorXd& q, double base) const;

  std::vector<Link> links_;
  Eigen::Vector2d gravity_;
  Eigen::VectorXd k_;
  Eigen::MatrixXd a_;
};

/// The scene's hinges as a chain, proximal first; for an elbow alone, one link. `conditions` as in bodies_of.
/// Throws InputError("not-a-chain") where hinges branch.
PlanarChain chain_of(const data::Scene& scene, const std::map<std::string, double>& conditions = {},
                     const std::string& trial = {});

}  // namespace brachium::limb
