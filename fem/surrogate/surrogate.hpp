#pragma once
/// A surrogate of a muscle: outputs as smooth functions of angle and activation, from few states of a costly
/// model.
///
/// It is made by tensor_spline, hermite_surrogate or sparse_spline; evaluating it costs some tens of
/// nanoseconds whatever it was made from, since each becomes polynomials over a mesh (patches.hpp).

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "fem/surrogate/patches.hpp"
#include "fem/surrogate/samples.hpp"

namespace brachium::fem {

/// What the states say about the error: each state (or line of states) is left out, the surrogate made again
/// from the rest, and compared there. Pessimistic, since the rest is coarser than the whole; `order` says by
/// how much: halving the distance of states divides the error of a smooth output by 2^order.
struct LeaveOutError {
  struct Output {
    std::string name;
    double rms = 0.0, greatest = 0.0;  ///< in the output's unit
    double relative_l2 = 0.0;          ///< rms / root mean square of the output over the states left out
    StatePoint worst;                  ///< where the greatest is
  };
  std::vector<Output> outputs;
  std::size_t left_out = 0;  ///< comparisons made
  int order = 0;
};

/// Immutable; safe from several threads.
class Surrogate {
 public:
  Surrogate() = default;
  Surrogate(std::string method, std::vector<std::string> outputs, StateBounds bounds, std::size_t states,
            PatchTable patches);

  const std::string& method() const { return method_; }  ///< "tensor spline, degree 3 x 3", ...
  const std::vector<std::string>& outputs() const { return outputs_; }
  std::size_t output(const std::string& name) const;  ///< its place; throws InputError("unknown-output")
  const StateBounds& bounds() const { return bounds_; }
  std::size_t states() const { return states_; }  ///< number it was made from
  const PatchTable& patches() const { return patches_; }
  const std::optional<LeaveOutError>& error() const { return error_; }  ///< where it could be estimated
  void set_error(LeaveOutError error) { error_ = std::move(error); }

  /// Writes outputs().size() values. Throws InputError("outside-surrogate") for a state outside bounds().
  void evaluate(double theta_rad, double activation, std::span<OutputValue> out) const;

  /// Along a time series: row o, column i holds output o at state i.
  struct Series {
    Eigen::MatrixXd value, dtheta, dalpha;  ///< n_outputs x n_states
  };
  /// Throws as evaluate, naming the sample, and InputError("wrong-size") for series of different lengths.
  Series evaluate_series(std::span<const double> theta_rad, std::span<const double> activation) const;

 private:
  [[noreturn]] void refuse(double theta_rad, double activation, const std::string& where) const;

  std::string method_;
  std::vector<std::string> outputs_;
  StateBounds bounds_;
  std::size_t states_ = 0;
  PatchTable patches_;
  std::optional<LeaveOutError> error_;
};

}  // namespace brachium::fem
