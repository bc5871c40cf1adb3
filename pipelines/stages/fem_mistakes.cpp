#include "pipelines/stages/fem_mistakes.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

namespace brachium::pipelines {
namespace {

struct Name {
  std::string text;
  bool of_phase = false, of_region = false;  ///< "phase `x`", "region `x`"
};

std::vector<Name> names_in(const std::string& message) {
  std::vector<Name> names;
  std::size_t at = 0;
  while (true) {
    const std::size_t open = message.find('`', at);
    const std::size_t close = open == std::string::npos ? open : message.find('`', open + 1);
    if (close == std::string::npos) return names;
    const std::string_view before(message.data(), open);
    names.push_back({message.substr(open + 1, close - open - 1), before.ends_with("phase "),
                     before.ends_with("region ")});
    at = close + 1;
  }
}

/// Path in `entry` at which the name stands; empty where it does not.
std::string path_of(const Options& entry, const std::string& name) {
  if (entry.has(name)) return name;
  for (const auto& [key, value] : entry.values()) {
    if (const auto* text = std::get_if<std::string>(&value); text && *text == name) return key;
    if (const auto* map = std::get_if<std::map<std::string, double>>(&value); map && map->contains(name))
      return key + "." + name;
    if (const auto* texts = std::get_if<std::vector<std::string>>(&value)) {
      const auto found = std::find(texts->begin(), texts->end(), name);
      if (found != texts->end()) return fmt::format("{}[{}]", key, found - texts->begin());
    }
  }
  return {};
}

const Options* named(const Options& options, const std::string& list, const std::string& name) {
  const Options* found = nullptr;  // the last: of two with one name it is the second that is too many
  for (const Options& entry : options.tables(list)) {
    if (entry.text("name") == name) found = &entry;
  }
  return found;
}

const Options* entry_of(const Options& options, const Name& name) {
  if (name.of_phase) return named(options, "phase", name.text);
  if (name.of_region) {
    for (const Options& entry : options.tables("material")) {
      if (entry.has("regions") && !path_of(entry, name.text).empty()) return &entry;
    }
    return nullptr;
  }
  if (const Options* condition = named(options, "boundary", name.text)) return condition;
  return named(options, "contact", name.text);
}

}  // namespace

data::SourceSpan place_in(const Options& entry, const std::string& message) {
  std::string path;
  for (const Name& name : names_in(message)) {
    if (const std::string found = path_of(entry, name.text); !found.empty()) path = found;
  }
  return entry.where(path);
}

data::SourceSpan place_of(const data::Diagnostic& finding, const Options& options) {
  if (finding.where) return *finding.where;
  for (const Name& name : names_in(finding.message)) {
    if (const Options* entry = entry_of(options, name)) return place_in(*entry, finding.message);
  }
  if (finding.code == "unsupported-motion" || finding.code == "pressure-undetermined")
    return options.where("boundary");
  if (finding.code == "empty-programme") return options.where("phase");
  if (finding.code == "missing-fibres" || finding.code == "fibre-not-unit") return options.where("fibre");
  if (finding.code.starts_with("mesh-") || finding.code.ends_with("-mesh")) return options.where("mesh");
  return options.where();
}

void Mistakes::error(const Options& entry, std::string code, std::string message, std::string help) {
  take(data::InputError(std::move(code), std::move(message), std::move(help)), entry);
}

void Mistakes::take(const std::vector<data::Diagnostic>& found, const Options& entry,
                    const std::string& prefix) {
  for (data::Diagnostic d : found) {
    d.message = prefix + d.message;
    if (!d.where) {
      d.where = place_in(entry, d.message);
      if (d.where->file.empty()) d.where.reset();  // options that were made in memory
    }
    list_.push_back(std::move(d));
  }
}

void Mistakes::take_checked(const std::vector<data::Diagnostic>& found, const Options& options) {
  for (data::Diagnostic d : found) {
    if (d.severity != data::Severity::error) continue;
    d.where = place_of(d, options);
    if (d.where->file.empty()) d.where.reset();
    list_.push_back(std::move(d));
  }
}

void Mistakes::only_keys(const Options& entry, const std::vector<std::string>& allowed,
                         const std::string& owner) {
  for (const auto& [key, value] : entry.values()) {
    if (std::find(allowed.begin(), allowed.end(), key) != allowed.end()) continue;
    error(entry, "unused-option", fmt::format("{} has no use for `{}`", owner, key),
          fmt::format("it takes {}", fmt::join(allowed, ", ")));
  }
}

bool Mistakes::need(const Options& entry, const std::string& key, const std::string& owner,
                    const std::string& help) {
  if (entry.has(key)) return true;
  error(entry, "missing-option", fmt::format("{} needs `{}`", owner, key), help);
  return false;
}

}  // namespace brachium::pipelines
