/// A tree of TOML values as text that reads back as the same tree.

#include <fmt/format.h>

#include <cmath>

#include "data/io/toml.hpp"

namespace brachium::io {
namespace {

bool is_bare(const std::string& key) {
  return !key.empty() &&
         key.find_first_not_of("ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789_-") ==
             std::string::npos;
}

std::string quoted(const std::string& text) {
  std::string out = "\"";
  for (const char c : text) {
    switch (c) {
      case '"':
        out += "\\\"";
        break;
      case '\\':
        out += "\\\\";
        break;
      case '\n':
        out += "\\n";
        break;
      case '\t':
        out += "\\t";
        break;
      case '\r':
        out += "\\r";
        break;
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

std::string key_text(const std::string& key) {
  return is_bare(key) ? key : quoted(key);
}

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
    case TomlNode::Kind::boolean:
      return node.boolean ? "true" : "false";
    case TomlNode::Kind::integer:
      return std::to_string(node.integer);
    case TomlNode::Kind::number:
      return number_text(node.number);
    case TomlNode::Kind::text:
      return quoted(node.text);
    case TomlNode::Kind::array: {
      std::string out = "[";
      for (std::size_t i = 0; i < node.items.size(); ++i) out += (i ? ", " : "") + inline_text(node.items[i]);
      return out + "]";
    }
    case TomlNode::Kind::table: {
      std::string out = "{ ";
      for (std::size_t i = 0; i < node.members.size(); ++i) {
        out +=
            (i ? ", " : "") + key_text(node.members[i].first) + " = " + inline_text(node.members[i].second);
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

std::string write_toml(const TomlNode& root) {
  std::string out;
  write_table(root, {}, out);
  return out;
}

}  // namespace brachium::io
