#include "pipelines/options.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <stdexcept>
#include <type_traits>

#include "data/model/units.hpp"

namespace brachium::pipelines {
namespace {

using data::Diagnostic;
using data::Severity;
using io::TomlNode;

std::string with_article(OptionType type) {
  return type == OptionType::boolean ? to_string(type) : "a " + to_string(type);
}

std::string bound_text(double bound) {
  return fmt::format("{:g}", bound);
}

class Reader {
 public:
  Reader(const std::string& owner, std::vector<Diagnostic>& diagnostics)
      : owner_(owner), diagnostics_(diagnostics) {}

  Options read(const TomlNode& table, std::span<const OptionSpec> specs,
               std::span<const std::string> reserved) {
    unknown_keys(table, specs, reserved);
    Options options;
    options.set_where({}, table.where);
    for (const OptionSpec& spec : specs) {
      if (const TomlNode* node = table.find(spec.key)) {
        if (auto value = read_value(spec, *node)) options.set(spec.key, std::move(*value));
        note_places(spec.key, *node, options);
      } else if (spec.fallback) {
        options.set(spec.key, *spec.fallback);
      } else if (!spec.optional && !unit_mistakes_.contains(spec.key)) {
        error("missing-option", fmt::format("{} needs the option `{}`", owner_, spec.key), table.where,
              spec.doc);
      }
    }
    return options;
  }

 private:
  static void note_places(const std::string& key, const TomlNode& node, Options& options) {
    options.set_where(key, node.where);
    for (std::size_t i = 0; i < node.items.size(); ++i)
      options.set_where(fmt::format("{}[{}]", key, i), node.items[i].where);
    for (const auto& [name, member] : node.members) options.set_where(key + "." + name, member.key_where);
  }

  void error(const char* code, std::string message, const data::SourceSpan& where, std::string help = {}) {
    diagnostics_.push_back({Severity::error, code, std::move(message), where, std::move(help)});
  }

  void unknown_keys(const TomlNode& table, std::span<const OptionSpec> specs,
                    std::span<const std::string> reserved) {
    std::vector<std::string> known;
    for (const OptionSpec& spec : specs) known.push_back(spec.key);
    for (const auto& [key, value] : table.members) {
      if (std::find(reserved.begin(), reserved.end(), key) != reserved.end()) continue;
      if (std::find(known.begin(), known.end(), key) != known.end()) continue;
      const auto same_stem = std::find_if(specs.begin(), specs.end(), [&](const OptionSpec& spec) {
        return !spec.unit.empty() && spec.unit != "1" &&
               data::split_unit(spec.key).name == data::split_unit(key).name;
      });
      if (same_stem != specs.end()) {
        unit_mistakes_.insert(same_stem->key);
        error("wrong-unit",
              fmt::format("`{}` is not an option of {}: it is given in {}", key, owner_, same_stem->unit),
              value.key_where,
              fmt::format("write `{}`, with the value in {}", same_stem->key, same_stem->unit));
      } else {
        std::vector<std::string> candidates = known;
        candidates.insert(candidates.end(), reserved.begin(), reserved.end());
        error("unknown-key", fmt::format("`{}` is not an option of {}", key, owner_), value.key_where,
              data::suggest(key, candidates));
      }
    }
  }

  void wrong_type(const OptionSpec& spec, const TomlNode& node) {
    error("wrong-type",
          fmt::format("`{}` of {} must be {}, not {}", spec.key, owner_, with_article(spec.type),
                      io::describe(node.kind)),
          node.where);
  }

  bool in_range(const OptionSpec& spec, double value, const TomlNode& node) {
    const bool low = spec.lower && (spec.lower_open ? !(value > *spec.lower) : !(value >= *spec.lower));
    const bool high = spec.upper && (spec.upper_open ? !(value < *spec.upper) : !(value <= *spec.upper));
    if (std::isfinite(value) && !low && !high) return true;
    const std::string range = range_text(spec);
    error("out-of-range", fmt::format("`{}` = {:g} of {} is out of range", spec.key, value, owner_),
          node.where, range.empty() ? "it must be a finite number" : "allowed: " + range);
    return false;
  }

