#pragma once
/// One stage run in memory, without a definition or a run folder: for tests of stages and for other programs.

#include <map>
#include <string>
#include <vector>

#include "pipelines/stage.hpp"

namespace brachium::pipelines {

struct StageRequest {
  std::string options;  ///< TOML text: "lowpass_hz = 6"
  std::map<std::string, std::vector<const StageData*>> inputs;
  const data::Scene* scene = nullptr;
  std::vector<std::string> trials = {"*"};  ///< shell patterns
  std::size_t threads = 1;
};

/// Runs the stage on the given inputs; checks options, ports and trials as a pipeline does (InputError).
StageData run_stage(const StageSpec& spec, const StageRequest& request);

/// A session as a stage's input, named "session".
StageData session_data(data::Session session);

/// Names of the trials to work on: those of the first wired signals input that match the patterns (all if
/// there are none), in that input's order. Empty where no signals input is wired. Throws
/// InputError("no-match"), or ("no-trials") where that input has none.
std::vector<std::string> select_trials(const StageSpec& spec,
                                       const std::map<std::string, std::vector<const StageData*>>& inputs,
                                       const std::vector<std::string>& patterns);

}  // namespace brachium::pipelines
