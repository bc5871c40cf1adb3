#pragma once
/// Checks of a calibration's scene, options and trials, and the chain made of them. Internal to optimise/.

#include <memory>
#include <vector>

#include "optimise/chain.hpp"

namespace brachium::optimise {

struct PreparedChain {
  std::shared_ptr<const Chain> chain;
  CalibrationProblem::Samples samples;  ///< of the excitations
  std::vector<TrialWindow> windows;     ///< by trial
};

/// Throws InputError with every mistake found.
PreparedChain prepare_chain(data::Scene scene, const std::vector<CalibrationTrial>& trials,
                            CalibrationProblemOptions options);

}  // namespace brachium::optimise
