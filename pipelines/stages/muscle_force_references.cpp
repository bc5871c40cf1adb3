#include "pipelines/stages/muscle_force_references.hpp"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "data/io/csv.hpp"
#include "pipelines/stages/fem_option_kinds.hpp"

namespace brachium::pipelines {
namespace {

using optimise::Measure;
using optimise::ReferenceForce;

constexpr double degree = std::numbers::pi / 180.0;

OptionSpec list_of_numbers(const std::string& key, const std::string& unit, const std::string& doc) {
  OptionSpec spec = optional_number(key, unit, {}, doc);
  spec.type = OptionType::numbers;
  return spec;
}

[[noreturn]] void wrong(const Options& o, const std::string& key, const std::string& code,
                        const std::string& message, const std::string& help) {
  throw data::InputError(
      data::Diagnostic{data::Severity::error, code, message, o.where(o.has(key) ? key : ""), help});
}

std::vector<ReferenceForce> listed(const Options& o) {
  const bool moments = o.has("moment_N_m");
  const std::string key = moments ? "moment_N_m" : "force_N";
  const std::vector<double>&angles = o.numbers("angle_deg"), &values = o.numbers(key);
  if (values.size() != angles.size())
    wrong(o, key, "wrong-length",
          fmt::format("{} {} are given for {} angles", values.size(), moments ? "moments" : "forces",
                      angles.size()),
          "one an angle");
  std::vector<ReferenceForce> out;
  for (std::size_t i = 0; i < angles.size(); ++i)
    out.push_back({angles[i] * degree, o.number("activation"), values[i], 1.0, o.text("set"),
                   moments ? Measure::moment : Measure::force});
  return out;
}

std::vector<ReferenceForce> from_file(const Options& o) {
  io::CsvLayout layout;
  layout.comment = "#";
  layout.rate_hz = 1.0;  // rows are states: their place in the file means nothing
  io::Recording file = io::open_csv(o.text("file"), layout);
  const bool moments = o.has("moment_column");
  const auto column = [&](const std::string& key) {
    return file.header().column_index(o.text(key), file.file());
  };
  const std::size_t angle = column("angle_column"), activation = column("activation_column"),
                    value = column(moments ? "moment_column" : "force_column");
  std::vector<double> time(1), row(file.header().columns.size());
  std::vector<ReferenceForce> out;
  while (file.read_rows(time, row) > 0)
    out.push_back({row[angle] * degree, row[activation], o.number("factor") * row[value], 1.0, o.text("set"),
                   moments ? Measure::moment : Measure::force});
  return out;
}

std::vector<ReferenceForce> one(const Options& o) {
  const bool lists = o.has("force_N") || o.has("moment_N_m"), file = o.has("file");
  if (lists == file || (o.has("force_N") && o.has("moment_N_m")))
    wrong(o, "file", "contradiction", "references are given as `force_N`, as `moment_N_m` or in a `file`",
          "give one of the three");
  if (lists) {
    for (const std::string key : {"angle_deg", "activation"})
      if (!o.has(key)) wrong(o, key, "missing-option", fmt::format("`{}` is missing", key), "");
  } else if (o.has("force_column") == o.has("moment_column")) {
    wrong(o, "force_column", "contradiction",
          "a file of references is read by `force_column` or `moment_column`", "give one of the two");
  }
  std::vector<ReferenceForce> out = lists ? listed(o) : from_file(o);
  const std::vector<double> none, &left_out = o.has("not_fitted") ? o.numbers("not_fitted") : none;
  if (left_out.size() % 2 != 0)
    wrong(o, "not_fitted", "wrong-length", "`not_fitted` has an odd number of entries",
          "angle in degrees and activation of one state after the other");
  for (ReferenceForce& r : out) {
    for (std::size_t i = 0; i < left_out.size(); i += 2) {
      if (std::abs(r.q_rad - left_out[i] * degree) < 1e-9 && std::abs(r.activation - left_out[i + 1]) < 1e-9)
        r.weight = 0.0;
    }
    if (!(r.activation >= 0.0 && r.activation <= 1.0) ||
        (r.measure == Measure::force ? !(r.value >= 0.0) : !std::isfinite(r.value)))
      wrong(o,
            o.has("force_N")      ? "force_N"
            : o.has("moment_N_m") ? "moment_N_m"
                                  : "file",
            "out-of-range",
            fmt::format("{:.6g} {} at activation {:.4g}", r.value, r.measure == Measure::force ? "N" : "N m",
                        r.activation),
            "forces are tensions, 0 or greater (`factor = -1` turns a column's sign); activation lies in [0, "
            "1]");
  }
  return out;
}

}  // namespace

OptionSpec reference_option() {
  OptionSpec file =
      optional_text("file", "delimited file with a column of forces or moments, instead of lists");
  file.is_file = true;
  OptionSpec spec = list_option(
      "reference",
      {required_text("muscle", "whose forces"),
       required_text("set", "name: agreement is told set by set, and all sets count alike"),
       list_of_numbers("angle_deg", "deg", "joint angles"),
       optional_number("activation", "1", between(0, 1), "at all of them"),
       list_of_numbers("force_N", "N", "tension at each angle"),
       list_of_numbers("moment_N_m", "N m",
                       "instead: moment about the hinge at each angle, flexion positive"),
       file, text_option("angle_column", "angle_deg", "in the file, degrees"),
       text_option("activation_column", "activation", "in the file"),
       optional_text("force_column", "in the file, N"),
       optional_text("moment_column", "in the file instead, N m, flexion positive"),
       number_option("factor", "1", 1.0, {}, "of the file's column; -1 where tensions are negative"),
       list_of_numbers("not_fitted", "deg, 1",
                       "states that are compared and not fitted: angle, activation, angle, activation ...")},
      "forces or moments to fit, at least one table for each muscle, where no input `moments` is wired");
  return spec;
}

std::vector<ReferenceForce> reference_forces(const Options& options, const std::string& muscle) {
  std::vector<ReferenceForce> out;
  for (const Options& o : options.tables("reference")) {
    if (o.text("muscle") != muscle) continue;
    const std::vector<ReferenceForce> more = one(o);
    out.insert(out.end(), more.begin(), more.end());
  }
  return out;
}

}  // namespace brachium::pipelines
