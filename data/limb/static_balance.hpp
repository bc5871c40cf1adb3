#pragma once
/// Static balance: angles at which muscles and external moments add up to nothing.
///
/// | symbol | identifier | unit    | meaning                                                     |
/// |--------|------------|---------|-------------------------------------------------------------|
/// | M(q)   | -          | N m     | muscle moment plus external moment, flexion positive        |
/// | dM/dq  | stiffness  | N m/rad | stable where it is negative                                 |

#include <Eigen/Core>
#include <cstddef>
#include <functional>
#include <optional>
#include <vector>

#include "data/limb/muscle_model.hpp"

namespace brachium::limb {

struct Equilibrium {
  double angle_rad = 0.0;
  double stiffness_N_m_per_rad = 0.0;  ///< dM/dq
  bool stable = false;                 ///< dM/dq < 0
  double residual_N_m = 0.0;           ///< M at the angle
};

struct BalanceOptions {
  std::size_t coordinate = 0;  ///< which entry of q is sought
  std::size_t scan_points =
      361;  ///< roots closer together than the scan's step may be missed unless |M| dips to 0 there
  double angle_tolerance_rad = 1e-10;
  double moment_tolerance_N_m = 1e-9;  ///< |M| at which a touching minimum counts as a root
};

/// No equilibrium in range is a result, not a failure: then `equilibria` is empty and `nearest` says how far
/// off it is.
struct Balance {
  std::vector<Equilibrium> equilibria;  ///< by increasing angle
  Equilibrium nearest;                  ///< where |M| is smallest over the range
};

/// External moment about the sought coordinate at an angle, flexion positive: gravity, loads.
using ExternalMoment = std::function<double(const Eigen::VectorXd& q)>;

/// All angles in [lower, upper] that hold with given activations; the other coordinates stay as in `q`.
/// Throws InputError("not-quasi-static") for a model with internal state, and what the model throws.
Balance static_balance(const MuscleModel& model, const Eigen::VectorXd& activation,
                       const ExternalMoment& external, const Eigen::VectorXd& q, double lower_rad,
                       double upper_rad, const BalanceOptions& options = {});

/// The same for any moment M(q) over an interval.
Balance balance_of(const std::function<double(double)>& moment, double lower_rad, double upper_rad,
                   const BalanceOptions& options = {});

}  // namespace brachium::limb
