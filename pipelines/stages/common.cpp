#include "pipelines/stages/common.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

namespace brachium::pipelines {
namespace {

OptionSpec with_bounds(OptionSpec spec, const Bounds& bounds) {
  spec.lower = bounds.lower;
  spec.upper = bounds.upper;
  spec.lower_open = bounds.lower_open;
  spec.upper_open = bounds.upper_open;
  return spec;
}

OptionSpec option(std::string key, OptionType type, std::string doc) {
  OptionSpec spec;
  spec.key = std::move(key);
  spec.type = type;
  spec.doc = std::move(doc);
  return spec;
}

std::vector<std::size_t> candidates(const data::TrialInfo& trial, data::Quantity quantity,
                                    const std::string& coordinate) {
  std::vector<std::size_t> of_quantity = signals_of(trial, quantity), named;
  for (const std::size_t s : of_quantity) {
    if (trial.signals[s].coordinate == coordinate) named.push_back(s);
  }
  if (!named.empty()) return named;
  std::erase_if(of_quantity, [&](std::size_t s) { return !trial.signals[s].coordinate.empty(); });
  return of_quantity;
}

}  // namespace

OptionSpec number_option(std::string key, std::string unit, double fallback, Bounds bounds, std::string doc) {
  OptionSpec spec = with_bounds(option(std::move(key), OptionType::number, std::move(doc)), bounds);
  spec.unit = std::move(unit);
  spec.fallback = fallback;
  return spec;
}

OptionSpec optional_number(std::string key, std::string unit, Bounds bounds, std::string doc) {
  OptionSpec spec = with_bounds(option(std::move(key), OptionType::number, std::move(doc)), bounds);
  spec.unit = std::move(unit);
  spec.optional = true;
  return spec;
}

OptionSpec integer_option(std::string key, std::int64_t fallback, Bounds bounds, std::string doc) {
  OptionSpec spec = with_bounds(option(std::move(key), OptionType::integer, std::move(doc)), bounds);
  spec.fallback = fallback;
  return spec;
}

OptionSpec flag_option(std::string key, bool fallback, std::string doc) {
  OptionSpec spec = option(std::move(key), OptionType::boolean, std::move(doc));
  spec.fallback = fallback;
  return spec;
}

OptionSpec choice_option(std::string key, std::string fallback, std::vector<std::string> allowed,
                         std::string doc) {
  OptionSpec spec = option(std::move(key), OptionType::text, std::move(doc));
  spec.fallback = std::move(fallback);
  spec.allowed = std::move(allowed);
  return spec;
}

OptionSpec text_option(std::string key, std::string fallback, std::string doc) {
  OptionSpec spec = option(std::move(key), OptionType::text, std::move(doc));
  spec.fallback = std::move(fallback);
  return spec;
}

OptionSpec optional_text(std::string key, std::string doc) {
  OptionSpec spec = option(std::move(key), OptionType::text, std::move(doc));
  spec.optional = true;
  return spec;
}

OptionSpec texts_option(std::string key, std::vector<std::string> fallback, std::string doc) {
  OptionSpec spec = option(std::move(key), OptionType::texts, std::move(doc));
  spec.fallback = std::move(fallback);
  return spec;
}

std::size_t trial_index(const StageData& data, const std::string& trial) {
  const data::SessionInfo& info = data.signals->info();
  std::vector<std::string> known;
  for (std::size_t t = 0; t < info.trials.size(); ++t) {
    if (info.trials[t].name == trial) return t;
    known.push_back(info.trials[t].name);
  }
  throw data::InputError(
      "missing-trial", fmt::format("the output of stage `{}` has no trial `{}`", data.stage, trial),
      "let that stage work on the trial too (its `trials` patterns); " + data::suggest(trial, known));
}

const data::TrialInfo& trial_info(const StageData& data, const std::string& trial) {
  return data.signals->info().trials[trial_index(data, trial)];
}

std::vector<std::size_t> signals_of(const data::TrialInfo& trial, data::Quantity quantity) {
  std::vector<std::size_t> found;
  for (std::size_t s = 0; s < trial.signals.size(); ++s) {
    if (trial.signals[s].quantity == quantity) found.push_back(s);
  }
  return found;
}

bool has_signal_of(const StageData& data, const std::string& trial, data::Quantity quantity,
                   const std::string& coordinate) {
  return !candidates(trial_info(data, trial), quantity, coordinate).empty();
}

data::Signal signal_of(const StageData& data, const std::string& trial, data::Quantity quantity,
                       const std::string& coordinate) {
  const std::size_t t = trial_index(data, trial);
  const std::vector<std::size_t> found = candidates(data.signals->info().trials[t], quantity, coordinate);
  if (found.empty()) {
    throw data::InputError(
        "missing-signal",
        fmt::format("trial `{}` of `{}` has no signal of quantity `{}` for the coordinate `{}`", trial,
                    data.stage, data::to_string(quantity), coordinate),
        "record or import it, or wire this input to the stage that makes it");
  }
  if (found.size() > 1) {
    throw data::InputError(
        "ambiguous-signal",
        fmt::format("trial `{}` of `{}` has {} signals of quantity `{}` for the coordinate `{}`", trial,
                    data.stage, found.size(), data::to_string(quantity), coordinate),
        "name the coordinate of each in the session description");
  }
  return data.signals->signal(t, found.front());
}

void begin_output(const StageContext& context, const StageData& from, StageOutput& out) {
  out.signals->begin(from.signals->info());
  for (const std::string& name : context.trials) {
    data::TrialInfo header = trial_info(from, name);
    header.signals.clear();
    out.signals->begin_trial(header);
  }
}

std::vector<std::string> select(const std::vector<std::string>& patterns,
                                const std::vector<std::string>& names, const std::string& what) {
  return patterns.empty() ? names : data::match_names(patterns, names, what);
}

std::vector<std::string> names_of(const data::TrialInfo& trial, const std::vector<std::size_t>& signals) {
  std::vector<std::string> names;
  for (const std::size_t s : signals) names.push_back(trial.signals[s].name);
  return names;
}

const data::Coordinate& coordinate_of(const data::Scene& scene, const std::string& name) {
  if (!name.empty()) return scene.coordinate(name);
  if (scene.coordinates.size() == 1) return scene.coordinates.front();
  throw data::InputError("missing-coordinate",
                         fmt::format("scene `{}` has {} coordinates; say which one is meant", scene.title,
                                     scene.coordinates.size()),
                         "add `coordinate = \"...\"` to the stage");
}

std::string figure_text(const std::optional<double>& value, int decimals) {
  return value ? fmt::format("{:.{}f}", *value, decimals) : undefined_text;
}

TableBuilder::TableBuilder(std::string title) {
  table_.title = std::move(title);
}

TableBuilder& TableBuilder::number(const std::string& name, const std::string& unit) {
  table_.columns.push_back({name, unit, std::vector<double>{}});
  return *this;
}

TableBuilder& TableBuilder::text(const std::string& name) {
  table_.columns.push_back({name, "", std::vector<std::string>{}});
  return *this;
}

void TableBuilder::row(std::vector<std::variant<double, std::string>> values) {
  if (values.size() != table_.columns.size())
    throw std::logic_error("a row of table `" + table_.title + "` has the wrong number of values");
  for (std::size_t c = 0; c < values.size(); ++c) {
    if (auto* numbers = std::get_if<std::vector<double>>(&table_.columns[c].values)) {
      numbers->push_back(std::get<double>(values[c]));
    } else {
      std::get<std::vector<std::string>>(table_.columns[c].values)
          .push_back(std::get<std::string>(std::move(values[c])));
    }
  }
}

report::PlotRow trial_plots(const data::SessionSource& source, const std::vector<std::string>& trials,
                            data::Quantity quantity, const std::string& what, const std::string& unit) {
  report::PlotRow row;
  row.min_width_px = 320.0;
  for (const std::string& name : trials) {
    const std::size_t t = source.info().trial_index(name);
    const std::vector<std::size_t> signals = signals_of(source.info().trials[t], quantity);
    if (signals.empty()) continue;
    const bool volt = source.info().trials[t].signals[signals.front()].unit == "V";
    report::Plot plot =
        report::make_time_plot(name, what, source, t, signals, unit.empty() && volt ? "µV" : unit);
    for (std::size_t s = 0; s < plot.series.size(); ++s) plot.series[s].colour = static_cast<int>(s % 8);
    // Muscles that share an excitation lie on one another: one line with all their names.
    for (std::size_t s = 0; s < plot.series.size(); ++s) {
      for (std::size_t k = plot.series.size(); --k > s;) {
        if (plot.series[k].y != plot.series[s].y || plot.series[k].x != plot.series[s].x) continue;
        plot.series[s].label += ", " + plot.series[k].label;
        plot.series.erase(plot.series.begin() + static_cast<std::ptrdiff_t>(k));
      }
    }
    if (plot.series.size() == 1) plot.series.front().label.clear();  // the axis says what it is
    row.plots.push_back(std::move(plot));
  }
  return row;
}

}  // namespace brachium::pipelines
