#pragma once
/// The inverse problem of a limb: a muscle's stress-free shape from its shape in the arm, contact included.

#include <functional>

#include "fem/limb/muscle_states.hpp"
#include "fem/solve/stress_free.hpp"

namespace brachium::fem {

struct InSituReport {
  int equilibria = 0;
  double greatest_error_m = 0.0;  ///< of a point, from its place in situ
  double beside_path_m = 0.0;     ///< of the distal end's centroid, in the plane of motion
};

/// `in_situ`: the mesh in the arm's frame at body.reference_rad, passive. Path, pre-stretch and material are the
/// body's; nothing but the pre-stretch says how far the ends were pulled. Throws as `with_in_situ_guess`, and
/// ConvergenceFailure naming muscle and iteration.
MuscleBody find_stress_free(const MuscleBody& body, const data::Mesh& in_situ,
                            std::vector<std::string> tendons, const AngleRange& range, const Hinge& hinge,
                            const std::vector<Bone>& bones, const SolvedMuscleOptions& options,
                            InSituReport* report = nullptr);

}  // namespace brachium::fem
