#include "pipelines/run_stage.hpp"

#include <fmt/format.h>

#include "pipelines/options.hpp"

namespace brachium::pipelines {

std::vector<std::string> select_trials(const StageSpec& spec,
                                       const std::map<std::string, std::vector<const StageData*>>& inputs,
                                       const std::vector<std::string>& patterns) {
  for (const InputSpec& port : spec.inputs) {
    const auto wired = inputs.find(port.name);
    if (port.type != PortType::signals || wired == inputs.end() || wired->second.empty()) continue;
    std::vector<std::string> names;
    for (const data::TrialInfo& trial : wired->second.front()->signals->info().trials)
      names.push_back(trial.name);
    if (names.empty() && patterns.empty()) {
      throw data::InputError("no-trials", fmt::format("`{}` has no trials", wired->second.front()->stage),
                             "check what it was made from");
    }
    if (patterns.empty()) return names;
    return data::match_names(patterns, names, fmt::format("trial of `{}`", wired->second.front()->stage));
  }
  return {};
}

StageData run_stage(const StageSpec& spec, const StageRequest& request) {
  const Options options = options_from_text(request.options, spec);
  for (const InputSpec& port : spec.inputs) {
    const auto wired = request.inputs.find(port.name);
    if (!port.optional && (wired == request.inputs.end() || wired->second.empty())) {
      throw data::InputError("missing-input",
                             fmt::format("stage `{}` needs the input `{}`", spec.name, port.name), port.doc);
    }
  }
  StageContext context;
  context.name = spec.name;
  context.options = &options;
  context.inputs = request.inputs;
  context.scene = request.scene;
  context.trials = select_trials(spec, request.inputs, request.trials);
  context.threads = request.threads;
  context.progress = [](double, const std::string&) {};
  if (spec.needs_scene) context.need_scene();
  auto signals = std::make_shared<data::MemorySession>();
  StageOutput output;
  output.signals = signals.get();
  spec.run(context, output);
  return {spec.name,
          signals,
          std::move(output.tables),
          std::move(output.subject),
          std::move(output.attributes),
          std::move(output.diagnostics)};
}

StageData session_data(data::Session session) {
  StageData data;
  data.stage = "session";
  data.signals = std::make_shared<data::MemorySession>(std::move(session));
  return data;
}

}  // namespace brachium::pipelines
