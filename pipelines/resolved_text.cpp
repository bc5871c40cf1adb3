#include <algorithm>

#include "pipelines/definition.hpp"
#include "pipelines/options.hpp"

namespace brachium::pipelines {

using io::TomlNode;

std::string resolved_text(const Definition& definition) {
  TomlNode root = TomlNode::table();
  TomlNode& pipeline = root.member("pipeline");
  pipeline.member("title") = TomlNode::of(definition.title);
  if (!definition.session.empty()) pipeline.member("session") = TomlNode::of(definition.session.string());
  if (!definition.scene_file.empty()) pipeline.member("scene") = TomlNode::of(definition.scene_file.string());
  pipeline.member("threads") = TomlNode::of(static_cast<std::int64_t>(definition.threads));
  for (const auto& [key, value] : definition.session_overrides) {
    pipeline.member("session_settings").member(key) = io::parse_toml_value(value, {});
  }
  TomlNode list;
  list.kind = TomlNode::Kind::array;
  for (const StageDefinition& stage : definition.stages) {
    TomlNode entry = TomlNode::table();
    entry.member("name") = TomlNode::of(stage.name);
    entry.member("run") = TomlNode::of(stage.spec->name);
    if (!stage.inputs.empty()) {
      TomlNode& input = entry.member("input");
      for (const auto& [port, wires] : stage.inputs) {
        std::vector<std::string> names;
        for (const Wire& wire : wires)
          names.push_back(wire.stage.empty() ? "file:" + wire.file.string() : wire.stage);
        input.member(port) = names.size() == 1 ? TomlNode::of(names.front()) : TomlNode::of(names);
      }
    }
    if (!stage.trials.empty()) entry.member("trials") = TomlNode::of(stage.trials);
    if (stage.export_sto) entry.member("export_sto") = TomlNode::of(true);
    for (auto& [key, value] : options_tree(stage.options, stage.spec->options).members)
      entry.member(key) = value;
    list.items.push_back(std::move(entry));
  }
  root.member("stage") = std::move(list);
  TomlNode expectations;
  expectations.kind = TomlNode::Kind::array;
  for (const Expectation& e : definition.expectations) {
    TomlNode entry = TomlNode::table();
    entry.member("name") = TomlNode::of(e.name);
    entry.member("stage") = TomlNode::of(e.stage);
    entry.member("table") = TomlNode::of(e.table);
    entry.member("column") = TomlNode::of(e.column);
    for (const auto& [column, wanted] : e.where) entry.member("where").member(column) = TomlNode::of(wanted);
    if (e.row) entry.member("row") = TomlNode::of(static_cast<std::int64_t>(*e.row));
    if (e.value) entry.member("value") = TomlNode::of(*e.value);
    if (e.value) entry.member("tolerance") = TomlNode::of(e.tolerance);
    if (e.minimum) entry.member("min") = TomlNode::of(*e.minimum);
    if (e.maximum) entry.member("max") = TomlNode::of(*e.maximum);
    expectations.items.push_back(std::move(entry));
  }
  if (!expectations.items.empty()) root.member("expect") = std::move(expectations);
  std::string text = "# The definition as it was run: every option written out, paths absolute.\n";
  for (std::string setting : definition.settings) {
    std::replace(setting.begin(), setting.end(), '\n', ' ');  // a comment is one line
    text += "# --set " + setting + "\n";
  }
  return text + "\n" + io::write_toml(root);
}

}  // namespace brachium::pipelines
