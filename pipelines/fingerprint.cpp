#include "pipelines/fingerprint.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <set>
#include <vector>

#include "data/io/atomic_file.hpp"
#include "pipelines/options.hpp"
#include "pipelines/sha256.hpp"

namespace brachium::pipelines {
namespace {

namespace fs = std::filesystem;

std::string shortened(const std::string& text) {
  return text.size() <= 48 ? text : text.substr(0, 45) + "...";
}

std::optional<std::string> part(const Fingerprint& fingerprint, const std::string& key) {
  const auto found = fingerprint.find(key);
  return found == fingerprint.end() ? std::nullopt : std::optional(found->second);
}

std::string change_text(const std::string& key, const std::optional<std::string>& was,
                        const std::optional<std::string>& is) {
  const std::size_t dot = key.find('.');
  const std::string group = key.substr(0, dot), name = dot == std::string::npos ? "" : key.substr(dot + 1);
  if (group == "option") {
    if (!was) return fmt::format("option {} is new ({})", name, shortened(*is));
    if (!is) return fmt::format("option {} is gone", name);
    return fmt::format("option {} changed {} -> {}", name, shortened(*was), shortened(*is));
  }
  if (group == "input") {
    const std::string port = name.substr(0, name.rfind('.'));
    const auto source = [](const std::string& text) { return text.substr(0, text.rfind(' ')); };
    if (!was) return fmt::format("input {} now reads `{}` too", port, source(*is));
    if (!is) return fmt::format("input {} no longer reads `{}`", port, source(*was));
    if (source(*was) != source(*is))
      return fmt::format("input {} reads `{}` instead of `{}`", port, source(*is), source(*was));
    const bool stage = !source(*is).starts_with("file:") && !source(*is).starts_with("recordings:");
    return fmt::format("input `{}` {}", source(*is), stage ? "ran again" : "has another content");
  }
  if (group == "file") {
    if (!was) return fmt::format("the recording `{}` is new", name);
    return fmt::format("the recording `{}` {}", name, is ? "changed" : "is gone");
  }
  if (group == "asset")
    return fmt::format("the file `{}` {}", name, !was ? "is new" : is ? "changed" : "is gone");
  if (group == "failed") return "it failed before";
  if (group == "program")
    return fmt::format("the program changed {} -> {}", was.value_or("unknown"), is.value_or("unknown"));
  if (group == "stage")
    return fmt::format("it ran as {}, now as {}", was.value_or("unknown"), is.value_or("unknown"));
  if (group == "scene")
    return was && is ? "the scene changed" : is ? "a scene was added" : "the scene is gone";
  return fmt::format("{} changed {} -> {}", key, shortened(was.value_or("none")),
                     shortened(is.value_or("none")));
}

}  // namespace

std::string digest(const Fingerprint& fingerprint) {
  Sha256 hash;
  for (const auto& [key, value] : fingerprint)
    hash.add(fmt::format("{}:{}={}:{};", key.size(), key, value.size(), value));
  return hash.finish();
}

Fingerprint stage_fingerprint(const StageDefinition& stage) {
  Fingerprint parts;
  parts["stage"] = fmt::format("{} (version {})", stage.spec->name, stage.spec->version);
  for (const auto& [key, value] : stage.options.values()) parts["option." + key] = value_text(value);
  std::string trials;
  for (const std::string& pattern : stage.trials) trials += (trials.empty() ? "" : ", ") + pattern;
  parts["trials"] = stage.trials.empty() ? "all" : trials;
  return parts;
}

std::string difference_text(const Fingerprint& stored, const Fingerprint& wanted) {
  // Another stage altogether: that its options differ as well says nothing more.
  if (part(stored, "stage") != part(wanted, "stage"))
    return change_text("stage", part(stored, "stage"), part(wanted, "stage"));
  std::set<std::string> keys;
  for (const auto& [key, value] : stored) keys.insert(key);
  for (const auto& [key, value] : wanted) keys.insert(key);
  std::vector<std::string> changes;
  for (const std::string& key : keys) {
    const auto was = part(stored, key), is = part(wanted, key);
    if (was != is) changes.push_back(change_text(key, was, is));
  }
  std::string text;
  const std::size_t shown = std::min<std::size_t>(changes.size(), 4);
  for (std::size_t i = 0; i < shown; ++i) text += (i ? ", " : "") + changes[i];
  if (shown < changes.size()) text += fmt::format(" and {} more changes", changes.size() - shown);
  return text;
}

FileDigests::FileDigests(fs::path memory) : memory_(std::move(memory)) {
  std::error_code ignored;
  if (!fs::is_regular_file(memory_, ignored)) return;
  try {
    const nlohmann::json all = nlohmann::json::parse(io::read_text(memory_));
    for (const auto& [file, entry] : all.items()) {
      entries_[file] = {entry.at("size"), entry.at("changed"), entry.at("sha256")};
    }
  } catch (const std::exception&) {
    entries_.clear();  // only a memory: what it knew is found out again
  }
}

std::string FileDigests::of(const fs::path& file) {
  const std::string key = fs::absolute(file).lexically_normal().string();
  std::error_code failed;
  const std::uintmax_t size = fs::file_size(file, failed);
  const long long changed = failed ? 0 : fs::last_write_time(file, failed).time_since_epoch().count();
  const auto known = entries_.find(key);
  if (!failed && known != entries_.end() && known->second.size == size && known->second.changed == changed) {
    return used_[key] = known->second.digest;
  }
  const std::string digest = sha256_of_file(file);
  entries_[key] = {size, changed, digest};
  return used_[key] = digest;
}

void FileDigests::save() const {
  nlohmann::json all = nlohmann::json::object();
  for (const auto& [file, entry] : entries_)
    all[file] = {{"size", entry.size}, {"changed", entry.changed}, {"sha256", entry.digest}};
  io::write_text_atomically(memory_,
                            all.dump(1, ' ', false, nlohmann::json::error_handler_t::replace) + "\n");
}

}  // namespace brachium::pipelines
