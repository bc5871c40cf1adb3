#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "data/io/noraxon.hpp"
#include "data/io/opensim_file.hpp"
#include "data/io/session_description.hpp"
#include "data/io/session_layout.hpp"
#include "data/io/template_text.hpp"
#include "data/model/units.hpp"

namespace brachium::io {
namespace {

using data::Diagnostic;
using data::InputError;
using data::Quantity;
using data::Severity;
using data::SignalInfo;

/// One column of one file, ready to be read.
struct PlannedSignal {
  std::size_t column = 0;
  SignalInfo info;      // all but rate, start and count
  double factor = 1.0;  // stored value = factor * (value in the file) + offset
  double offset = 0.0;
};

struct PlannedFile {
  ResolvedFile file;
  std::vector<PlannedSignal> signals;
};

Recording open(const FileMapping& mapping, const std::filesystem::path& file) {
  switch (mapping.format) {
    case FileFormat::noraxon:
      return open_noraxon(file);
    case FileFormat::opensim:
      return open_storage(file);
    case FileFormat::csv:
      break;
  }
  return open_csv(file, mapping.csv);
}

const char* name_of(FileFormat format) {
  return format == FileFormat::noraxon ? "noraxon" : format == FileFormat::opensim ? "opensim" : "csv";
}

/// A unit of the dimension a quantity must have; empty: any.
const char* unit_of(Quantity quantity) {
  switch (quantity) {
    case Quantity::emg:
      return "V";
    case Quantity::excitation:
    case Quantity::activation:
    case Quantity::orientation:
      return "1";
    case Quantity::joint_angle:
    case Quantity::dynamometer_angle:
      return "rad";
    case Quantity::joint_velocity:
    case Quantity::dynamometer_velocity:
      return "rad/s";
    case Quantity::joint_acceleration:
      return "rad/s^2";
    case Quantity::joint_moment:
    case Quantity::dynamometer_torque:
      return "N m";
    case Quantity::muscle_force:
      return "N";
    case Quantity::fibre_length:
    case Quantity::moment_arm:
    case Quantity::muscle_tendon_length:
    case Quantity::position:
      return "m";
    case Quantity::fibre_velocity:
      return "m/s";
    case Quantity::acceleration:
      return "m/s^2";
    case Quantity::other:
      break;
  }
  return "";
}

/// The unit of a column: what the description says and what the file says must agree.
data::Unit agreed_unit(const SignalMapping& mapping, const RecordingColumn& column, const std::string& file) {
  if (mapping.unit.empty() && column.unit.empty()) {
    throw InputError("missing-unit",
                     fmt::format("the unit of column `{}` of `{}` is not known", column.name, file),
                     "give it with `unit`");
  }
  const data::Unit unit = data::parse_unit(mapping.unit.empty() ? column.unit : mapping.unit);
  if (!mapping.unit.empty() && !column.unit.empty()) {
    const data::Unit stated = data::parse_unit(column.unit);
    if (stated.dimension != unit.dimension || stated.to_si != unit.to_si) {
      throw InputError("wrong-unit",
                       fmt::format("column `{}` of `{}` is in `{}`, the description says `{}`", column.name,
                                   file, column.unit, mapping.unit),
                       "leave `unit` out to take the file's");
    }
  }
  const std::string wanted = unit_of(mapping.quantity);
  if (!wanted.empty() && data::parse_unit(wanted).dimension != unit.dimension) {
    throw InputError("wrong-unit",
                     fmt::format("column `{}` of `{}` is in `{}`, a unit of {}, but `{}` needs a unit of {}",
                                 column.name, file, unit.symbol, unit.dimension,
                                 data::to_string(mapping.quantity), data::parse_unit(wanted).dimension),
                     fmt::format("for example `{}`", wanted));
  }
  return unit;
}

/// Plans the whole import from the headers, collecting mistakes.
struct Planner {
  const SessionDescription& description;
  std::vector<Diagnostic> mistakes;
  std::vector<Diagnostic> warnings;
  std::vector<std::set<std::string>> names;  // of each trial's signals

  void add_mistakes(const InputError& error, const data::SourceSpan& where) {
    for (Diagnostic d : error.diagnostics()) {
      if (!d.where) d.where = where;
      mistakes.push_back(std::move(d));
    }
  }

