#pragma once
/// A muscle's body as a mesh of its own (segmented anatomy) instead of a spindle.
///
/// Own coordinates: the origin's centroid is 0, z runs distally along the stress-free axis, x across the plane
/// of motion.
///
/// | from        | what the mesh shows                       | the axis is                                    |
/// |-------------|-------------------------------------------|------------------------------------------------|
/// | stress-free | the muscle that nothing pulls, anywhere   | the line between the centroids of its ends     |
/// | in situ     | the muscle in the arm at q_0, passive     | the path's tangent at the distal end           |

#include <memory>
#include <string>
#include <vector>

#include "data/model/mesh.hpp"

namespace brachium::fem {

struct MuscleBody;

struct BodyShape {
  /// Surfaces origin, insertion and side; where `MuscleBody::fibres` asks for it, the field `fibre`.
  std::shared_ptr<const data::Mesh> mesh;
  double length_m = 0.0;           ///< along the path: what belly_length_m is 1 of
  double greatest_radius_m = 0.0;  ///< of the profile: what its greatest radius is 1 of
  double reach_m = 0.0;            ///< greatest distance of a point from the axis
  Eigen::Vector3d insertion_m = Eigen::Vector3d::Zero();  ///< centroid, own coordinates
  std::vector<std::string> tendons;                       ///< regions with gamma_M = 0
  double origin_across_m = 0.0;  ///< of the origin in situ, out of the plane of motion
  /// From the path to the insertion's centroid in situ, the arm's frame: turns with the end.
  Eigen::Vector3d beside_path_m = Eigen::Vector3d::Zero();
};

/// points -> A x + b; of the field `fibre` the directions.
void move(data::Mesh& mesh, const Eigen::Matrix3d& A, const Eigen::Vector3d& b);

/// The body with a stress-free mesh: its belly's length and profile are then the mesh's; path, pre-stretch and
/// material stay. Throws InputError("missing-surface"), ("missing-region"), ("limb-geometry"), and as Discretisation does.
MuscleBody with_stress_free_shape(MuscleBody body, data::Mesh mesh, std::vector<std::string> tendons = {});

/// The body with a first guess of the stress-free shape of a mesh in situ: shrunk along the line between its
/// ends by the pre-stretch, widened across to keep the volume, ends as they are. The origin is the mesh's. Throws also
/// InputError("in-situ-shape") where the distal end lies beside the path by more than a twentieth of the
/// muscle's length. `fem::find_stress_free` (fem/limb/in_situ.hpp) finds the shape itself.
MuscleBody with_in_situ_guess(MuscleBody body, const data::Mesh& in_situ,
                              std::vector<std::string> tendons = {});

}  // namespace brachium::fem