  bool is_allowed(const OptionSpec& spec, const std::string& value, const TomlNode& node) {
    if (spec.allowed.empty() ||
        std::find(spec.allowed.begin(), spec.allowed.end(), value) != spec.allowed.end())
      return true;
    error("unknown-value", fmt::format("`{}` is not a value of `{}` of {}", value, spec.key, owner_),
          node.where, data::suggest(value, spec.allowed));
    return false;
  }

  std::optional<OptionValue> read_value(const OptionSpec& spec, const TomlNode& node) {
    const bool numeric = node.kind == TomlNode::Kind::number || node.kind == TomlNode::Kind::integer;
    switch (spec.type) {
      case OptionType::number:
        if (!numeric) break;
        if (!in_range(spec, node.number, node)) return std::nullopt;
        return node.number;
      case OptionType::integer:
        if (node.kind != TomlNode::Kind::integer) break;
        if (!in_range(spec, node.number, node)) return std::nullopt;
        return node.integer;
      case OptionType::boolean:
        if (node.kind != TomlNode::Kind::boolean) break;
        return node.boolean;
      case OptionType::text:
        if (node.kind != TomlNode::Kind::text) break;
        if (!is_allowed(spec, node.text, node)) return std::nullopt;
        return node.text;
      case OptionType::numbers:
        return read_list<double>(spec, node);
      case OptionType::texts:
        return read_list<std::string>(spec, node);
      case OptionType::table:
        if (node.kind != TomlNode::Kind::table) break;
        return std::vector<Options>{nested(spec, node)};
      case OptionType::tables:
        return read_tables(spec, node);
      case OptionType::number_map:
        return read_map(spec, node);
    }
    wrong_type(spec, node);
    return std::nullopt;
  }

  /// A list of numbers or texts; a single value stands for a list of one.
  template <class T>
  std::optional<OptionValue> read_list(const OptionSpec& spec, const TomlNode& node) {
    std::vector<T> values;
    bool good = true;
    const auto add = [&](const TomlNode& item) {
      if constexpr (std::is_same_v<T, double>) {
        if (item.kind != TomlNode::Kind::number && item.kind != TomlNode::Kind::integer)
          return wrong_type(spec, item), false;
        values.push_back(item.number);
        return in_range(spec, item.number, item);
      } else {
        if (item.kind != TomlNode::Kind::text) return wrong_type(spec, item), false;
        values.push_back(item.text);
        return is_allowed(spec, item.text, item);
      }
    };
    if (node.kind == TomlNode::Kind::array) {
      for (const TomlNode& item : node.items) good = add(item) && good;
    } else {
      good = add(node);
    }
    if (good && spec.length > 0 && values.size() != spec.length) {
      error("wrong-length",
            fmt::format("`{}` of {} has {} entries, not {}", spec.key, owner_, values.size(), spec.length),
            node.where, spec.doc);
      good = false;
    }
    if (!good) return std::nullopt;
    return OptionValue(std::move(values));
  }

  /// { region = 0.5 }; a plain number stands for all.
  std::optional<OptionValue> read_map(const OptionSpec& spec, const TomlNode& node) {
    const auto is_number = [](const TomlNode& n) {
      return n.kind == TomlNode::Kind::number || n.kind == TomlNode::Kind::integer;
    };
    std::map<std::string, double> values;
    if (is_number(node)) {
      if (!in_range(spec, node.number, node)) return std::nullopt;
      return std::map<std::string, double>{{"*", node.number}};
    }
    if (node.kind != TomlNode::Kind::table) {
      wrong_type(spec, node);
      return std::nullopt;
    }
    bool good = true;
    for (const auto& [key, member] : node.members) {
      if (!is_number(member)) {
        error("wrong-type",
              fmt::format("`{}.{}` of {} must be a number, not {}", spec.key, key, owner_,
                          io::describe(member.kind)),
              member.where);
        good = false;
      } else {
        good = in_range(spec, member.number, member) && good;
        values[key] = member.number;
      }
    }
    if (!good) return std::nullopt;
    return OptionValue(std::move(values));
  }

