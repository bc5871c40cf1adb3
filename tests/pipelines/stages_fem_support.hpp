#pragma once
/// Short ways to run fem.solve in memory.

#include <string>

#include "pipelines/run_stage.hpp"

namespace brachium::pipelines::tests {

inline const StageSpec& fem_stage() {
  static const Catalogue catalogue = built_in_catalogue();
  return *catalogue.find("fem.solve");
}

inline StageData solved(const std::string& options) {
  StageRequest request;
  request.options = options;
  return run_stage(fem_stage(), request);
}

/// What a terminal shows of the InputError that the options lead to; empty where they lead to none.
inline std::string mistakes(const std::string& options) {
  try {
    solved(options);
  } catch (const data::InputError& e) {
    return data::render(e.diagnostics());
  }
  return {};
}

inline std::string with(std::string text, const std::string& what, const std::string& instead) {
  text.replace(text.find(what), what.size(), instead);
  return text;
}

/// The last accepted state's value of a wanted quantity.
inline double last(const StageData& data, const std::string& column) {
  return data.tables.at("quantities").numbers(column).back();
}

}  // namespace brachium::pipelines::tests
