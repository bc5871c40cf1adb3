#include "data/io/toml.hpp"

#include <fmt/format.h>
#include <toml++/toml.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>
#include <memory>
#include <sstream>

namespace brachium::io {
namespace {

using data::Diagnostic;
using data::InputError;
using data::Severity;
using data::SourceSpan;

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) {
    if (!line.empty() && line.back() == '\r') line.pop_back();
    lines.push_back(line);
  }
  return lines;
}

struct Converter {
  const std::string& file;
  const std::vector<std::string>& lines;

  SourceSpan span(const toml::source_region& region) const {
    SourceSpan s;
    s.file = file;
    s.line = static_cast<int>(region.begin.line);
    s.column = static_cast<int>(region.begin.column);
    if (region.end.line == region.begin.line && region.end.column > region.begin.column) {
      s.length = static_cast<int>(region.end.column - region.begin.column);
    }
    if (s.line >= 1 && static_cast<std::size_t>(s.line) <= lines.size()) s.text = lines[static_cast<std::size_t>(s.line - 1)];
    return s;
  }

  TomlNode operator()(const toml::node& node) const {
    TomlNode out;
    out.where = span(node.source());
    switch (node.type()) {
      case toml::node_type::table: {
        out.kind = TomlNode::Kind::table;
        for (const auto& [key, value] : *node.as_table()) {
          TomlNode member = (*this)(value);
          member.key_where = span(key.source());
          out.members.emplace_back(std::string(key.str()), std::move(member));
        }
        // toml++ sorts keys; the file's order is what users expect to see again.
        std::stable_sort(out.members.begin(), out.members.end(), [](const auto& a, const auto& b) {
          return std::pair(a.second.key_where.line, a.second.key_where.column) <
                 std::pair(b.second.key_where.line, b.second.key_where.column);
        });
        break;
      }
      case toml::node_type::array:
        out.kind = TomlNode::Kind::array;
        for (const auto& item : *node.as_array()) out.items.push_back((*this)(item));
        break;
      case toml::node_type::string:
        out.kind = TomlNode::Kind::text;
        out.text = node.as_string()->get();
        break;
      case toml::node_type::integer:
        out.kind = TomlNode::Kind::integer;
        out.integer = node.as_integer()->get();
        out.number = static_cast<double>(out.integer);
        break;
      case toml::node_type::floating_point:
        out.kind = TomlNode::Kind::number;
        out.number = node.as_floating_point()->get();
        break;
      case toml::node_type::boolean:
        out.kind = TomlNode::Kind::boolean;
        out.boolean = node.as_boolean()->get();
        break;
      default: {
        // Dates and times: kept as the text that was written.
        std::ostringstream text;
        if (const auto* d = node.as_date()) text << *d;
        if (const auto* t = node.as_time()) text << *t;
        if (const auto* dt = node.as_date_time()) text << *dt;
        out.kind = TomlNode::Kind::text;
        out.text = text.str();
      }
    }
    return out;
  }
};

bool is_bare(const std::string& key) {
  return !key.empty() && key.find_first_not_of("ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789_-") == std::string::npos;
}

std::string quoted(const std::string& text) {
  std::string out = "\"";
  for (const char c : text) {
    switch (c) {
      case '"': out += "\\\""; break;
      case '\\': out += "\\\\"; break;
      case '\n': out += "\\n"; break;
      case '\t': out += "\\t"; break;
      case '\r': out += "\\r"; break;
      default:
        if (static_cast<unsigned char>(c) < 0x20 || c == 0x7F) {
          out += fmt::format("\\u{:04X}", static_cast<unsigned>(c));
        } else {
          out += c;
        }
    }
  }
  return out + "\"";
}

std::string key_text(const std::string& key) { return is_bare(key) ? key : quoted(key); }

std::string number_text(double value) {
  if (std::isnan(value)) return "nan";
  if (std::isinf(value)) return value > 0 ? "inf" : "-inf";
  std::string s = fmt::format("{}", value);
  if (s.find_first_of(".en") == std::string::npos) s += ".0";
  return s;
}

