#pragma once
/// Lumped muscles over one joint coordinate, as the question asked of every muscle model (limb::MuscleModel):
/// the rungs hill.rigid (uses q') and hill.elastic (static equilibrium, v~ = 0).

#include <string>
#include <vector>

#include "data/limb/muscle_model.hpp"
#include "data/limb/muscle_path.hpp"
#include "hill/muscle_tendon.hpp"

namespace brachium::hill {

/// One muscle and the path it pulls along.
struct JointMuscle {
  MuscleTendon muscle;
  limb::MusclePath path;
};

/// Const and safe to call from several threads. Gives dM/dq and dM/da; q and q' have one entry.
class JointModel final : public limb::MuscleModel {
 public:
  /// All muscles must share the tendon kind; throws InputError otherwise, and for duplicate names.
  JointModel(std::string coordinate, std::vector<JointMuscle> muscles);

  const limb::ModelTraits& traits() const override { return traits_; }
  const std::vector<std::string>& coordinates() const override { return coordinates_; }
  const std::vector<std::string>& muscles() const override { return names_; }
  void evaluate(const Eigen::VectorXd& q, const Eigen::VectorXd& qdot, const Eigen::VectorXd& activation,
                const Eigen::VectorXd& state, limb::Evaluation& out) const override;

 private:
  limb::ModelTraits traits_;
  std::vector<std::string> coordinates_;
  std::vector<std::string> names_;
  std::vector<JointMuscle> joint_muscles_;
};

}  // namespace brachium::hill
