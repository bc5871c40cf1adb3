#pragma once
/// External forces of a problem by dof, contact among them, and the tangent of those that depend on the displacement.

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "fem/assembly/assembly.hpp"
#include "fem/assembly/surface_load.hpp"
#include "fem/solve/problem.hpp"

namespace brachium::fem {

class Loads {
 public:
  /// `stiffness_pa` and `cell_size_m` scale contact penalties that are not given.
  Loads(const Problem& problem, const Discretisation& discretisation, double stiffness_pa,
        double cell_size_m);

  /// Sum of all loads at the amplitudes (by condition) and displacements; by dof, global axes [N].
  Eigen::VectorXd force(const Eigen::VectorXd& amplitude, const Configuration& configuration) const;

  bool has_pressure() const;
  const Contacts& contacts() const { return contacts_; }

  /// ∂force/∂u of follower pressures and contacts, face by face; empty where nothing presses.
  std::vector<FaceTangent> tangent(const Eigen::VectorXd& amplitude,
                                   const Configuration& configuration) const;

 private:
  struct Dead {
    int condition;
    Eigen::VectorXd force;  ///< at amplitude 1
  };
  struct Pressure {
    int condition;
    double pressure_pa;
    LoadedSurface surface;
  };
  int dof_count_;
  std::vector<Dead> dead_;
  std::vector<Pressure> pressures_;
  Contacts contacts_;
};

}  // namespace brachium::fem
