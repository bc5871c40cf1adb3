#include "pipelines/settings.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <optional>
#include <set>

#include "pipelines/options.hpp"

namespace brachium::pipelines {
namespace {

using data::Diagnostic;
using data::Severity;
using io::TomlNode;
namespace fs = std::filesystem;

/// The folder of recordings: a variable that a session description has as well.
const std::string recordings = "recordings";

std::vector<std::string> split(const std::string& key) {
  std::vector<std::string> parts(1);
  for (const char c : key) {
    if (c == '.') {
      parts.emplace_back();
    } else {
      parts.back() += c;
    }
  }
  return parts;
}

std::string absolute_text(const std::string& path, const fs::path& base) {
  return fs::path(path).is_absolute() ? path : (base / path).lexically_normal().string();
}

TomlNode* item_named(TomlNode* list, const std::string& name) {
  if (!list || list->kind != TomlNode::Kind::array) return nullptr;
  for (TomlNode& item : list->items) {
    const TomlNode* own = item.find("name");
    if (own && own->kind == TomlNode::Kind::text && own->text == name) return &item;
  }
  return nullptr;
}

/// [[expect]] by its name or, without one, by its place from 1.
TomlNode* expectation_named(TomlNode* list, const std::string& name) {
  if (TomlNode* item = item_named(list, name)) return item;
  std::size_t place = 0;
  const auto [end, status] = std::from_chars(name.data(), name.data() + name.size(), place);
  const bool is_place = status == std::errc() && end == name.data() + name.size();
  if (!is_place || !list || list->kind != TomlNode::Kind::array || place < 1 || place > list->items.size())
    return nullptr;
  return &list->items[place - 1];
}

void assign(TomlNode& table, std::span<const std::string> path, TomlNode value) {
  TomlNode* node = &table;
  for (const std::string& part : path) node = &node->member(part);
  *node = std::move(value);
}

class Applier {
 public:
  Applier(TomlNode& root, const fs::path& folder, const fs::path& current,
          std::vector<Diagnostic>& diagnostics)
      : root_(root), folder_(folder), current_(current), diagnostics_(diagnostics) {
    applied_.variables = TomlNode::table();
    read_variables();
  }

  void set(const std::string& setting) {
    const std::size_t equals = setting.find('=');
    const data::SourceSpan where{"--set " + setting, 0, 0, 1, {}};
    if (equals == std::string::npos || equals == 0) {
      diagnostics_.push_back({Severity::error, "bad-setting",
                              fmt::format("`{}` is not of the form KEY=VALUE", setting), where,
                              "for example --set excitation.lowpass_hz=4"});
      return;
    }
    const std::vector<std::string> path = split(setting.substr(0, equals));
    TomlNode value = io::parse_toml_value(setting.substr(equals + 1), where.file);
    if (path.size() == 1) {
      set_plain(path[0], value, setting.substr(equals + 1));
    } else if (path[0] == "pipeline") {
      if ((path[1] == "session" || path[1] == "scene") && value.kind == TomlNode::Kind::text) {
        value.text = absolute_text(value.text, current_);
      }
      assign(root_.member("pipeline"), std::span(path).subspan(1), std::move(value));
    } else if (path[0] == "expect") {
      if (TomlNode* item = expectation_named(root_.find("expect"), path[1]); item && path.size() > 2) {
        assign(*item, std::span(path).subspan(2), std::move(value));
      } else {
        unknown(path[0] + "." + path[1], where);
      }
    } else if (TomlNode* stage = item_named(root_.find("stage"), path[0])) {
      if (path[1] == "input") make_file_absolute(value);
      assign(*stage, std::span(path).subspan(1), std::move(value));
    } else if (path[0] == "session" && reads_description()) {
      applied_.session_overrides[setting.substr(8, equals - 8)] = setting.substr(equals + 1);
    } else {
      unknown(path[0], where);
    }
  }

