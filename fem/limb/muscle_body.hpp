#pragma once
/// One continuum muscle over a hinge, as parameters; its mesh, its tissue and the motions of its two ends.
///
/// The body is a spindle: belly, with meshed tendons where their length is not 0 (the muscle-tendon complex),
/// without them the rigid-tendon variant; or an imported mesh (fem/limb/body_shape.hpp). Its proximal end is fixed to the humerus. Its distal end sits on an
/// inextensible tendon (fem/limb/cable_path.hpp) that leads to the forearm: the end's centre stays at the
/// cable's length from the insertion along the path, its face stays normal to the path.
///
/// | symbol | identifier         | unit | meaning                                                |
/// |--------|--------------------|------|--------------------------------------------------------|
/// | q      | q_rad              | rad  | elbow flexion                                          |
/// | q_0    | reference_rad      | rad  | the end of the range at which the muscle is shortest   |
/// | L_0    | stress_free_length | m    | of belly and meshed tendons                            |
/// | s      | pre_stretch        | 1    | length between the ends at q_0 over L_0                |
/// | L_c    | cable_length       | m    | L_path(q_0) - s L_0                                    |
///
/// Motions by amplitude a: in a = 0 ... 1 both ends go from the stress-free place (beside the bone by
/// `standoff_m`) to the in-situ place at q_0; then a = 1 + |q - q_0|.

#include <string>
#include <vector>

#include "fem/fibre/tissue.hpp"
#include "fem/limb/body_shape.hpp"
#include "fem/limb/cable_path.hpp"
#include "fem/mesh/cylinder.hpp"
#include "fem/solve/problem.hpp"

namespace brachium::fem {

/// Sheets of tendon tissue on the belly's surface that go on where the tendons end; 0 thick: none. They take
/// the place of a transition.
struct Aponeurosis {
  double thickness_norm = 0.0;  ///< over the local radius
  int cells = 1;                ///< through a sheet
  double origin_norm = 0.5;     ///< share of the belly's length that each covers
  double insertion_norm = 0.5;
};

struct MuscleBody {
  std::string name;
  CableGeometry cable;
  double belly_length_m = 0.0;      ///< stress-free
  std::vector<double> profile_m;    ///< radii at even places from the proximal to the distal end, at least 3
  double flatness = 1.0;            ///< radius in the plane of motion / radius across it
  double tendon_origin_m = 0.0;     ///< meshed; 0: rigid
  double tendon_insertion_m = 0.0;  ///< meshed; 0: rigid
  double transition_m = 0.0;        ///< length over which gamma_M rises beside meshed tendons
  Aponeurosis aponeurosis;
  /// Instead of the spindle, stretched to `belly_length_m` along and to the profile's greatest radius across;
  /// null: the spindle.
  std::shared_ptr<const BodyShape> shape;
  double pre_stretch = 1.0;
  double reference_rad = 0.0;
  double standoff_m = 0.0;  ///< of the stress-free body from its in-situ line, away from the humerus
  int belly_cells = 10, tendon_cells = 2;
  RoundSection section;
  std::string fibres =
      "harmonic";  ///< "harmonic", or the mesh's field: "mesh_lines", "mesh_field" (imported)
  Formulation formulation = Formulation::q2_p1_discontinuous;
  MuscleTendon material;
  double bulk_modulus_pa = 0.0;  ///< infinity: incompressible, augmented Lagrange

  double stress_free_length_m() const { return tendon_origin_m + belly_length_m + tendon_insertion_m; }
  double cable_length_m() const;  ///< L_c
};

/// The muscle-tendon complex of a rigid-tendon muscle: ends of the rigid tendon meshed, their slack the
/// length they are given, so that the belly is as long in situ as before.
MuscleBody with_tendons(MuscleBody body, double origin_m, double insertion_m);

/// Unit vector away from the humerus on the side of the path.
Eigen::Vector3d outward(const MuscleBody& body);

/// The stress-free axis, beside the bone: begins at `from_m`, runs along `along` (distally); `frame` turns the
/// body's coordinates (x across the plane of motion, z along) into the arm's.
struct StressFreeAxis {
  Eigen::Vector3d from_m, along;
  Eigen::Matrix3d frame;
};
StressFreeAxis stress_free_axis(const MuscleBody& body);

/// Angles that a muscle is built for.
struct AngleRange {
  double lower_rad = 0.0, upper_rad = 0.0;
};

/// Throws InputError("limb-geometry") with parameter, value and allowed range; the path is tried over the
/// whole range.
void check(const MuscleBody& body, const AngleRange& range);

/// A muscle ready to be solved: mesh, tissue, two conditions `origin` and `insertion`, no contact, no
/// programme.
struct BuiltMuscle {
  Problem problem;
  data::Table directions, harmonic;  ///< figures of the fibres, for the log
};
BuiltMuscle build(const MuscleBody& body, const AngleRange& range);
/// The same of a stress-free mesh of its own, with the surfaces and fields of the other's; its ends must lie
/// where the other's do (fem/solve/stress_free.hpp finds one from a shape in situ).
BuiltMuscle build(const MuscleBody& body, const AngleRange& range,
                  std::shared_ptr<const data::Mesh> stress_free);

/// Both ends from the stress-free place to the in-situ place at the reference angle, passive.
Phase in_situ_phase(int steps);

/// Amplitude of both conditions at an angle.
double amplitude(const MuscleBody& body, double q_rad);

/// In-situ place of the distal end: centre, and the angle that its face has turned by since q_0, about +z.
struct EndPlace {
  Eigen::Vector3d centre_m;
  Eigen::Vector3d pull;  ///< unit tangent of the path, towards the origin
  double turn_rad = 0.0;
};
EndPlace end_place(const MuscleBody& body, double q_rad);

}  // namespace brachium::fem
