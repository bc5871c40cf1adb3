#pragma once
/// A contact as a problem states it, and all contacts of a problem at work.

#include <Eigen/Core>
#include <string>
#include <vector>

#include "fem/contact/contact_surface.hpp"

namespace brachium::fem {

struct Problem;

/// Frictionless contact of a surface of the mesh with a rigid body.
struct Contact {
  std::string name;     ///< unique
  std::string surface;  ///< of the mesh
  RigidShape body;
  std::string moves_with;  ///< name of a RigidMotion condition whose motion the body shares; empty: it rests
  double penalty_pa_per_m =
      0.0;                   ///< 0: chosen from the materials, ten times their stiffness over a cell's size
  double smoothing_m = 0.0;  ///< width over which contact sets in; 0: at once
  double penetration_tolerance_m = 0.0;  ///< 0: whatever the penalty leaves; else multipliers bring it below
  int points_per_direction = 4;
};

/// Contacts of a problem; vectors of multipliers hold all points of the first contact, then of the next.
class Contacts {
 public:
  /// `stiffness_pa` and `cell_size_m` scale penalties that are not given. Throws as ContactSurface does, and
  /// InputError("unknown-condition") where `moves_with` names no RigidMotion.
  Contacts(const Problem& problem, const Discretisation& discretisation, double stiffness_pa,
           double cell_size_m);

  bool empty() const { return contacts_.empty(); }
  int point_count() const { return points_; }

  /// force += of all contacts at the amplitudes (by condition).
  void add_force(const Eigen::VectorXd& amplitude, const Eigen::VectorXd& dofs,
                 const Eigen::VectorXd& multiplier_pa, Eigen::VectorXd& force) const;
  void append_tangents(const Eigen::VectorXd& amplitude, const Eigen::VectorXd& dofs,
                       const Eigen::VectorXd& multiplier_pa, std::vector<FaceTangent>& tangents) const;

  /// Pressures at all points: the next multipliers.
  Eigen::VectorXd pressures(const Eigen::VectorXd& amplitude, const Eigen::VectorXd& dofs,
                            const Eigen::VectorXd& multiplier_pa) const;

  /// Largest penetration over its contact's tolerance; 0 where no contact has one. Above 1, multipliers are
  /// not done.
  double penetration_ratio(const Eigen::VectorXd& amplitude, const Eigen::VectorXd& dofs,
                           const Eigen::VectorXd& multiplier_pa) const;

  /// Sums by contact, in the problem's order.
  std::vector<ContactSums> sums(const Eigen::VectorXd& amplitude, const Eigen::VectorXd& dofs,
                                const Eigen::VectorXd& multiplier_pa) const;
  /// Points of one contact.
  ContactPoints points(int contact, const Eigen::VectorXd& amplitude, const Eigen::VectorXd& dofs,
                       const Eigen::VectorXd& multiplier_pa) const;
  double penalty_pa_per_m(int contact) const {
    return contacts_[static_cast<std::size_t>(contact)].penalty_pa_per_m;
  }

 private:
  struct Entry {
    ContactSurface surface;
    int moving_condition;  ///< -1: at rest
    double tolerance_m, penalty_pa_per_m;
    int first_point;
  };
  const Problem* problem_;
  std::vector<Entry> contacts_;
  int points_ = 0;

  Pose pose(const Entry& entry, const Eigen::VectorXd& amplitude) const;
  Eigen::VectorXd part(const Entry& entry, const Eigen::VectorXd& multiplier_pa) const;
};

}  // namespace brachium::fem
