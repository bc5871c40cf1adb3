#pragma once
/// Named parameters of a muscle body from forces, or moments about the hinge, that are known at angles and
/// activations.
///
///     minimise  f(x) = 1/2 mean over sets of  sum_i w_i (y(q_i, a_i; x) - y_i)^2 / sum_i w_i y_i^2
///
/// so that sqrt(2 f) is the root mean square of the sets' relative L2 errors: a set of few or small forces
/// (the passive ones) counts as much as one of many.
///
/// | symbol | identifier | unit | meaning                                                                |
/// |--------|------------|------|------------------------------------------------------------------------|
/// | x      | -          |      | values of fem/limb/body_parameters.hpp                                 |
/// | y_i    | value      | N    | reference force, tension positive                                      |
/// |        |            | N m  | or moment, flexion positive; the model's is by virtual work            |
/// | w      | weight     | 1    | 0: compared, not fitted                                                |
///
/// Derivatives are one-sided differences of 1e-4 of the bounds' width: states are solved to 1e-8, so that the
/// noise of a difference is 1e-4 of it. Each perturbed state is reached from the unperturbed one. Intervals
/// are x +- t se, Student's t.

#include <memory>
#include <string>
#include <vector>

#include "data/model/subject.hpp"
#include "data/model/table.hpp"
#include "fem/limb/muscle_states.hpp"
#include "optimise/solve.hpp"
#include "optimise/statistics.hpp"

namespace brachium::optimise {

enum class Measure { force, moment };

struct ReferenceForce {
  double q_rad = 0.0, activation = 0.0, value = 0.0, weight = 1.0;
  std::string set;  ///< name of the set that it belongs to: agreement is reported set by set
  Measure measure = Measure::force;
};

/// One thread's way to forces and moments; may keep what is of use for the next body.
class MuscleForces {
 public:
  virtual ~MuscleForces() = default;
  /// In the references' order [N, N m]. `variation`: a body that differs little from the last one that was none.
  /// Throws data::ConvergenceFailure where there are none.
  virtual Eigen::VectorXd values(const fem::MuscleBody& body, bool variation) = 0;
};

class MuscleForceModel {
 public:
  virtual ~MuscleForceModel() = default;
  virtual std::unique_ptr<MuscleForces> make(const std::vector<ReferenceForce>& references) const = 0;
};

/// fem/limb/strap.hpp.
std::unique_ptr<MuscleForceModel> strap_force_model();

/// fem/limb/muscle_states.hpp: every state solved. Unstable states count as failures.
struct ContinuumForceOptions {
  fem::AngleRange range;
  fem::Hinge hinge;
  std::vector<fem::Bone> bones;
  fem::SolvedMuscleOptions states;
};
std::unique_ptr<MuscleForceModel> continuum_force_model(const ContinuumForceOptions& options);

/// A parameter of the body that is free; NaN: the bounds of fem/limb/body_parameters.hpp.
struct FreeBodyParameter {
  std::string name;
  double lower = fem::not_given, upper = fem::not_given;
};

struct MuscleForceFit {
  fem::MuscleBody body;
  Eigen::VectorXd value;  ///< at the references [N, N m]
  std::vector<data::ParameterVerdict> verdicts;
  FitStatistics statistics;
  Summary summary;
};

/// Throws InputError ("unknown-body-parameter", "bad-parameter"; "no-references" where no weight is above 0;
/// "contradiction" where radius and volume are both free) and data::ConvergenceFailure where not even the start has forces.
MuscleForceFit fit_muscle_forces(const fem::MuscleBody& start, const std::vector<FreeBodyParameter>& free,
                                 const std::vector<ReferenceForce>& references, const MuscleForceModel& model,
                                 const SolveOptions& options);

struct ForceAgreement {
  std::string set;
  Measure measure = Measure::force;
  std::size_t states = 0;
  double relative_l2 = 0.0;       ///< |F - F_ref| / |F_ref|, unweighted
  double rms = 0.0, worst = 0.0;  ///< [N], of moments [N m]
  double worst_q_rad = 0.0, worst_activation = 0.0;
};

/// By set and measure in the order of first mention; references of weight 0 count in sets of their own, "<set>, not
/// fitted".
std::vector<ForceAgreement> agreement(const std::vector<ReferenceForce>& references,
                                      const Eigen::VectorXd& value);

}  // namespace brachium::optimise
