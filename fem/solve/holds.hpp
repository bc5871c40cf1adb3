#pragma once
/// What a problem's conditions ask of single nodes: linear conditions  d . u = value(amplitude),  d a unit
/// vector.

#include <Eigen/Core>
#include <string>
#include <vector>

#include "fem/solve/problem.hpp"

namespace brachium::fem {

/// One condition on one node.
struct Hold {
  int condition = 0;  ///< index into Problem::conditions
  int node = 0;
  int column = 0;             ///< of the node among the condition's points
  Eigen::Vector3d direction;  ///< unit
};

/// Holds displacements, as opposed to loading.
bool is_constraint(const BoundaryCondition& condition);
/// A rigid motion without a surface: it moves the rigid bodies that are in contact with the muscle, and no
/// node.
bool moves_bodies_only(const BoundaryCondition& condition);
/// Moves with an amplitude of the programme.
bool has_amplitude(const BoundaryCondition& condition);

/// Points of a surface or node set, sorted. Throws InputError("missing-surface") with the nearest name of
/// both.
std::vector<int> condition_points(const data::Mesh& mesh, const std::string& surface);
/// Throws InputError("missing-surface") when there is no such surface; says so when it is a node set.
void check_has_faces(const data::Mesh& mesh, const std::string& surface);

/// Unit normal of a plane set of points. Throws InputError("surface-not-plane") naming the largest distance.
/// Normals within 1e-9 of an axis are that axis.
Eigen::Vector3d plane_normal(const data::Mesh& mesh, const std::string& surface);

/// Empty for loads.
std::vector<Hold> holds_of(const Problem& problem, int condition);

/// Displacement [m] along the hold's direction at an amplitude.
double held_value(const Problem& problem, const Hold& hold, double amplitude);

}  // namespace brachium::fem