  AppliedSettings finish() {
    for (auto& [key, value] : root_.members) {
      if (key != "variables") substitute(value);
    }
    // A misspelt key would otherwise pass for a variable that nobody uses.
    for (const std::string& name : plain_) {
      if (used_.contains(name) || (name == recordings && reads_description())) continue;
      const std::vector<std::string> known{"pipeline", "variables", "stage", "expect"};
      diagnostics_.push_back(
          {Severity::error, "unknown-key",
           fmt::format("`{}` is not a key of a pipeline definition, nor a variable that a text uses", name),
           applied_.variables.find(name)->key_where, data::suggest(name, known)});
    }
    return std::move(applied_);
  }

 private:
  void read_variables() {
    // Plain values before the first table are variables too.
    for (const auto& [name, node] : root_.members) {
      const bool tables = node.kind == TomlNode::Kind::array && !node.items.empty() &&
                          node.items.front().kind == TomlNode::Kind::table;
      if (node.kind == TomlNode::Kind::table || tables) continue;
      plain_.push_back(name);
      TomlNode& value = applied_.variables.member(name) = node;
      if (name != recordings || node.kind != TomlNode::Kind::text) continue;
      value.text = absolute_text(node.text, folder_);
      if (reads_description()) applied_.session_overrides[name] = node_text(value);
    }
    std::erase_if(root_.members, [&](const auto& m) {
      return std::find(plain_.begin(), plain_.end(), m.first) != plain_.end();
    });
    const TomlNode* table = root_.find("variables");
    if (!table || table->kind != TomlNode::Kind::table) return;
    for (const auto& [name, node] : table->members) {
      if (node.kind != TomlNode::Kind::table) {
        applied_.variables.member(name) = node;
        continue;
      }
      io::TomlTable entry(node, diagnostics_, fmt::format("variable `{}`", name));
      const std::string help = entry.text("help").value_or("");
      const bool is_path = entry.boolean("path").value_or(false);
      const TomlNode* fallback = node.find("default");
      for (const auto& [key, value] : node.members) {
        if (key == "help" || key == "path" || key == "default") continue;
        const std::vector<std::string> known{"help", "path", "default"};
        diagnostics_.push_back({Severity::error, "unknown-key",
                                fmt::format("`{}` is not a key of variable `{}`", key, name), value.key_where,
                                data::suggest(key, known)});
      }
      if (is_path) paths_.push_back(name);
      if (fallback) {
        TomlNode value = *fallback;
        if (is_path && value.kind == TomlNode::Kind::text) value.text = absolute_text(value.text, folder_);
        applied_.variables.member(name) = std::move(value);
      } else {
        unset_[name] = help;
      }
    }
  }

  bool reads_description() const {
    const TomlNode* pipeline = root_.find("pipeline");
    const TomlNode* session = pipeline ? pipeline->find("session") : nullptr;
    return session && session->kind == TomlNode::Kind::text && session->text.ends_with(".toml");
  }

  void set_plain(const std::string& key, const TomlNode& value, const std::string& text) {
    if (key == "expect" && value.kind == TomlNode::Kind::boolean) {
      if (!value.boolean)
        std::erase_if(root_.members, [](const auto& member) { return member.first == "expect"; });
      return;
    }
    TomlNode absolute = value;
    if (value.kind == TomlNode::Kind::text) absolute.text = absolute_text(value.text, current_);
    const bool declared = applied_.variables.find(key) || unset_.contains(key);
    if (declared) {
      const bool is_path = key == recordings || std::find(paths_.begin(), paths_.end(), key) != paths_.end();
      TomlNode& variable = applied_.variables.member(key);
      const data::SourceSpan key_where = variable.key_where;
      variable = is_path ? absolute : value;
      variable.key_where = key_where;
      unset_.erase(key);
    }
    // The folder of recordings belongs to the session description, whether or not the pipeline names it as
    // well.
    if (reads_description() && (key == recordings || !declared)) {
      applied_.session_overrides[key] = key == recordings ? node_text(absolute) : text;
    } else if (!declared) {
      unknown(key, value.where);
    }
  }