  PlannedSignal plan_signal(const ResolvedFile& file, const SignalMapping& mapping,
                            const Recording& recording, std::size_t index) {
    const TrialDescription& trial = description.trials[file.trial];
    const FileMapping& from = description.files[file.file];
    const RecordingColumn& column = recording.header().columns[index];
    const std::string relative = file.path.lexically_relative(description.recordings).string();
    std::map<std::string, std::string> variables = trial.variables;
    variables["column"] = column.name;
    std::vector<std::string> unknown;
    PlannedSignal planned;
    planned.column = index;
    planned.info.name = fill(mapping.name, variables, unknown);
    planned.info.muscle = fill(mapping.muscle, variables, unknown);
    planned.info.coordinate = fill(mapping.coordinate, variables, unknown);
    if (!unknown.empty())
      throw InputError("unknown-variable",
                       fmt::format("`{{{}}}` is not a variable of this trial", unknown.front()));
    planned.info.quantity = mapping.quantity;
    const data::Unit unit = agreed_unit(mapping, column, relative);
    planned.info.unit = unit.si;
    planned.factor = unit.to_si * mapping.scale;
    planned.offset = mapping.offset;
    auto& attributes = planned.info.attributes;
    attributes["source_file"] = relative;
    attributes["source_format"] = name_of(from.format);
    attributes["source_column"] = column.name;
    attributes["source_unit"] = unit.symbol;
    if (mapping.scale != 1.0) attributes["source_scale"] = fmt::format("{}", mapping.scale);
    if (mapping.offset != 0.0) attributes["source_offset"] = fmt::format("{}", mapping.offset);
    if (from.time_offset_s != 0.0) attributes["source_time_offset_s"] = fmt::format("{}", from.time_offset_s);
    const std::string& name = planned.info.name;
    if (name.empty() || name.find('/') != std::string::npos || layout::is_time_name(name)) {
      throw InputError("bad-name", fmt::format("`{}` cannot be the name of a signal", name),
                       "a name must not be empty, hold `/`, or be time_<number>");
    }
    if (!names[file.trial].insert(name).second) {
      throw InputError("duplicate-signal",
                       fmt::format("trial `{}` has two signals `{}`", trial.info.name, name),
                       "give each signal of a trial a name of its own");
    }
    return planned;
  }

  std::vector<std::size_t> columns_of(const SignalMapping& mapping, const Recording& recording) {
    const auto& columns = recording.header().columns;
    if (!mapping.column.empty()) return {recording.header().column_index(mapping.column, recording.file())};
    if (columns.size() != 1 && mapping.name.find("{column}") == std::string::npos) {
      std::vector<std::string> known;
      for (const RecordingColumn& c : columns) known.push_back(c.name);
      throw InputError(
          "ambiguous-column",
          fmt::format("`{}` has {} columns, but one signal is named", recording.file().string(),
                      columns.size()),
          fmt::format("say which `column`, or put {{column}} into `name`; {}", data::suggest("", known)));
    }
    std::vector<std::size_t> all(columns.size());
    for (std::size_t i = 0; i < all.size(); ++i) all[i] = i;
    return all;
  }

  PlannedFile plan_file(const ResolvedFile& file) {
    const FileMapping& mapping = description.files[file.file];
    PlannedFile planned{file, {}};
    try {
      const Recording recording = open(mapping, file.path);
      warnings.insert(warnings.end(), recording.header().notes.begin(), recording.header().notes.end());
      for (const SignalMapping& signal : mapping.signals) {
        try {
          for (const std::size_t column : columns_of(signal, recording))
            planned.signals.push_back(plan_signal(file, signal, recording, column));
        } catch (const InputError& error) {
          add_mistakes(error, signal.where);
        }
      }
    } catch (const InputError& error) {
      add_mistakes(error, mapping.where);
    }
    return planned;
  }

