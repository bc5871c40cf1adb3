#include "pipelines/report/build.hpp"

#include <algorithm>
#include <cctype>
#include <string_view>

#include "data/model/units.hpp"
#include "pipelines/report/thin.hpp"

namespace brachium::pipelines::report {

Cell make_text_cell(std::string text, Tone tone) {
  return {.text = std::move(text), .tone = tone};
}

Cell make_number_cell(double value, int digits, Tone tone) {
  return {.text = significant(value, digits), .tone = tone, .numeric = true};
}

Tone tone_of(data::Severity severity) {
  switch (severity) {
    case data::Severity::error:
      return Tone::bad;
    case data::Severity::warning:
      return Tone::warning;
    case data::Severity::note:
      return Tone::plain;
  }
  return Tone::plain;
}

Paragraph make_finding(const data::Diagnostic& diagnostic) {
  std::string text = diagnostic.message;
  if (!diagnostic.help.empty()) text += "; " + diagnostic.help;
  std::string source = diagnostic.code.empty() ? "" : "`" + diagnostic.code + "`";
  if (diagnostic.where && !diagnostic.where->file.empty()) {
    source += (source.empty() ? "" : ", ") + diagnostic.where->file;
    if (diagnostic.where->line > 0) source += ":" + std::to_string(diagnostic.where->line);
    if (diagnostic.where->line > 0 && diagnostic.where->column > 0)
      source += ":" + std::to_string(diagnostic.where->column);
  }
  if (!source.empty()) text += " (" + source + ")";
  return {.text = std::move(text), .tone = tone_of(diagnostic.severity)};
}

Tone verdict_tone(const std::string& text) {
  std::string lower = text;
  std::transform(lower.begin(), lower.end(), lower.begin(), [](unsigned char c) { return std::tolower(c); });
  // Whole words: "badly placed" is no verdict.
  const auto starts_with_any = [&](std::initializer_list<std::string_view> words) {
    return std::any_of(words.begin(), words.end(), [&](std::string_view word) {
      const bool ends =
          lower.size() <= word.size() || !std::isalnum(static_cast<unsigned char>(lower[word.size()]));
      return lower.starts_with(word) && ends;
    });
  };
  if (starts_with_any({"not identified", "failed", "bad", "rejected", "did not converge"})) return Tone::bad;
  if (starts_with_any({"at upper bound", "at lower bound", "at bound", "excluded", "correlated", "warning",
                       "undriven"})) {
    return Tone::warning;
  }
  if (starts_with_any({"identified", "passed", "converged"}) || lower == "ok" || lower == "good")
    return Tone::good;
  return Tone::plain;
}

Tone threshold_tone(double value, double good, double bad) {
  const bool falling = good < bad;  // small values are good
  if (falling ? value <= good : value >= good) return Tone::good;
  if (falling ? value < bad : value > bad) return Tone::warning;
  return Tone::bad;
}

namespace {

/// Values as stored times this are in `unit` (units here have no offsets).
double factor_to(const std::string& unit, const data::SignalInfo& info) {
  return unit.empty() || unit == info.unit ? 1.0 : data::convert(1.0, info.unit, unit);
}

std::string label_of(const data::SignalInfo& info) {
  return info.muscle.empty() ? info.name : info.muscle;
}

std::string axis_label(const std::string& quantity_name, const std::string& unit) {
  return unit.empty() || unit == "1" ? quantity_name : quantity_name + " [" + unit + "]";
}

}  // namespace

Series make_series(const data::Signal& signal, const std::string& label, const std::string& unit,
                   Style style) {
  const double factor = factor_to(unit, signal.info);
  Series series{.label = label, .style = style};
  series.x.reserve(signal.samples.size());
  series.y.reserve(signal.samples.size());
  for (std::size_t i = 0; i < signal.samples.size(); ++i) {
    series.x.push_back(signal.info.time_s(i));
    series.y.push_back(factor * signal.samples[i]);
  }
  return series;
}

Series make_series(const data::SessionSource& source, std::size_t trial, std::size_t signal,
                   const std::string& label, const std::string& unit, Style style) {
  const data::SignalInfo& info = source.info().trials.at(trial).signals.at(signal);
  if (info.count <= 4 * long_series) return make_series(source.signal(trial, signal), label, unit, style);
  const double factor = factor_to(unit, info);
  Series series{.label = label, .style = style};
  std::vector<double> samples;
  for (std::size_t piece = 0; piece < long_series; ++piece) {
    const std::size_t first = piece * info.count / long_series, end = (piece + 1) * info.count / long_series;
    samples.resize(end - first);
    source.read(trial, signal, first, samples);
    // A piece is one column of pixels: positions in it do not matter.
    for (const std::size_t i : thin_line(std::vector<double>(samples.size(), 0.5), samples)) {
      series.x.push_back(info.time_s(first + i));
      series.y.push_back(factor * samples[i]);
    }
  }
  return series;
}

Plot make_time_plot(const std::string& title, const std::string& quantity_name,
                    const data::SessionSource& source, std::size_t trial,
                    std::span<const std::size_t> signals, const std::string& unit) {
  const std::vector<data::SignalInfo>& infos = source.info().trials.at(trial).signals;
  Plot plot{.title = title, .x_label = "time [s]"};
  for (const std::size_t s : signals)
    plot.series.push_back(make_series(source, trial, s, label_of(infos.at(s)), unit));
  plot.y_label =
      axis_label(quantity_name, !unit.empty() || signals.empty() ? unit : infos.at(signals.front()).unit);
  return plot;
}

}  // namespace brachium::pipelines::report
