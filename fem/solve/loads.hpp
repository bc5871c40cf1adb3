#pragma once
/// External forces of a problem by dof, and the tangent of those that follow the body.

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "fem/assembly/surface_load.hpp"
#include "fem/solve/problem.hpp"

namespace brachium::fem {

class Loads {
 public:
  Loads(const Problem& problem, const Discretisation& discretisation);

  /// Sum of all loads at the amplitudes (by condition) and displacements; by dof, global axes [N].
  Eigen::VectorXd force(const Eigen::VectorXd& amplitude, const Eigen::VectorXd& dofs) const;

  bool has_pressure() const;

  /// ∂force/∂u of the follower pressures, face by face; empty where their amplitudes are zero.
  std::vector<FaceTangent> tangent(const Eigen::VectorXd& amplitude, const Eigen::VectorXd& dofs) const;

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
};

}  // namespace brachium::fem
