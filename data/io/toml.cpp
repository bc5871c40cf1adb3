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
    if (s.line >= 1 && static_cast<std::size_t>(s.line) <= lines.size())
      s.text = lines[static_cast<std::size_t>(s.line - 1)];
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

}  // namespace

const TomlNode* TomlNode::find(const std::string& key) const {
  for (const auto& [name, value] : members) {
    if (name == key) return &value;
  }
  return nullptr;
}

TomlNode* TomlNode::find(const std::string& key) {
  return const_cast<TomlNode*>(std::as_const(*this).find(key));
}

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

TomlNode TomlNode::table() {
  return TomlNode{};
}

std::string describe(TomlNode::Kind kind) {
  switch (kind) {
    case TomlNode::Kind::boolean:
      return "true or false";
    case TomlNode::Kind::integer:
      return "a whole number";
    case TomlNode::Kind::number:
      return "a number";
    case TomlNode::Kind::text:
      return "a text";
    case TomlNode::Kind::array:
      return "a list";
    case TomlNode::Kind::table:
      return "a table";
  }
  return "a value";
}

TomlNode parse_toml(const std::string& text, const std::string& file_name) {
  const std::vector<std::string> lines = lines_of(text);
  const Converter convert{file_name, lines};
  try {
    return convert(static_cast<const toml::node&>(toml::parse(text, file_name)));
  } catch (const toml::parse_error& e) {
    throw InputError(Diagnostic{Severity::error, "toml-syntax", std::string(e.description()),
                                convert.span(e.source()), "this is not valid TOML"});
  }
}

TomlNode read_toml(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  std::error_code ignored;
  if (!stream || std::filesystem::is_directory(file, ignored)) {
    throw InputError("missing-file", fmt::format("cannot read `{}`", file.string()),
                     "check the path; it is relative to the current folder");
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

}  // namespace brachium::io
