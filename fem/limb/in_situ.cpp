#include "fem/limb/in_situ.hpp"

#include <fmt/format.h>

namespace brachium::fem {

MuscleBody find_stress_free(const MuscleBody& body, const data::Mesh& in_situ,
                            std::vector<std::string> tendons, const AngleRange& range, const Hinge& hinge,
                            const std::vector<Bone>& bones, const SolvedMuscleOptions& options,
                            InSituReport* report) {
  const MuscleBody guess = with_in_situ_guess(body, in_situ, std::move(tendons));
  // Which bones are touched, and how, is decided as for any muscle.
  const MuscleStates states(guess, range, hinge, bones, options);
  const Problem& pattern = states.problem();
  StressFreeOptions inverse;
  inverse.solve = options.solve;
  inverse.solve.relative_residual = std::min(inverse.solve.relative_residual, 1e-9);
  const auto make = [&](std::shared_ptr<const data::Mesh> mesh) {
    Problem problem = build(guess, range, std::move(mesh)).problem;
    problem.contacts = pattern.contacts;
    problem.programme = {in_situ_phase(4)};
    return problem;
  };
  StressFreeShape found = stress_free_shape(in_situ.points, *pattern.mesh, make, inverse);
  if (!found.converged)
    throw data::ConvergenceFailure({body.name + ": stress-free shape from the shape in situ", found.reason,
                                    static_cast<int>(found.error_m.size()),
                                    found.error_m.empty() ? 0.0 : found.error_m.back(), inverse.tolerance_m,
                                    body.name});
  const StressFreeAxis axis = stress_free_axis(guess);
  move(found.mesh, axis.frame.transpose(), -axis.frame.transpose() * axis.from_m);
  MuscleBody out = guess;
  BodyShape shape = *guess.shape;
  shape.mesh = std::make_shared<const data::Mesh>(std::move(found.mesh));
  out.shape = std::make_shared<const BodyShape>(std::move(shape));
  if (report)
    *report = {static_cast<int>(found.error_m.size()), found.error_m.back(),
               guess.shape->beside_path_m.head<2>().norm()};
  return out;
}

}  // namespace brachium::fem
