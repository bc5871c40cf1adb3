#pragma once
/// The one question that is asked of every muscle model, lumped or continuum.
///
/// | symbol | identifier             | unit      | meaning                                             |
/// |--------|------------------------|-----------|-----------------------------------------------------|
/// | q      | q                      | rad       | joint coordinates, flexion positive (n_q)           |
/// | q'     | qdot                   | rad/s     | their rates (n_q)                                   |
/// | a      | activation             | 1         | muscle activations in [0, 1] (n_m)                  |
/// | x      | state                  | -         | internal state (n_x); empty for quasi-static models |
/// | F      | force                  | N         | tension, >= 0 (n_m)                                 |
/// | r      | moment_arm             | m         | r = -dL/dq (n_q x n_m)                              |
/// | M      | moment                 | N m       | M = r F, flexion positive (n_q)                     |

#include <Eigen/Core>
#include <cstddef>
#include <string>
#include <vector>

namespace brachium::limb {

/// Which inputs a model uses and which derivatives it gives.
struct ModelTraits {
  std::string rung;  ///< place on the ladder of fidelity: "hill.rigid", "hill.elastic", "fem.fine", ...
  std::size_t state_size = 0;  ///< n_x
  bool uses_qdot = false;
  bool gives_dmoment_dq = false;
  bool gives_dmoment_dactivation = false;
  bool gives_error_bound = false;
};

struct Evaluation {
  Eigen::VectorXd force;                ///< n_m [N]
  Eigen::MatrixXd moment_arm;           ///< n_q x n_m [m]
  Eigen::VectorXd moment;               ///< n_q [N m]
  Eigen::MatrixXd dmoment_dq;           ///< n_q x n_q [N m/rad], empty if not given
  Eigen::MatrixXd dmoment_dactivation;  ///< n_q x n_m [N m], empty if not given
  Eigen::VectorXd state_rate;           ///< n_x
  Eigen::VectorXd error_bound;          ///< n_q [N m], numerical error of the moment; empty if not given
};

/// A set of muscles over a set of coordinates. Const and safe to call from several threads.
class MuscleModel {
 public:
  virtual ~MuscleModel() = default;
  virtual const ModelTraits& traits() const = 0;
  virtual const std::vector<std::string>& coordinates() const = 0;  ///< n_q names
  virtual const std::vector<std::string>& muscles() const = 0;      ///< n_m names

  /// Throws data::InputError for arguments outside the model's domain (activation outside [0, 1], an angle
  /// outside the geometry's range, wrong sizes) and data::ConvergenceFailure naming the muscle otherwise.
  virtual void evaluate(const Eigen::VectorXd& q, const Eigen::VectorXd& qdot,
                        const Eigen::VectorXd& activation, const Eigen::VectorXd& state,
                        Evaluation& out) const = 0;
};

}  // namespace brachium::limb