bool is_table_array(const TomlNode& node) {
  if (node.kind != TomlNode::Kind::array || node.items.empty()) return false;
  for (const TomlNode& item : node.items) {
    if (item.kind != TomlNode::Kind::table) return false;
  }
  return true;
}

std::string inline_text(const TomlNode& node) {
  switch (node.kind) {
    case TomlNode::Kind::boolean: return node.boolean ? "true" : "false";
    case TomlNode::Kind::integer: return std::to_string(node.integer);
    case TomlNode::Kind::number: return number_text(node.number);
    case TomlNode::Kind::text: return quoted(node.text);
    case TomlNode::Kind::array: {
      std::string out = "[";
      for (std::size_t i = 0; i < node.items.size(); ++i) out += (i ? ", " : "") + inline_text(node.items[i]);
      return out + "]";
    }
    case TomlNode::Kind::table: {
      std::string out = "{ ";
      for (std::size_t i = 0; i < node.members.size(); ++i) {
        out += (i ? ", " : "") + key_text(node.members[i].first) + " = " + inline_text(node.members[i].second);
      }
      return out + " }";
    }
  }
  return {};
}

void write_table(const TomlNode& table, const std::string& path, std::string& out) {
  for (const auto& [key, value] : table.members) {
    if (value.kind == TomlNode::Kind::table || is_table_array(value)) continue;
    out += key_text(key) + " = " + inline_text(value) + "\n";
  }
  for (const auto& [key, value] : table.members) {
    const std::string inner = path.empty() ? key_text(key) : path + "." + key_text(key);
    if (value.kind == TomlNode::Kind::table) {
      out += "\n[" + inner + "]\n";
      write_table(value, inner, out);
    } else if (is_table_array(value)) {
      for (const TomlNode& item : value.items) {
        out += "\n[[" + inner + "]]\n";
        write_table(item, inner, out);
      }
    }
  }
}

}  // namespace

const TomlNode* TomlNode::find(const std::string& key) const {
  for (const auto& [name, value] : members) {
    if (name == key) return &value;
  }
  return nullptr;
}

TomlNode* TomlNode::find(const std::string& key) { return const_cast<TomlNode*>(std::as_const(*this).find(key)); }

TomlNode& TomlNode::member(const std::string& key) {
  kind = Kind::table;
  if (TomlNode* existing = find(key)) return *existing;
  return members.emplace_back(key, TomlNode{}).second;
}

TomlNode TomlNode::of(bool value) {
  TomlNode n;
  n.kind = Kind::boolean;
  n.boolean = value;
  return n;
}

TomlNode TomlNode::of(std::int64_t value) {
  TomlNode n;
  n.kind = Kind::integer;
  n.integer = value;
  n.number = static_cast<double>(value);
  return n;
}

TomlNode TomlNode::of(double value) {
  TomlNode n;
  n.kind = Kind::number;
  n.number = value;
  return n;
}

TomlNode TomlNode::of(std::string value) {
  TomlNode n;
  n.kind = Kind::text;
  n.text = std::move(value);
  return n;
}

TomlNode TomlNode::of(std::vector<double> values) {
  TomlNode n;
  n.kind = Kind::array;
  for (const double v : values) n.items.push_back(of(v));
  return n;
}

TomlNode TomlNode::of(std::vector<std::string> values) {
  TomlNode n;
  n.kind = Kind::array;
  for (std::string& v : values) n.items.push_back(of(std::move(v)));
  return n;
}

TomlNode TomlNode::table() { return TomlNode{}; }

std::string describe(TomlNode::Kind kind) {
  switch (kind) {
    case TomlNode::Kind::boolean: return "true or false";
    case TomlNode::Kind::integer: return "a whole number";
    case TomlNode::Kind::number: return "a number";
    case TomlNode::Kind::text: return "a text";
    case TomlNode::Kind::array: return "a list";
    case TomlNode::Kind::table: return "a table";
  }
  return "a value";
}

TomlNode parse_toml(const std::string& text, const std::string& file_name) {
  const std::vector<std::string> lines = lines_of(text);
  const Converter convert{file_name, lines};
  try {
    return convert(static_cast<const toml::node&>(toml::parse(text, file_name)));
  } catch (const toml::parse_error& e) {
    throw InputError(Diagnostic{Severity::error, "toml-syntax", std::string(e.description()), convert.span(e.source()),
                                "this is not valid TOML"});
  }
}

