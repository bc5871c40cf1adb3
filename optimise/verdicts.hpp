#pragma once
/// From a fit and its statistics to one plain verdict per parameter.

#include <string>
#include <utility>
#include <vector>

#include "data/model/subject.hpp"
#include "data/model/table.hpp"
#include "optimise/intervals.hpp"
#include "optimise/statistics.hpp"

namespace brachium::optimise {

struct VerdictInput {
  const std::vector<Parameter>* parameters = nullptr;
  Eigen::VectorXd x;              ///< fitted, bias removed where it was
  Eigen::VectorXd x_uncorrected;  ///< the least-squares solution: bounds are judged here
  Eigen::VectorXd bias;           ///< 0 where not estimated
  const FitStatistics* statistics = nullptr;
  Intervals intervals;
  std::vector<std::pair<std::size_t, std::size_t>>
      gain_strength;  ///< CalibrationProblem::gain_strength_pairs()
};

/// One verdict a parameter:
///   AT LOWER BOUND / AT UPPER BOUND  within 1e-6 of the bounds' width
///   NOT IDENTIFIED                   no finite standard error (a direction the data do not see), a 95 %
///   interval wider
///                                    than the bounds, a posterior that is no narrower than 0.9 of its prior,
///                                    or a gain free together with a strength it drives, neither with a prior
///   identified                       otherwise
/// Remarks name correlations, combinations, what a prior decides, and parameters that may swap.
std::vector<data::ParameterVerdict> verdicts(const VerdictInput& input);

/// Pairs that leave the model unchanged when they swap: both time constants, or both recursion coefficients,
/// of one owner. Index pairs into the parameters.
std::vector<std::pair<std::size_t, std::size_t>> exchangeable_pairs(const std::vector<Parameter>& parameters);

/// The verdicts as a table: owner, parameter, unit, start, fitted, lower, upper, standard error, 95 %
/// interval, bias, verdict, remark.
data::Table verdict_table(const data::Subject& subject);
/// The same as fixed-width text.
std::string verdict_text(const data::Subject& subject);

}  // namespace brachium::optimise
