#include "data/io/session_description.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <set>

#include "data/io/template_text.hpp"
#include "data/io/toml.hpp"
#include "data/model/units.hpp"

namespace brachium::io {
namespace {

using data::Diagnostic;
using data::InputError;
using Variables = std::map<std::string, std::string>;

constexpr const char* override_origin = "--set";

/// Runs `action`; what it throws joins the table's mistakes, at the place of `key`.
template <class Action>
void at_key(TomlTable& table, const std::string& key, Action action) {
  try {
    action();
  } catch (const InputError& e) {
    for (const Diagnostic& d : e.diagnostics()) table.error(d.code, d.message, key, d.help);
  }
}

std::string filled(TomlTable& table, const std::string& key, const std::string& text,
                   const Variables& variables) {
  std::vector<std::string> unknown;
  std::string out = fill(text, variables, unknown);
  std::vector<std::string> known;
  for (const auto& [name, value] : variables) known.push_back(name);
  for (const std::string& name : unknown) {
    table.error("unknown-variable", fmt::format("`{{{}}}` is not a variable of this trial", name), key,
                data::suggest(name, known));
  }
  return out;
}

/// A value as it was written, for use as a variable.
std::optional<std::string> text_of(const TomlNode& node) {
  switch (node.kind) {
    case TomlNode::Kind::text:
      return node.text;
    case TomlNode::Kind::integer:
      return std::to_string(node.integer);
    case TomlNode::Kind::number:
      return fmt::format("{}", node.number);
    default:
      return std::nullopt;
  }
}

std::optional<double> parse_number(const std::string& text) {
  double value = 0.0;
  const auto [end, status] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (status != std::errc() || end != text.data() + text.size() || !std::isfinite(value)) return std::nullopt;
  return value;
}

/// "N m" -> "N_m", "m/s^2" -> "m_per_s2": a unit as the end of a key.
std::string key_suffix(std::string si) {
  std::string out;
  for (const char c : si) {
    if (c == ' ') {
      out += '_';
    } else if (c == '/') {
      out += "_per_";
    } else if (c != '^') {
      out += c;
    }
  }
  return out == "1" ? "" : "_" + out;
}

// ---------------------------------------------------------------- [session]

void apply_overrides(TomlNode& root, const Variables& overrides, std::vector<Diagnostic>& diagnostics) {
  for (const auto& [key, text] : overrides) {
    TomlNode* node = &root;
    std::string rest = key.find('.') == std::string::npos ? "session." + key : key;
    for (std::size_t dot = rest.find('.'); node && dot != std::string::npos; dot = rest.find('.')) {
      node = node->find(rest.substr(0, dot));
      if (node && node->kind != TomlNode::Kind::table) node = nullptr;
      rest.erase(0, dot + 1);
    }
    if (!node) {
      diagnostics.push_back({data::Severity::error, "unknown-key",
                             fmt::format("`{}` cannot be set: the description has no such table", key),
                             data::SourceSpan{override_origin, 0, 0, 1, {}},
                             "keys of [session], or a dotted path of tables"});
      continue;
    }
    node->member(rest) = parse_toml_value(text, override_origin);
  }
}

void read_session(TomlTable& root, SessionDescription& out) {
  auto session = root.table("session");
  if (!session) {
    if (!root.has("session"))
      root.error("missing-key", "there is no [session]", {},
                 "it names the subject and the folder of the recordings");
    return;
  }
  out.session.subject = session->require_text("subject");
  const std::filesystem::path folder = session->text("recordings").value_or(".");
  out.recordings_where = session->span_of("recordings");
  const bool from_command_line = out.recordings_where.file == override_origin;
  out.recordings = folder.is_absolute() || from_command_line ? folder : out.file.parent_path() / folder;
  for (const char* key : {"body_mass_kg", "height_m"}) {
    if (session->has(key)) out.session.anthropometry[key] = session->positive(key);
  }
  for (const char* key : {"source", "licence", "citation"}) {
    if (const auto text = session->text(key)) out.session.attributes[key] = *text;
  }
  if (auto numbers = session->table("anthropometry")) {
    for (const auto& [key, node] : numbers->node().members) {
      if (const auto value = numbers->number(key)) out.session.anthropometry[key] = *value;
    }
  }
  if (auto texts = session->table("attributes")) {
    for (const auto& [key, node] : texts->node().members) {
      if (const auto text = texts->text(key)) out.session.attributes[key] = *text;
    }
  }
  session->finish();
}

// ---------------------------------------------------------------- [[trial]]

/// 2.5, "{load}", or { value = "{load}", unit = "lb" }, which is brought to SI and gets the SI unit in its
/// name.
void read_condition(TomlTable& conditions, const std::string& key, const TomlNode& node,
                    TrialDescription& trial) {
  if (node.kind != TomlNode::Kind::table) {
    const auto text = text_of(node);
    const auto value = text ? parse_number(filled(conditions, key, *text, trial.variables)) : std::nullopt;
    if (!value) {
      conditions.error("wrong-type", fmt::format("condition `{}` must be a number", key), key);
      return;
    }
    trial.info.conditions[key] = *value;
    return;
  }
  auto table = conditions.table(key);
  const TomlNode* value_node = node.find("value");
  const std::string unit = table->require_text("unit");
  table->know("value");
  table->finish();
  const auto written = value_node ? text_of(*value_node) : std::nullopt;
  const std::string text = written ? filled(*table, "value", *written, trial.variables) : "";
  const auto value = parse_number(text);
  if (!value) {
    table->error("wrong-type", fmt::format("`value` of condition `{}` must be a number", key), "value");
    return;
  }
  if (unit.empty()) return;
  at_key(*table, "unit", [&] {
    const data::Unit parsed = data::parse_unit(unit);
    trial.info.conditions[key + key_suffix(parsed.si)] = *value * parsed.to_si;
    trial.info.attributes[key] = fmt::format("{} {}", text, unit);
  });
}

void read_one_trial(TomlTable& table, const Variables& variables, SessionDescription& out) {
  TrialDescription trial;
  trial.variables = variables;
  trial.info.name = filled(table, "name", table.require_text("name"), variables);
  trial.variables["trial"] = trial.info.name;
  const std::string kind = filled(table, "kind", table.require_text("kind"), variables);
  if (!kind.empty()) at_key(table, "kind", [&] { trial.info.kind = data::parse_trial_kind(kind); });
  if (auto conditions = table.table("conditions")) {
    for (const auto& [key, node] : conditions->node().members) read_condition(*conditions, key, node, trial);
  }
  if (auto attributes = table.table("attributes")) {
    for (const auto& [key, node] : attributes->node().members) {
      if (const auto text = attributes->text(key))
        trial.info.attributes[key] = filled(*attributes, key, *text, trial.variables);
    }
  }
  if (trial.info.name.find('/') != std::string::npos) {
    table.error("bad-name", fmt::format("`{}` cannot be the name of a trial", trial.info.name), "name",
                "a name must not hold `/`");
  }
  if (std::any_of(out.trials.begin(), out.trials.end(),
                  [&](const auto& t) { return t.info.name == trial.info.name; })) {
    table.error("duplicate-trial", fmt::format("there are two trials `{}`", trial.info.name), "name",
                "give each trial a name of its own");
  }
  out.trials.push_back(std::move(trial));
}

void read_trial(TomlTable& table, SessionDescription& out) {
  table.know("each");
  if (!table.has("each")) {
    read_one_trial(table, {}, out);
  } else {
    for (TomlTable& entry : table.tables("each")) {
      Variables variables;
      for (const auto& [key, node] : entry.node().members) {
        if (const auto text = text_of(node)) {
          variables[key] = *text;
        } else {
          entry.error("wrong-type", fmt::format("`{}` of `each` must be a text or a number", key), key);
        }
      }
      read_one_trial(table, variables, out);
    }
  }
  table.finish();
}

// ---------------------------------------------------------------- [[file]]

/// What a signal is, with `base` where the table says nothing.
SignalMapping read_mapping(TomlTable& table, const SignalMapping& base, bool& has_quantity) {
  SignalMapping m = base;
  m.where = table.span_of("name");
  if (const auto v = table.text("name")) m.name = *v;
  if (const auto v = table.text("column")) m.column = *v;
  if (const auto v = table.text("muscle")) m.muscle = *v;
  if (const auto v = table.text("coordinate")) m.coordinate = *v;
  if (const auto v = table.text("quantity")) {
    has_quantity = true;
    at_key(table, "quantity", [&] { m.quantity = data::parse_quantity(*v); });
  }
  if (const auto v = table.text("unit")) {
    m.unit = *v;
    at_key(table, "unit", [&] { data::parse_unit(*v); });
  }
  if (const auto v = table.number("sign")) {
    if (*v != 1.0 && *v != -1.0)
      table.error("out-of-range", fmt::format("`sign` must be 1 or -1, not {}", *v), "sign");
    m.scale *= *v;
  }
  if (const auto v = table.number("scale")) {
    if (!(*v != 0.0)) table.error("out-of-range", "`scale` must not be 0", "scale");
    m.scale *= *v;
  }
  if (const auto v = table.number("offset")) m.offset = *v;
  return m;
}

void read_csv_layout(TomlTable& table, FileMapping& file) {
  CsvLayout& csv = file.csv;
  if (const auto v = table.text("delimiter")) {
    csv.delimiter = *v;
    at_key(table, "delimiter", [&] { split_fields("", *v); });
  }
  csv.decimal_comma = table.boolean("decimal_comma").value_or(false);
  csv.comment = table.text("comment").value_or("");
  const auto row = [&](const char* key, std::int64_t least) -> std::optional<std::size_t> {
    const auto v = table.integer(key);
    if (!v) return std::nullopt;
    if (*v >= least) return static_cast<std::size_t>(*v);
    table.error("out-of-range", fmt::format("`{}` must be {} or greater, not {}", key, least, *v), key);
    return std::nullopt;
  };
  csv.skip_rows = row("skip_rows", 0).value_or(0);
  if (const auto v = row("header_row", 0)) csv.header_row = *v == 0 ? std::nullopt : std::optional(*v);
  csv.units_row = row("units_row", 1);
  csv.first_data_row = row("first_data_row", 1);
  csv.time_column = table.text("time").value_or("");
  csv.time_unit = table.text("time_unit").value_or("s");
  at_key(table, "time_unit", [&] { data::convert(1.0, csv.time_unit, "s"); });
  csv.start_time_s = table.number("start_time_s").value_or(0.0);
  csv.rate_hz = file.timing.rate_hz;
  if (csv.time_column.empty() && !csv.rate_hz) {
    table.error("no-time", "a CSV file needs `time` (the name of its time column) or `rate_hz`");
  }
}

FileFormat read_format(TomlTable& table, const std::string& path) {
  static const std::vector<std::string> known{"csv", "noraxon", "opensim"};
  const bool storage = path.ends_with(".sto") || path.ends_with(".mot");
  const std::string format = table.text("format").value_or(storage ? "opensim" : "csv");
  const auto at = std::find(known.begin(), known.end(), format);
  if (at != known.end()) return static_cast<FileFormat>(at - known.begin());
  table.error("unknown-format", fmt::format("`{}` is not a format that can be read", format), "format",
              data::suggest(format, known));
  return FileFormat::csv;
}

void read_signals(TomlTable& table, FileMapping& file) {
  bool base_quantity = false;
  const SignalMapping base = read_mapping(table, {}, base_quantity);
  const auto columns = table.texts("columns");
  const auto add = [&](TomlTable& at, SignalMapping m, bool has_quantity) {
    if (m.name.empty()) at.error("missing-key", "`name` of the signal is missing");
    if (!has_quantity)
      at.error("missing-key", "`quantity` of the signal is missing", {},
               "for example \"emg\" or \"joint_angle\"");
    file.signals.push_back(std::move(m));
  };
  if (!table.has("signal")) {
    for (const std::string& column : columns.value_or(std::vector<std::string>{base.column})) {
      SignalMapping m = base;
      m.column = column;
      add(table, std::move(m), base_quantity);
    }
    return;
  }
  if (columns)
    table.error("conflicting-keys", "`columns` and [[file.signal]] cannot stand together", "columns");
  for (TomlTable& entry : table.tables("signal")) {
    bool has_quantity = base_quantity;
    SignalMapping m = read_mapping(entry, base, has_quantity);
    entry.finish();
    add(entry, std::move(m), has_quantity);
  }
}

void read_file(TomlTable& table, SessionDescription& out) {
  FileMapping file;
  file.path = table.require_text("path");
  file.where = table.span_of("path");
  file.format = read_format(table, file.path);
  file.trials = table.texts("trials").value_or(std::vector<std::string>{});
  if (table.has("rate_hz")) file.timing.rate_hz = table.positive("rate_hz");
  file.timing.ignore_stated_rows = table.boolean("ignore_stated_rows").value_or(false);
  if (const auto v = table.text("timing")) {
    if (*v != "strict" && *v != "interpolate") {
      table.error("unknown-timing",
                  fmt::format("`timing` must be \"strict\" or \"interpolate\", not `{}`", *v), "timing");
    }
    file.timing.rule = *v == "interpolate" ? TimingRule::interpolate : TimingRule::strict;
  }
  file.time_offset_s = table.number("time_offset_s").value_or(0.0);
  if (file.format == FileFormat::csv) read_csv_layout(table, file);
  read_signals(table, file);
  table.finish();
  for (const std::string& pattern : file.trials) {
    if (std::none_of(out.trials.begin(), out.trials.end(),
                     [&](const auto& t) { return data::matches(pattern, t.info.name); })) {
      std::vector<std::string> names;
      for (const TrialDescription& t : out.trials) names.push_back(t.info.name);
      table.error("no-match", fmt::format("no trial matches `{}`", pattern), "trials",
                  data::suggest(pattern, names));
    }
  }
  out.files.push_back(std::move(file));
}

}  // namespace

std::string fill(const std::string& text, const Variables& variables, std::vector<std::string>& unknown) {
  std::string out;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t open = text.find('{', at);
    const std::size_t close = open == std::string::npos ? open : text.find('}', open);
    if (close == std::string::npos) return out + text.substr(at);
    out += text.substr(at, open - at);
    const std::string name = text.substr(open + 1, close - open - 1);
    if (const auto value = variables.find(name); value != variables.end()) {
      out += value->second;
    } else {
      unknown.push_back(name);
      out += text.substr(open, close - open + 1);
    }
    at = close + 1;
  }
  return out;
}

SessionDescription read_session_description(const std::filesystem::path& file, const Variables& overrides) {
  TomlNode node = read_toml(file);
  std::vector<Diagnostic> diagnostics;
  apply_overrides(node, overrides, diagnostics);
  SessionDescription out;
  out.file = file;
  TomlTable root(node, diagnostics);
  read_session(root, out);
  for (TomlTable& table : root.tables("trial")) read_trial(table, out);
  if (out.trials.empty() && !root.has("trial")) root.error("missing-key", "there is no [[trial]]");
  for (TomlTable& table : root.tables("file")) read_file(table, out);
  if (out.files.empty() && !root.has("file")) root.error("missing-key", "there is no [[file]]");
  root.finish();
  raise_if_errors(diagnostics);
  return out;
}

}  // namespace brachium::io