  void unknown(const std::string& key, const data::SourceSpan& where) {
    std::vector<std::string> known{"pipeline", "expect"};
    for (const auto& [name, value] : applied_.variables.members) known.push_back(name);
    for (const auto& [name, help] : unset_) known.push_back(name);
    if (const TomlNode* stages = root_.find("stage")) {
      for (const TomlNode& stage : stages->items) {
        if (const TomlNode* name = stage.find("name")) known.push_back(name->text);
      }
    }
    diagnostics_.push_back(
        {Severity::error, "unknown-setting",
         fmt::format("`{}` is neither a stage, a variable nor a part of this pipeline", key), where,
         data::suggest(key, known)});
  }

  void make_file_absolute(TomlNode& node) {
    if (node.kind == TomlNode::Kind::text && node.text.starts_with("file:")) {
      node.text = "file:" + absolute_text(node.text.substr(5), current_);
    }
    for (TomlNode& item : node.items) make_file_absolute(item);
    for (auto& [key, member] : node.members) make_file_absolute(member);
  }

  void substitute(TomlNode& node) {
    for (TomlNode& item : node.items) substitute(item);
    for (auto& [key, member] : node.members) substitute(member);
    if (node.kind != TomlNode::Kind::text) return;
    std::string text;
    std::size_t at = 0;
    while (true) {
      const std::size_t open = node.text.find("${", at);
      const std::size_t close = open == std::string::npos ? open : node.text.find('}', open);
      if (close == std::string::npos) break;
      const TomlNode* value = variable(node.text.substr(open + 2, close - open - 2), node.where);
      if (!value) return;
      if (open == 0 && close + 1 == node.text.size()) {  // the variable is the whole text: it keeps its type
        const data::SourceSpan where = node.where, key_where = node.key_where;
        node = *value;
        node.where = where;
        node.key_where = key_where;
        return;
      }
      text += node.text.substr(at, open - at);
      text += value->kind == TomlNode::Kind::text ? value->text : node_text(*value);
      at = close + 1;
    }
    node.text = text + node.text.substr(at);
  }

  const TomlNode* variable(const std::string& name, const data::SourceSpan& where) {
    used_.insert(name);
    if (const TomlNode* value = applied_.variables.find(name)) return value;
    if (const auto unset = unset_.find(name); unset != unset_.end()) {
      if (used_unset_[name]) return nullptr;
      used_unset_[name] = true;
      diagnostics_.push_back({Severity::error, "unset-variable",
                              fmt::format("variable `{}` has no value{}", name,
                                          unset->second.empty() ? "" : ": " + unset->second),
                              where, fmt::format("give it with --set {}=...", name)});
      return nullptr;
    }
    std::vector<std::string> known;
    for (const auto& [key, value] : applied_.variables.members) known.push_back(key);
    for (const auto& [key, help] : unset_) known.push_back(key);
    diagnostics_.push_back({Severity::error, "unknown-variable",
                            fmt::format("there is no variable `{}`", name), where,
                            known.empty() ? "name it in [variables]" : data::suggest(name, known)});
    return nullptr;
  }

  TomlNode& root_;
  const fs::path folder_, current_;
  std::vector<Diagnostic>& diagnostics_;
  AppliedSettings applied_;
  std::vector<std::string> plain_;  ///< variables that stand before the first table
  std::set<std::string> used_;
  std::map<std::string, std::string> unset_;  ///< variables without a value, and their help
  std::map<std::string, bool> used_unset_;    ///< said once
  std::vector<std::string> paths_;
};

}  // namespace

AppliedSettings apply_settings(TomlNode& root, std::span<const std::string> settings, const fs::path& folder,
                               const fs::path& current, std::vector<Diagnostic>& diagnostics) {
  Applier applier(root, folder, current, diagnostics);
  // Keys of the pipeline first: whether the session is a description decides what other keys mean.
  for (const bool pipeline_keys : {true, false}) {
    for (const std::string& setting : settings) {
      if (setting.starts_with("pipeline.") == pipeline_keys) applier.set(setting);
    }
  }
  return applier.finish();
}

}  // namespace brachium::pipelines