  std::vector<PlannedFile> plan() {
    names.resize(description.trials.size());
    std::vector<PlannedFile> files;
    for (const ResolvedFile& file : resolve_files(description)) files.push_back(plan_file(file));
    if (!mistakes.empty()) throw InputError(std::move(mistakes));
    return files;
  }
};

/// Thrown through the reader when the sink refuses: a full disk is not a mistake of the recording.
struct SinkFailure {
  std::exception_ptr error;
};

template <class Action>
void to_sink(Action action) {
  try {
    action();
  } catch (...) {
    throw SinkFailure{std::current_exception()};
  }
}

void import_file(const PlannedFile& planned, const FileMapping& mapping, const std::string& trial,
                 data::SessionSink& sink, std::vector<Diagnostic>& warnings,
                 const std::function<void(double)>& progress) {
  Recording recording = open(mapping, planned.file.path);
  const Timing timing = check_timing(recording, mapping.timing, warnings);
  std::vector<std::size_t> columns;
  std::vector<double> lowest(planned.signals.size(), std::numeric_limits<double>::infinity()),
      highest(lowest.size(), -lowest[0]);
  std::vector<double> scaled;
  for (const PlannedSignal& signal : planned.signals) {
    SignalInfo info = signal.info;
    info.rate_hz = timing.rate_hz;
    info.start_time_s = timing.start_time_s + mapping.time_offset_s;
    info.count = timing.samples;
    if (mapping.timing.rule == TimingRule::interpolate && (timing.gaps > 0 || timing.largest_jitter > 0.0)) {
      info.attributes["bridged"] = fmt::format(
          "{} gaps (longest {:.6g} s) and time stamps up to {:.3g} sample periods off, by straight lines",
          timing.gaps, timing.longest_gap_s, timing.largest_jitter);
    }
    to_sink([&] { sink.begin_signal(trial, info); });
    columns.push_back(signal.column);
  }
  stream_columns(recording, timing, mapping.timing.rule, columns,
                 [&](std::size_t first, std::span<const std::vector<double>> block) {
                   for (std::size_t s = 0; s < planned.signals.size(); ++s) {
                     const PlannedSignal& signal = planned.signals[s];
                     scaled.resize(block[s].size());
                     for (std::size_t i = 0; i < scaled.size(); ++i) {
                       const double raw = block[s][i];
                       lowest[s] = std::min(lowest[s], raw);
                       highest[s] = std::max(highest[s], raw);
                       scaled[i] = signal.factor * raw + signal.offset;
                     }
                     to_sink([&] { sink.write_samples(trial, signal.info.name, first, scaled); });
                   }
                   progress(recording.bytes_read_fraction());
                 });
  for (std::size_t s = 0; s < planned.signals.size(); ++s) {
    if (lowest[s] < highest[s] || timing.rows < 2) continue;
    warnings.push_back(
        {Severity::warning, "constant-signal",
         fmt::format("signal `{}` of trial `{}` never changes from {} {}", planned.signals[s].info.name,
                     trial, lowest[s], planned.signals[s].info.attributes.at("source_unit")),
         data::SourceSpan{planned.file.path.string(), 0, 0, 1, {}}, "was the sensor connected?"});
  }
}

}  // namespace

std::vector<Diagnostic> check_session(const SessionDescription& description) {
  Planner planner{description, {}, {}, {}};
  planner.plan();
  return planner.warnings;
}

std::vector<Diagnostic> import_session(
    const SessionDescription& description, data::SessionSink& sink,
    const std::function<void(double fraction, const std::string& what)>& progress) {
  Planner planner{description, {}, {}, {}};
  const std::vector<PlannedFile> files = planner.plan();
  std::vector<Diagnostic> warnings = std::move(planner.warnings), mistakes;
  double bytes_total = 0.0, bytes_done = 0.0;
  std::vector<double> bytes;
  for (const PlannedFile& file : files) {
    std::error_code ignored;
    bytes.push_back(static_cast<double>(std::filesystem::file_size(file.file.path, ignored)));
    bytes_total += bytes.back();
  }
  sink.begin(description.session);
  for (const TrialDescription& trial : description.trials) sink.begin_trial(trial.info);
  for (std::size_t f = 0; f < files.size(); ++f) {
    const std::string& trial = description.trials[files[f].file.trial].info.name;
    const auto report = [&](double part) {
      if (progress)
        progress((bytes_done + part * bytes[f]) / bytes_total,
                 fmt::format("{}: {}", trial, files[f].file.path.filename().string()));
    };
    try {
      import_file(files[f], description.files[files[f].file.file], trial, sink, warnings, report);
    } catch (const SinkFailure& failure) {
      std::rethrow_exception(failure.error);
    } catch (const InputError& error) {
      for (const Diagnostic& d : error.diagnostics()) mistakes.push_back(d);
    }
    bytes_done += bytes[f];
  }
  if (!mistakes.empty()) throw InputError(std::move(mistakes));
  return warnings;
}

}  // namespace brachium::io
