/// Reading a table key by key: every mistake is collected with its place, and what nobody asked for is a mistake too.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "data/io/toml.hpp"
#include "data/model/units.hpp"

namespace brachium::io {

using data::Diagnostic;
using data::InputError;
using data::Severity;
using data::SourceSpan;

TomlTable::TomlTable(const TomlNode& node, std::vector<Diagnostic>& diagnostics, std::string context)
    : node_(&node), diagnostics_(&diagnostics), context_(std::move(context)) {}

bool TomlTable::has(const std::string& key) const {
  asked_.insert(key);
  return node_->find(key) != nullptr;
}

const TomlNode* TomlTable::take(const std::string& key) {
  known_.insert(key);
  return node_->find(key);
}

void TomlTable::wrong_type(const std::string& key, const std::string& wanted, const TomlNode& got) {
  diagnostics_->push_back({Severity::error,
                           "wrong-type",
                           fmt::format("`{}`{} must be {}, not {}", key,
                                       context_.empty() ? "" : " of " + context_, wanted, describe(got.kind)),
                           got.where,
                           {}});
}

std::optional<double> TomlTable::number(const std::string& key) {
  const TomlNode* n = take(key);
  if (!n) return std::nullopt;
  if (n->kind != TomlNode::Kind::number && n->kind != TomlNode::Kind::integer) {
    wrong_type(key, "a number", *n);
    return std::nullopt;
  }
  if (!std::isfinite(n->number)) {
    error("out-of-range", fmt::format("`{}` must be a finite number", key), key);
    return std::nullopt;
  }
  return n->number;
}

std::optional<std::int64_t> TomlTable::integer(const std::string& key) {
  const TomlNode* n = take(key);
  if (!n) return std::nullopt;
  if (n->kind != TomlNode::Kind::integer) {
    wrong_type(key, "a whole number", *n);
    return std::nullopt;
  }
  return n->integer;
}

std::optional<bool> TomlTable::boolean(const std::string& key) {
  const TomlNode* n = take(key);
  if (!n) return std::nullopt;
  if (n->kind != TomlNode::Kind::boolean) {
    wrong_type(key, "true or false", *n);
    return std::nullopt;
  }
  return n->boolean;
}

std::optional<std::string> TomlTable::text(const std::string& key) {
  const TomlNode* n = take(key);
  if (!n) return std::nullopt;
  if (n->kind != TomlNode::Kind::text) {
    wrong_type(key, "a text", *n);
    return std::nullopt;
  }
  return n->text;
}

std::optional<std::vector<double>> TomlTable::numbers(const std::string& key) {
  const TomlNode* n = take(key);
  if (!n) return std::nullopt;
  if (n->kind != TomlNode::Kind::array) {
    wrong_type(key, "a list of numbers", *n);
    return std::nullopt;
  }
  std::vector<double> values;
  for (const TomlNode& item : n->items) {
    if ((item.kind != TomlNode::Kind::number && item.kind != TomlNode::Kind::integer) ||
        !std::isfinite(item.number)) {
      wrong_type(key, "a list of finite numbers", item);
      return std::nullopt;
    }
    values.push_back(item.number);
  }
  return values;
}

std::optional<std::vector<std::string>> TomlTable::texts(const std::string& key) {
  const TomlNode* n = take(key);
  if (!n) return std::nullopt;
  if (n->kind == TomlNode::Kind::text) return std::vector<std::string>{n->text};
  if (n->kind != TomlNode::Kind::array) {
    wrong_type(key, "a list of texts", *n);
    return std::nullopt;
  }
  std::vector<std::string> values;
  for (const TomlNode& item : n->items) {
    if (item.kind != TomlNode::Kind::text) {
      wrong_type(key, "a list of texts", item);
      return std::nullopt;
    }
    values.push_back(item.text);
  }
  return values;
}

std::optional<TomlTable> TomlTable::table(const std::string& key) {
  const TomlNode* n = take(key);
  if (!n) return std::nullopt;
  if (n->kind != TomlNode::Kind::table) {
    wrong_type(key, "a table", *n);
    return std::nullopt;
  }
  return TomlTable(*n, *diagnostics_, fmt::format("`{}`", key));
}

std::vector<TomlTable> TomlTable::tables(const std::string& key) {
  const TomlNode* n = take(key);
  std::vector<TomlTable> out;
  if (!n) return out;
  if (n->kind != TomlNode::Kind::array) {
    wrong_type(key, fmt::format("a list of tables, [[{}]]", key), *n);
    return out;
  }
  for (const TomlNode& item : n->items) {
    if (item.kind != TomlNode::Kind::table) {
      wrong_type(key, fmt::format("a list of tables, [[{}]]", key), item);
      continue;
    }
    out.emplace_back(item, *diagnostics_, fmt::format("[[{}]]", key));
  }
  return out;
}

double TomlTable::require_number(const std::string& key) {
  if (!has(key))
    error("missing-key", fmt::format("`{}` is missing{}", key, context_.empty() ? "" : " in " + context_));
  return number(key).value_or(std::numeric_limits<double>::quiet_NaN());
}

std::string TomlTable::require_text(const std::string& key) {
  if (!has(key))
    error("missing-key", fmt::format("`{}` is missing{}", key, context_.empty() ? "" : " in " + context_));
  return text(key).value_or(std::string{});
}

double TomlTable::positive(const std::string& key, std::optional<double> fallback) {
  if (!has(key) && fallback) {
    known_.insert(key);
    return *fallback;
  }
  const double v = require_number(key);
  if (!std::isnan(v) && !(v > 0.0))
    error("out-of-range", fmt::format("`{}` must be greater than 0, not {}", key, v), key);
  return v;
}

double TomlTable::non_negative(const std::string& key, std::optional<double> fallback) {
  if (!has(key) && fallback) {
    known_.insert(key);
    return *fallback;
  }
  const double v = require_number(key);
  if (!std::isnan(v) && !(v >= 0.0))
    error("out-of-range", fmt::format("`{}` must be 0 or greater, not {}", key, v), key);
  return v;
}

void TomlTable::error(const std::string& code, const std::string& message, const std::string& key,
                      const std::string& help) {
  diagnostics_->push_back({Severity::error, code, message, span_of(key), help});
}

void TomlTable::warning(const std::string& code, const std::string& message, const std::string& key,
                        const std::string& help) {
  diagnostics_->push_back({Severity::warning, code, message, span_of(key), help});
}

SourceSpan TomlTable::span_of(const std::string& key) const {
  const TomlNode* n = key.empty() ? nullptr : node_->find(key);
  return n ? n->where : node_->where;
}

void TomlTable::finish() {
  std::set<std::string> meant = known_;
  meant.insert(asked_.begin(), asked_.end());
  const std::vector<std::string> candidates(meant.begin(), meant.end());
  for (const auto& [key, value] : node_->members) {
    if (known_.contains(key)) continue;
    const std::string text =
        fmt::format("`{}` is not a key of {}", key, context_.empty() ? "this file" : context_);
    const data::NamedUnit given = data::split_unit(key);
    const auto right = std::ranges::find_if(candidates, [&](const std::string& candidate) {
      const data::NamedUnit known = data::split_unit(candidate);
      return !given.unit.empty() && !known.unit.empty() && known.name == given.name && candidate != key;
    });
    if (right != candidates.end()) {
      const std::string unit = data::split_unit(*right).unit;
      diagnostics_->push_back({Severity::error, "wrong-unit",
                               fmt::format("{}: it is given in {}", text, unit), value.key_where,
                               fmt::format("write `{}`, with the value in {}", *right, unit)});
    } else {
      diagnostics_->push_back(
          {Severity::error, "unknown-key", text, value.key_where, data::suggest(key, candidates)});
    }
  }
}

void raise_if_errors(const std::vector<Diagnostic>& diagnostics) {
  std::vector<Diagnostic> errors;
  for (const Diagnostic& d : diagnostics) {
    if (d.severity == Severity::error) errors.push_back(d);
  }
  if (!errors.empty()) throw InputError(std::move(errors));
}

}  // namespace brachium::io
