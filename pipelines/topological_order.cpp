#include <fmt/format.h>

#include <algorithm>

#include "pipelines/definition.hpp"

namespace brachium::pipelines {

using data::Diagnostic;
using data::Severity;

std::vector<std::size_t> topological_order(std::span<const StageDefinition> stages,
                                           std::vector<Diagnostic>& diagnostics) {
  enum class Mark { fresh, open, done };
  std::map<std::string, std::size_t> index;
  for (std::size_t i = 0; i < stages.size(); ++i) index.emplace(stages[i].name, i);
  std::vector<Mark> marks(stages.size(), Mark::fresh);
  std::vector<std::size_t> order, path;
  const auto visit = [&](auto& self, std::size_t i) -> void {
    marks[i] = Mark::open;
    path.push_back(i);
    for (const auto& [port, wires] : stages[i].inputs) {
      for (const Wire& wire : wires) {
        const auto source = index.find(wire.stage);
        if (source == index.end()) continue;
        if (marks[source->second] == Mark::open) {
          std::string loop;
          for (auto at = std::find(path.begin(), path.end(), source->second); at != path.end(); ++at)
            loop += fmt::format("`{}` reads ", stages[*at].name);
          diagnostics.push_back({Severity::error, "cycle",
                                 fmt::format("stages wait for each other: {}`{}`", loop, wire.stage),
                                 wire.where, "a stage can read only stages that do not read it"});
        } else if (marks[source->second] == Mark::fresh) {
          self(self, source->second);
        }
      }
    }
    path.pop_back();
    marks[i] = Mark::done;
    order.push_back(i);
  };
  for (std::size_t i = 0; i < stages.size(); ++i) {
    if (marks[i] == Mark::fresh) visit(visit, i);
  }
  return order;
}

}  // namespace brachium::pipelines