  Options nested(const OptionSpec& spec, const TomlNode& node) {
    return Reader(fmt::format("`{}` of {}", spec.key, owner_), diagnostics_).read(node, spec.fields, {});
  }

  std::optional<OptionValue> read_tables(const OptionSpec& spec, const TomlNode& node) {
    const bool list = node.kind == TomlNode::Kind::array &&
                      std::all_of(node.items.begin(), node.items.end(),
                                  [](const TomlNode& n) { return n.kind == TomlNode::Kind::table; });
    if (!list) {
      wrong_type(spec, node);
      return std::nullopt;
    }
    std::vector<Options> values;
    for (const TomlNode& item : node.items) values.push_back(nested(spec, item));
    return OptionValue(std::move(values));
  }

  const std::string owner_;
  std::vector<Diagnostic>& diagnostics_;
  std::set<std::string> unit_mistakes_;  ///< options that were given, but in another unit
};

TomlNode value_tree(const OptionValue& value, const OptionSpec* spec) {
  return std::visit(
      [&](const auto& v) -> TomlNode {
        using T = std::decay_t<decltype(v)>;
        if constexpr (std::is_same_v<T, std::map<std::string, double>>) {
          TomlNode table = TomlNode::table();
          for (const auto& [key, number] : v) table.member(key) = TomlNode::of(number);
          return table;
        } else if constexpr (std::is_same_v<T, std::vector<Options>>) {
          if (spec && spec->type == OptionType::table) return options_tree(v.front(), spec->fields);
          TomlNode list;
          list.kind = TomlNode::Kind::array;
          for (const Options& o : v) {
            if (spec) {
              list.items.push_back(options_tree(o, spec->fields));
            } else {
              TomlNode table = TomlNode::table();
              for (const auto& [key, entry] : o.values()) table.member(key) = value_tree(entry, nullptr);
              list.items.push_back(std::move(table));
            }
          }
          return list;
        } else {
          return TomlNode::of(v);
        }
      },
      value);
}

template <class T>
const T& get(const Options& options, const std::string& key) {
  const auto found = options.values().find(key);
  if (found == options.values().end())
    throw std::logic_error(fmt::format("the specification has no option `{}` with a value", key));
  const T* value = std::get_if<T>(&found->second);
  if (!value) throw std::logic_error(fmt::format("option `{}` is read as another type than specified", key));
  return *value;
}

}  // namespace

double Options::number(const std::string& key) const {
  return get<double>(*this, key);
}
std::int64_t Options::integer(const std::string& key) const {
  return get<std::int64_t>(*this, key);
}
bool Options::boolean(const std::string& key) const {
  return get<bool>(*this, key);
}
const std::string& Options::text(const std::string& key) const {
  return get<std::string>(*this, key);
}
const std::vector<double>& Options::numbers(const std::string& key) const {
  return get<std::vector<double>>(*this, key);
}
const std::vector<std::string>& Options::texts(const std::string& key) const {
  return get<std::vector<std::string>>(*this, key);
}
const std::vector<Options>& Options::tables(const std::string& key) const {
  return get<std::vector<Options>>(*this, key);
}

const Options& Options::table(const std::string& key) const {
  return tables(key).front();
}
const Options* Options::maybe_table(const std::string& key) const {
  return has(key) ? &table(key) : nullptr;
}
const std::map<std::string, double>& Options::number_map(const std::string& key) const {
  return get<std::map<std::string, double>>(*this, key);
}

std::optional<double> Options::maybe_number(const std::string& key) const {
  return has(key) ? std::optional(number(key)) : std::nullopt;
}

std::optional<std::string> Options::maybe_text(const std::string& key) const {
  return has(key) ? std::optional(text(key)) : std::nullopt;
}

const data::SourceSpan& Options::where(const std::string& path) const {
  static const data::SourceSpan nowhere;
  auto found = places_.find(path);
  if (found == places_.end()) found = places_.find(path.substr(0, path.find_first_of(".[")));
  if (found == places_.end()) found = places_.find({});
  return found == places_.end() ? nowhere : found->second;
}

Options parse_options(const TomlNode& table, std::span<const OptionSpec> specs, const std::string& owner,
                      std::span<const std::string> reserved, std::vector<Diagnostic>& diagnostics) {
  return Reader(owner, diagnostics).read(table, specs, reserved);
}

Options options_from_text(const std::string& toml, const StageSpec& stage) {
  std::vector<Diagnostic> diagnostics;
  Options options = parse_options(io::parse_toml(toml, "options"), stage.options,
                                  fmt::format("stage `{}`", stage.name), {}, diagnostics);
  io::raise_if_errors(diagnostics);
  return options;
}

TomlNode options_tree(const Options& options, std::span<const OptionSpec> specs) {
  TomlNode table = TomlNode::table();
  for (const OptionSpec& spec : specs) {
    const auto found = options.values().find(spec.key);
    if (found != options.values().end()) table.member(spec.key) = value_tree(found->second, &spec);
  }
  return table;
}

void for_each_file(
    Options& options, std::span<const OptionSpec> specs,
    const std::function<void(const OptionSpec&, std::string&, const data::SourceSpan&)>& visit) {
  for (const OptionSpec& spec : specs) {
    const auto found = options.values().find(spec.key);
    if (found == options.values().end()) continue;
    OptionValue value = found->second;
    if (std::string* text = std::get_if<std::string>(&value); text && spec.is_file) {
      visit(spec, *text, options.where(spec.key));
    } else if (auto* tables = std::get_if<std::vector<Options>>(&value)) {
      for (Options& nested : *tables) for_each_file(nested, spec.fields, visit);
    } else {
      continue;
    }
    options.set(spec.key, std::move(value));
  }
}

std::string value_text(const OptionValue& value) {
  return node_text(value_tree(value, nullptr));
}

std::string node_text(const TomlNode& value) {
  if (value.kind == TomlNode::Kind::table) {
    std::string out = "{";
    for (const auto& [key, member] : value.members)
      out += (out.size() > 1 ? ", " : " ") + key + " = " + node_text(member);
    return out + " }";
  }
  if (value.kind == TomlNode::Kind::array) {
    std::string out = "[";
    for (const TomlNode& item : value.items) out += (out.size() > 1 ? ", " : "") + node_text(item);
    return out + "]";
  }
  TomlNode root = TomlNode::table();
  root.member("v") = value;
  const std::string text = io::write_toml(root);  // "v = ...\n"
  return text.substr(4, text.size() - 5);
}

std::string range_text(const OptionSpec& spec) {
  const std::string unit = spec.unit.empty() || spec.unit == "1" ? "" : " " + spec.unit;
  if (spec.lower && spec.upper) {
    return fmt::format("{}{} to {}{}{}", spec.lower_open ? "more than " : "", bound_text(*spec.lower),
                       spec.upper_open ? "less than " : "", bound_text(*spec.upper), unit);
  }
  if (spec.lower)
    return fmt::format("{} {}{}", spec.lower_open ? "greater than" : "at least", bound_text(*spec.lower),
                       unit);
  if (spec.upper)
    return fmt::format("{} {}{}", spec.upper_open ? "less than" : "at most", bound_text(*spec.upper), unit);
  return {};
}

std::string to_string(OptionType type) {
  switch (type) {
    case OptionType::number:
      return "number";
    case OptionType::integer:
      return "whole number";
    case OptionType::boolean:
      return "true or false";
    case OptionType::text:
      return "text";
    case OptionType::numbers:
      return "list of numbers";
    case OptionType::texts:
      return "list of texts";
    case OptionType::table:
      return "table";
    case OptionType::tables:
      return "list of tables";
    case OptionType::number_map:
      return "number, or table of names with numbers";
  }
  return "value";
}

}  // namespace brachium::pipelines
