#pragma once
/// What a surrogate is made from: values of some outputs at states (angle, activation), where known with
/// derivatives.
///
/// | symbol | identifier | unit          | meaning                                            |
/// |--------|------------|---------------|----------------------------------------------------|
/// | theta  | theta_rad  | rad           | joint angle, flexion positive                      |
/// | alpha  | activation | 1             | activation of the muscle concerned, in [0, 1]      |
/// | F      | value      | of the output | outputs, such as force [N], moment [N m], arm [m]  |

#include <Eigen/Core>
#include <string>
#include <vector>

namespace brachium::fem {

struct StatePoint {
  double theta_rad = 0.0;
  double activation = 0.0;
};

/// A rectangle of states, inclusive.
struct StateBounds {
  double theta_lower_rad = 0.0, theta_upper_rad = 0.0;
  double activation_lower = 0.0, activation_upper = 1.0;

  double theta_span() const { return theta_upper_rad - theta_lower_rad; }
  double activation_span() const { return activation_upper - activation_lower; }
  /// Inside, with a billionth of the range for the rounding of degrees to radians.
  bool contains(const StatePoint& state) const;
  /// Throws InputError("bad-range") for a rectangle without area or activations outside [0, 1].
  void check() const;
  bool operator==(const StateBounds&) const = default;
};

/// Outputs at one state.
struct Sample {
  StatePoint at;
  Eigen::VectorXd value;        ///< n_outputs
  Eigen::VectorXd dtheta = {};  ///< dF/dtheta [1/rad], n_outputs; empty where unknown
  Eigen::VectorXd dalpha = {};  ///< dF/dalpha, n_outputs; empty where unknown
};

struct SampleSet {
  std::vector<std::string> outputs;  ///< names with units: "force_n"
  std::vector<Sample> samples;

  std::size_t size() const { return samples.size(); }
  bool has_derivatives() const;  ///< every sample has both
  /// Finite values of the right sizes, no state twice; throws InputError("bad-sample") naming the state.
  void check() const;
};

/// Samples at all pairs of angles and activations, ordered: sample (i, j) of grid() is samples[i n_alpha +
/// j].
struct SampleGrid {
  std::vector<double> theta_rad, activation;  ///< increasing
  SampleSet samples;

  StateBounds bounds() const;
};

/// Brings samples that fill a tensor grid into its order. Throws InputError("not-a-grid") naming a state that
/// is missing.
SampleGrid as_grid(const SampleSet& samples);

/// The states of a tensor grid, in its order.
std::vector<StatePoint> grid_states(const std::vector<double>& theta_rad,
                                    const std::vector<double>& activation);

/// n values from lower to upper at equal distances.
std::vector<double> equidistant(double lower, double upper, std::size_t n);

}  // namespace brachium::fem
