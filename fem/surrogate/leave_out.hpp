#pragma once
/// Errors of surrogates at states that they were not made from.

#include <functional>
#include <optional>

#include "fem/surrogate/surrogate.hpp"

namespace brachium::fem {

/// Differences at known states, gathered into the figures of LeaveOutError.
class ErrorTally {
 public:
  explicit ErrorTally(std::vector<std::string> outputs);
  void add(const StatePoint& at, const Eigen::VectorXd& known, const Eigen::VectorXd& predicted);
  LeaveOutError result(int order) const;

 private:
  LeaveOutError error_;
  std::vector<double> squares_, reference_;
};

/// Leaves out one inner line of angles or activations after the other. None where no direction has an inner
/// line.
std::optional<LeaveOutError> leave_out_lines(const SampleGrid& grid,
                                             const std::function<Surrogate(const SampleGrid&)>& make,
                                             int order);

/// The surrogate against states it never saw (a validation set): the same figures, with nothing left out.
LeaveOutError error_at(const Surrogate& surrogate, const SampleSet& known);

}  // namespace brachium::fem
