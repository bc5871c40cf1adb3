#include "pipelines/stage.hpp"

#include <fmt/format.h>

#include <stdexcept>

namespace brachium::pipelines {

void StageOutput::warn(std::string code, std::string message, std::string help) {
  diagnostics.push_back(
      {data::Severity::warning, std::move(code), std::move(message), std::nullopt, std::move(help)});
}

void StageOutput::note(std::string code, std::string message) {
  diagnostics.push_back({data::Severity::note, std::move(code), std::move(message), std::nullopt, {}});
}

const StageData& StageContext::input(const std::string& port) const {
  const StageData* data = maybe_input(port);
  if (!data)
    throw std::logic_error(fmt::format("stage `{}` reads its input `{}`, which is not wired", name, port));
  return *data;
}

const StageData* StageContext::maybe_input(const std::string& port) const {
  const auto found = inputs.find(port);
  return found == inputs.end() || found->second.empty() ? nullptr : found->second.front();
}

const data::Scene& StageContext::need_scene() const {
  if (!scene) {
    throw data::InputError("missing-scene",
                           fmt::format("stage `{}` needs a scene, and the pipeline names none", name),
                           "add `scene = \"...\"` to [pipeline]");
  }
  return *scene;
}

void Catalogue::add(StageSpec spec) {
  if (find(spec.name)) throw std::logic_error(fmt::format("two stages are called `{}`", spec.name));
  stages_.push_back(std::move(spec));
}

const StageSpec* Catalogue::find(const std::string& name) const {
  for (const StageSpec& spec : stages_) {
    if (spec.name == name) return &spec;
  }
  return nullptr;
}

std::vector<std::string> Catalogue::names() const {
  std::vector<std::string> names;
  for (const StageSpec& spec : stages_) names.push_back(spec.name);
  return names;
}

}  // namespace brachium::pipelines
