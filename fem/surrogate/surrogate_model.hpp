#pragma once
/// Muscles by their surrogates as a muscle model over one joint, rung "fem.surrogate":
///   M = Σ r F,   dM/dq = Σ (dr/dq F + r dF/dq),   dM/da = Σ (dr/da F + r dF/da)

#include <functional>
#include <memory>
#include <string>
#include <variant>
#include <vector>

#include "data/limb/muscle_model.hpp"
#include "data/model/curve.hpp"
#include "fem/surrogate/surrogate.hpp"

namespace brachium::fem {

/// Where a muscle's moment arm comes from.
struct ArmOfAngle {  ///< r(q) [m], flexor positive, with its slope
  std::function<data::CurveValue(double)> arm;
};
struct ArmOutput {  ///< an output of the surrogate: a lever arm l >= 0, r = sign l
  std::string output;
  double sign = 1.0;  ///< 1 flexor, -1 extensor
};
struct MomentOutput {  ///< an output of the surrogate: the moment itself, flexion positive; r = M / F
  std::string output;
};

struct SurrogateMuscle {
  std::string name;
  std::shared_ptr<const Surrogate> surrogate;
  std::string force_output = "force_n";
  std::variant<ArmOfAngle, ArmOutput, MomentOutput> arm;
};

/// Quasi-static; q' is not used. The force may undershoot zero by the surrogate's error: it is not cut off.
/// The error bound is the greatest leave-out error of the force times |r|, plus that of an arm that is an
/// output times F (of the moment itself, for MomentOutput), where every surrogate has one.
class SurrogateModel final : public limb::MuscleModel {
 public:
  /// Throws InputError("unknown-output"), or "bad-parameter" for no muscle, one without surrogate or arm, or
  /// a name twice.
  SurrogateModel(std::string coordinate, std::vector<SurrogateMuscle> muscles);

  const limb::ModelTraits& traits() const override { return traits_; }
  const std::vector<std::string>& coordinates() const override { return coordinates_; }
  const std::vector<std::string>& muscles() const override { return names_; }
  const std::vector<SurrogateMuscle>& parts() const { return muscles_; }
  /// Angles that all muscles share.
  data::Domain angles() const;

  /// Throws InputError("outside-surrogate") naming the muscle, "wrong-size" for wrong sizes.
  void evaluate(const Eigen::VectorXd& q, const Eigen::VectorXd& qdot, const Eigen::VectorXd& activation,
                const Eigen::VectorXd& state, limb::Evaluation& out) const override;

 private:
  limb::ModelTraits traits_;
  std::vector<std::string> coordinates_, names_;
  std::vector<SurrogateMuscle> muscles_;
  std::vector<std::size_t> force_, other_;  // outputs of each muscle's surrogate
};

}  // namespace brachium::fem
