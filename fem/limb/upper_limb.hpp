#pragma once
/// The scene: an elbow hinge, a rigid humerus, biceps and triceps.

#include <vector>

#include "fem/limb/muscle_states.hpp"

namespace brachium::fem {

/// The arm's frame is that of fem/limb/cable_path.hpp: the hinge is z through the origin of coordinates.
struct UpperLimb {
  Hinge hinge;
  std::vector<Bone> humerus;  ///< shaft, distal end, ...
  MuscleBody biceps, triceps;
  AngleRange range;
  double max_stress_pa = 0.3e6;
};

/// How finely the generic arm is meshed.
struct LimbMesh {
  int belly_cells = 8;
  int core_cells = 1;
  int ring_cells = 1;
};

/// A documented arm of middle size. The geometry that the published figures were made with comes from the
/// Visible Human data and is not public; this one is chosen so that its tendon paths have lever arms near the
/// published polynomials (fem/limb/published.hpp), and so that the fibres pass the optimal stretch near the
/// angles at which the published active forces peak (biceps 51 deg, triceps 118 deg). Every figure and its
/// reason: fem/limb/README.md.
UpperLimb generic_arm(const LimbMesh& mesh = {});

}  // namespace brachium::fem