TomlNode read_toml(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  std::error_code ignored;
  if (!stream || std::filesystem::is_directory(file, ignored)) {
    throw InputError("missing-file", fmt::format("cannot read `{}`", file.string()), "check the path; it is relative to the current folder");
  }
  std::ostringstream text;
  text << stream.rdbuf();
  return parse_toml(text.str(), file.string());
}

TomlNode parse_toml_value(const std::string& text, const std::string& origin) {
  TomlNode value;
  try {
    const TomlNode root = parse_toml("value = " + text + "\n", origin);
    value = *root.find("value");
  } catch (const InputError&) {
    value = TomlNode::of(text);
  }
  const auto place = [&](auto& self, TomlNode& node) -> void {
    node.where = {origin, 0, 0, 1, {}};
    node.key_where = node.where;
    for (TomlNode& item : node.items) self(self, item);
    for (auto& [key, member] : node.members) self(self, member);
  };
  place(place, value);
  return value;
}

std::string write_toml(const TomlNode& root) {
  std::string out;
  write_table(root, {}, out);
  return out;
}

TomlTable::TomlTable(const TomlNode& node, std::vector<Diagnostic>& diagnostics, std::string context)
    : node_(&node), diagnostics_(&diagnostics), context_(std::move(context)) {}

const TomlNode* TomlTable::take(const std::string& key) {
  known_.insert(key);
  return node_->find(key);
}

void TomlTable::wrong_type(const std::string& key, const std::string& wanted, const TomlNode& got) {
  diagnostics_->push_back({Severity::error, "wrong-type",
                           fmt::format("`{}`{} must be {}, not {}", key, context_.empty() ? "" : " of " + context_, wanted, describe(got.kind)),
                           got.where, {}});
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
    if ((item.kind != TomlNode::Kind::number && item.kind != TomlNode::Kind::integer) || !std::isfinite(item.number)) {
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
  if (!has(key)) error("missing-key", fmt::format("`{}` is missing{}", key, context_.empty() ? "" : " in " + context_));
  return number(key).value_or(std::numeric_limits<double>::quiet_NaN());
}

std::string TomlTable::require_text(const std::string& key) {
  if (!has(key)) error("missing-key", fmt::format("`{}` is missing{}", key, context_.empty() ? "" : " in " + context_));
  return text(key).value_or(std::string{});
}

double TomlTable::positive(const std::string& key, std::optional<double> fallback) {
  if (!has(key) && fallback) {
    known_.insert(key);
    return *fallback;
  }
  const double v = require_number(key);
  if (!std::isnan(v) && !(v > 0.0)) error("out-of-range", fmt::format("`{}` must be greater than 0, not {}", key, v), key);
  return v;
}

double TomlTable::non_negative(const std::string& key, std::optional<double> fallback) {
  if (!has(key) && fallback) {
    known_.insert(key);
    return *fallback;
  }
  const double v = require_number(key);
  if (!std::isnan(v) && !(v >= 0.0)) error("out-of-range", fmt::format("`{}` must be 0 or greater, not {}", key, v), key);
  return v;
}

void TomlTable::error(const std::string& code, const std::string& message, const std::string& key, const std::string& help) {
  diagnostics_->push_back({Severity::error, code, message, span_of(key), help});
}

void TomlTable::warning(const std::string& code, const std::string& message, const std::string& key, const std::string& help) {
  diagnostics_->push_back({Severity::warning, code, message, span_of(key), help});
}

SourceSpan TomlTable::span_of(const std::string& key) const {
  const TomlNode* n = key.empty() ? nullptr : node_->find(key);
  return n ? n->where : node_->where;
}

void TomlTable::finish() {
  const std::vector<std::string> known(known_.begin(), known_.end());
  for (const auto& [key, value] : node_->members) {
    if (known_.contains(key)) continue;
    diagnostics_->push_back({Severity::error, "unknown-key",
                             fmt::format("`{}` is not a key of {}", key, context_.empty() ? "this file" : context_),
                             value.key_where, data::suggest(key, known)});
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
