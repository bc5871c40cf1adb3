#pragma once
/// A quasi-static boundary-value problem as plain values: what a user can ask of the solver. Const once
/// built.

#include <Eigen/Core>
#include <array>
#include <limits>
#include <map>
#include <memory>
#include <string>
#include <variant>
#include <vector>

#include "data/model/mesh.hpp"
#include "fem/contact/contact.hpp"
#include "fem/fibre/field.hpp"
#include "fem/formulation.hpp"
#include "fem/material/material.hpp"

namespace brachium::fem {

// ---------------------------------------------------------------- boundary conditions
// Each has a name, a surface of the mesh (or a node set), and an amplitude that the programme's phases move;
// what is given here is its value at amplitude 1. Conditions that only fix things have no amplitude.

/// u = 0 in the chosen components.
struct Fixed {
  std::array<bool, 3> components{true, true, true};
};

/// u_i = amplitude * value_i; a component that is NaN is left free.
struct PrescribedDisplacement {
  Eigen::Vector3d displacement_m = Eigen::Vector3d::Constant(std::numeric_limits<double>::quiet_NaN());
};

/// u = amplitude * value, point by point: measured surfaces, and fields known in closed form.
struct PrescribedField {
  Eigen::Matrix3Xd
      displacement_m;  ///< 3 x n, columns in the order of Mesh::surface_points; NaN leaves a component free
};

/// x = centre + R (X - centre) + amplitude * translation, R = rotation about `axis` by amplitude * angle.
/// With an empty surface it moves no node, only the rigid bodies of contacts that move with it.
struct RigidMotion {
  Eigen::Vector3d translation_m = Eigen::Vector3d::Zero();
  Eigen::Vector3d centre_m = Eigen::Vector3d::Zero();
  Eigen::Vector3d axis = Eigen::Vector3d::UnitZ();
  double angle_rad = 0.0;
};

/// A rigid motion along places that are listed: x = place(a) + R(angle(a)) (X - centre), R about `axis`.
/// Between the amplitudes listed, place and angle are cubic (Hermite, slopes of the parabola through three
/// neighbours); beyond the ends they stay. The first amplitude is 0, at which the body is where the mesh has
/// it: place = centre, angle = 0.
struct GuidedMotion {
  Eigen::Vector3d centre_m = Eigen::Vector3d::Zero();
  Eigen::Vector3d axis = Eigen::Vector3d::UnitZ();
  Eigen::VectorXd amplitude;  ///< n >= 2, rising, the first 0
  Eigen::Matrix3Xd place_m;   ///< 3 x n
  Eigen::VectorXd angle_rad;  ///< n
};

/// No displacement along the plane's normal; the surface must be plane (its normal is found, any direction).
struct SymmetryPlane {};

/// Force per reference area, fixed in direction; or a total force spread evenly over the reference area.
struct DeadTraction {
  Eigen::Vector3d traction_pa = Eigen::Vector3d::Zero();
  bool is_total_force = false;  ///< then traction_pa is a force [N]
};

/// Pressure on the deformed surface, against its outward normal. A surface with a free edge has no potential:
/// the tangent is then unsymmetric.
struct FollowerPressure {
  double pressure_pa = 0.0;
};

/// Force per reference volume, fixed in direction (weight; sources of manufactured solutions). Acts on the
/// whole body: its `surface` is empty.
struct BodyForce {
  Eigen::Matrix3Xd
      force_n_m3;  ///< one column: uniform; or one per quadrature point, columns as in TissueField
};

struct BoundaryCondition {
  std::string name;     ///< unique
  std::string surface;  ///< surface or node set of the mesh; empty for a body force
  std::variant<Fixed, PrescribedDisplacement, PrescribedField, RigidMotion, GuidedMotion, SymmetryPlane,
               DeadTraction, FollowerPressure, BodyForce>
      kind;
};

// ---------------------------------------------------------------- load programme

/// One phase: amplitudes and activations move linearly from where they stand to the values given here.
struct Phase {
  std::string name;
  std::map<std::string, double> amplitude;  ///< by boundary condition, at the phase's end; others keep theirs
  std::map<std::string, double> activation;  ///< by region, in [0, 1], at the phase's end; others keep theirs
  std::vector<std::string> release;  ///< constraints that fade: their reactions go to zero over the phase
  int steps = 1;                     ///< load steps to begin with; more where needed
  double duration_s = 1.0;           ///< time scale, used by rate-dependent laws only
};

// ---------------------------------------------------------------- the whole

struct Problem {
  std::shared_ptr<const data::Mesh> mesh;
  Formulation formulation = Formulation::q2_p1_discontinuous;
  std::vector<RegionMaterial> materials;  ///< one per region of the mesh, in its order
  TissueField tissue;                     ///< fibres and blending at the cells' quadrature points
  std::vector<BoundaryCondition> conditions;
  std::vector<Contact> contacts;  ///< with rigid bodies
  std::vector<Phase> programme;
};

/// Everything that is wrong with a problem, before anything is solved; empty when sound. Codes:
/// missing-surface, unknown-region, contradictory-conditions, activation-range, empty-phase, missing-fibres,
/// unsupported-motion (named rigid modes), cell-type-mismatch, disconnected-mesh, ...
std::vector<data::Diagnostic> check(const Problem& problem);

}  // namespace brachium::fem
