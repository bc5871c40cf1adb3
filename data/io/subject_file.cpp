#include "data/io/subject_file.hpp"

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <set>

#include "data/io/atomic_file.hpp"
#include "data/io/toml.hpp"

namespace brachium::io {
namespace {

using data::ActivationParameters;
using data::MuscleParameters;
using data::ParameterVerdict;
using data::Subject;
using data::SubjectMuscle;

constexpr const char* format = "brachium-subject";
constexpr std::int64_t version = 1;
constexpr const char* not_identified = "not identified";
constexpr double infinity = std::numeric_limits<double>::infinity();

/// One number of a struct under its key, with the range it must lie in.
template <class Struct>
struct Field {
  const char* key;
  double Struct::*value;
  double lower, upper;
  bool lower_open, upper_open;
};

constexpr Field<MuscleParameters> muscle_fields[] = {
    {"max_isometric_force_N", &MuscleParameters::max_isometric_force_N, 0.0, infinity, true, true},
    {"optimal_fibre_length_m", &MuscleParameters::optimal_fibre_length_m, 0.0, infinity, true, true},
    {"tendon_slack_length_m", &MuscleParameters::tendon_slack_length_m, 0.0, infinity, false, true},
    {"pennation_at_optimal_rad", &MuscleParameters::pennation_at_optimal_rad, 0.0, std::numbers::pi / 2.0,
     false, true},
    {"max_contraction_velocity_per_s", &MuscleParameters::max_contraction_velocity, 0.0, infinity, true,
     true},
    {"fibre_damping_norm", &MuscleParameters::fibre_damping, 0.0, infinity, false, true},
    {"strength", &MuscleParameters::strength, 0.0, infinity, true, true},
};

constexpr Field<ActivationParameters> activation_fields[] = {
    {"delay_s", &ActivationParameters::delay_s, 0.0, infinity, false, true},
    {"time_constant_1_s", &ActivationParameters::time_constant_1_s, 0.0, infinity, true, true},
    {"time_constant_2_s", &ActivationParameters::time_constant_2_s, 0.0, infinity, true, true},
    {"shape", &ActivationParameters::shape, -infinity, infinity, true, true},
};

struct VerdictNumber {
  const char* key;
  double ParameterVerdict::*value;
  bool may_be_infinite;
};
constexpr VerdictNumber verdict_numbers[] = {
    {"start", &ParameterVerdict::start, false},
    {"fitted", &ParameterVerdict::fitted, false},
    {"lower", &ParameterVerdict::lower, true},
    {"upper", &ParameterVerdict::upper, true},
    {"standard_error", &ParameterVerdict::standard_error, true},
    {"interval_lower", &ParameterVerdict::interval_lower, true},
    {"interval_upper", &ParameterVerdict::interval_upper, true},
    {"bias", &ParameterVerdict::bias, false},
};

struct VerdictText {
  const char* key;
  std::string ParameterVerdict::*value;
};
constexpr VerdictText verdict_texts[] = {
    {"muscle", &ParameterVerdict::muscle}, {"parameter", &ParameterVerdict::parameter},
    {"unit", &ParameterVerdict::unit},     {"verdict", &ParameterVerdict::verdict},
    {"remark", &ParameterVerdict::remark},
};

template <class Struct, std::size_t n>
void write_fields(TomlNode& table, const Field<Struct> (&fields)[n], const Struct& from) {
  for (const auto& field : fields) table.member(field.key) = TomlNode::of(from.*field.value);
}

template <class Struct, std::size_t n>
void read_fields(TomlTable& table, const Field<Struct> (&fields)[n], Struct& to) {
  for (const auto& field : fields) {
    const double v = table.require_number(field.key);
    to.*field.value = v;
    if (std::isnan(v)) continue;  // reported already
    const bool above = field.lower_open ? v > field.lower : v >= field.lower;
    const bool below = field.upper_open ? v < field.upper : v <= field.upper;
    if (!(above && below)) {
      table.error(
          "out-of-range",
          fmt::format("`{}` must lie in {}{}, {}{}, not be {}", field.key, field.lower_open ? "(" : "[",
                      field.lower, field.upper, field.upper_open ? ")" : "]", v),
          field.key);
    }
  }
}

template <class Map>
TomlNode map_node(const Map& map) {
  TomlNode node = TomlNode::table();
  for (const auto& [key, value] : map) node.member(key) = TomlNode::of(value);
  return node;
}

template <class Value>
void read_map(TomlTable& root, const std::string& key, std::map<std::string, Value>& out) {
  auto table = root.table(key);
  if (!table) return;
  for (const auto& [name, node] : table->node().members) {
    if constexpr (std::is_same_v<Value, double>) {
      if (const auto value = table->number(name)) out[name] = *value;
    } else {
      if (const auto value = table->text(name)) out[name] = *value;
    }
  }
}

/// A number that may be infinite: `inf`, or the text "not identified" for a standard error.
double open_number(TomlTable& table, const VerdictNumber& field) {
  const TomlNode* node = table.node().find(field.key);
  if (node && field.may_be_infinite) {
    if (node->kind == TomlNode::Kind::number && std::isinf(node->number)) return node->number;
    if (node->kind == TomlNode::Kind::text && node->text == not_identified) return infinity;
  }
  return table.require_number(field.key);
}

ParameterVerdict read_verdict(TomlTable& table) {
  ParameterVerdict verdict;
  for (const VerdictText& field : verdict_texts) verdict.*field.value = table.require_text(field.key);
  for (const VerdictNumber& field : verdict_numbers) {
    table.know(field.key);
    verdict.*field.value = open_number(table, field);
  }
  table.finish();
  return verdict;
}

SubjectMuscle read_muscle(TomlTable& table) {
  SubjectMuscle muscle;
  muscle.name = table.require_text("name");
  muscle.group = table.text("group").value_or(muscle.name);
  read_fields(table, muscle_fields, muscle.parameters);
  if (auto activation = table.table("activation")) {
    read_fields(*activation, activation_fields, muscle.activation);
    activation->finish();
  } else if (!table.has("activation")) {
    table.error("missing-key", fmt::format("`activation` is missing in muscle `{}`", muscle.name));
  }
  table.finish();
  return muscle;
}

}  // namespace

std::string subject_to_toml(const Subject& subject) {
  TomlNode root = TomlNode::table();
  root.member("format") = TomlNode::of(format);
  root.member("format_version") = TomlNode::of(version);
  root.member("name") = TomlNode::of(subject.name);
  root.member("provenance") = map_node(subject.provenance);
  root.member("model") = map_node(subject.model);
  root.member("statistics") = map_node(subject.statistics);
  root.member("channel_gains") = map_node(subject.channel_gains);
  TomlNode muscles;
  muscles.kind = TomlNode::Kind::array;
  for (const SubjectMuscle& m : subject.muscles) {
    TomlNode node = TomlNode::table();
    node.member("name") = TomlNode::of(m.name);
    node.member("group") = TomlNode::of(m.group);
    write_fields(node, muscle_fields, m.parameters);
    TomlNode activation = TomlNode::table();
    write_fields(activation, activation_fields, m.activation);
    node.member("activation") = std::move(activation);
    muscles.items.push_back(std::move(node));
  }
  if (!muscles.items.empty()) root.member("muscle") = std::move(muscles);
  TomlNode verdicts;
  verdicts.kind = TomlNode::Kind::array;
  for (const ParameterVerdict& v : subject.verdicts) {
    TomlNode node = TomlNode::table();
    for (const VerdictText& field : verdict_texts) node.member(field.key) = TomlNode::of(v.*field.value);
    for (const VerdictNumber& field : verdict_numbers) {
      const bool unknown = field.value == &ParameterVerdict::standard_error && std::isinf(v.*field.value);
      node.member(field.key) = unknown ? TomlNode::of(not_identified) : TomlNode::of(v.*field.value);
    }
    verdicts.items.push_back(std::move(node));
  }
  if (!verdicts.items.empty()) root.member("verdict") = std::move(verdicts);
  return write_toml(root);
}

Subject parse_subject(const std::string& toml, const std::string& file_name) {
  const TomlNode node = parse_toml(toml, file_name);
  std::vector<data::Diagnostic> diagnostics;
  TomlTable root(node, diagnostics);
  Subject subject;
  const std::string found = root.text("format").value_or("");
  if (found != format) {
    throw data::InputError(data::Diagnostic{
        data::Severity::error, "wrong-format",
        fmt::format("`{}` is not a calibrated subject (no `format = \"{}\"`)", file_name, format),
        root.span_of("format"), "give the file that a calibration wrote"});
  }
  if (root.integer("format_version").value_or(0) != version) {
    throw data::InputError(
        data::Diagnostic{data::Severity::error, "wrong-version",
                         fmt::format("only version {} of subject files can be read", version),
                         root.span_of("format_version"), "calibrate again with this version of the program"});
  }
  subject.name = root.require_text("name");
  read_map(root, "provenance", subject.provenance);
  read_map(root, "model", subject.model);
  read_map(root, "statistics", subject.statistics);
  read_map(root, "channel_gains", subject.channel_gains);
  std::set<std::string> names;
  for (TomlTable& table : root.tables("muscle")) {
    subject.muscles.push_back(read_muscle(table));
    const std::string& name = subject.muscles.back().name;
    if (!names.insert(name).second)
      table.error("duplicate-muscle", fmt::format("there are two muscles `{}`", name), "name");
  }
  for (TomlTable& table : root.tables("verdict")) subject.verdicts.push_back(read_verdict(table));
  root.finish();
  raise_if_errors(diagnostics);
  return subject;
}

void write_subject(const Subject& subject, const std::filesystem::path& file) {
  write_text_atomically(file, subject_to_toml(subject));
}

Subject read_subject(const std::filesystem::path& file) {
  return parse_subject(read_text(file), file.string());
}

}  // namespace brachium::io
