/// Pictures and figures of agreement.
///   symbol | identifier | unit        | meaning
///   m_i    | measured   | as given    | measured value of frame i
///   p_i    | modelled   | as given    | modelled value of frame i
///   e_i    | residual   | as given    | p_i - m_i: positive where the model is too high
///   b      | bias       | as given    | mean of e_i
///   s      | deviation  | as given    | standard deviation of e_i, sqrt(sum (e_i - b)^2 / (n - 1))

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "pipelines/report/build.hpp"

namespace brachium::pipelines::report {
namespace {

constexpr int kMeasuredColour = 0;
constexpr int kModelledColour = 1;
constexpr int kResidualColour = 2;
constexpr double kLimitFactor = 1.96;  // two-sided 95 % of a normal distribution (Bland & Altman 1986)

void check(const Pair& pair) {
  if (pair.time_s.size() != pair.measured.size() || pair.measured.size() != pair.modelled.size()) {
    throw std::logic_error("agreement of `" + pair.quantity +
                           "`: time, measured and modelled differ in length");
  }
}

std::string axis_label(const std::string& name, const std::string& unit) {
  return unit.empty() || unit == "1" ? name : name + " [" + unit + "]";
}

std::vector<double> copy(std::span<const double> values) {
  return {values.begin(), values.end()};
}

std::vector<double> residuals(const Pair& pair) {
  std::vector<double> e(pair.measured.size());
  for (std::size_t i = 0; i < e.size(); ++i) e[i] = pair.modelled[i] - pair.measured[i];
  return e;
}

/// A plot is drawn also where figures cannot be had; the sentence then says why.
std::string figures_sentence(const Pair& pair) {
  try {
    const AgreementFigures f = agreement_figures(pair.measured, pair.modelled);
    const std::string relative = f.nrmse && f.r_squared
                                     ? ", NRMSE " + percent(*f.nrmse, 3) + ", R² " + fixed(*f.r_squared, 3)
                                     : ", NRMSE and R² not defined, since the measured values do not vary";
    return "RMSE " + quantity(f.rmse, pair.unit, 3) + relative + ", bias " + quantity(f.bias, pair.unit, 3) +
           ", largest " + quantity(f.largest, pair.unit, 3) + ", " + std::to_string(f.frames) + " frames.";
  } catch (const data::InputError& error) {
    return "No figures of agreement: " + error.diagnostics().front().message + ".";
  }
}

}  // namespace

AgreementFigures agreement_figures(std::span<const double> measured, std::span<const double> modelled) {
  if (measured.size() != modelled.size())
    throw std::logic_error("agreement: measured and modelled differ in length");
  AgreementFigures f;
  double sum_measured = 0.0;
  double sum_residual = 0.0;
  double sum_square = 0.0;
  double sum_absolute = 0.0;
  double lowest = std::numeric_limits<double>::infinity();
  double highest = -lowest;
  const auto both = [&](std::size_t i) { return std::isfinite(measured[i]) && std::isfinite(modelled[i]); };
  for (std::size_t i = 0; i < measured.size(); ++i) {
    if (!both(i)) continue;
    const double residual = modelled[i] - measured[i];
    ++f.frames;
    sum_measured += measured[i];
    sum_residual += residual;
    sum_square += residual * residual;
    sum_absolute += std::abs(residual);
    f.largest = std::max(f.largest, std::abs(residual));
    lowest = std::min(lowest, measured[i]);
    highest = std::max(highest, measured[i]);
  }
  if (f.frames < 2) {
    throw data::InputError(
        "no-common-frames",
        "measured and modelled values have " + std::to_string(f.frames) + " frames in common, 2 are needed");
  }
  const double n = static_cast<double>(f.frames);
  const double mean = sum_measured / n;
  f.bias = sum_residual / n;
  double sum_spread = 0.0;
  double sum_deviation = 0.0;
  for (std::size_t i = 0; i < measured.size(); ++i) {
    if (!both(i)) continue;
    const double residual = modelled[i] - measured[i];
    sum_spread += (measured[i] - mean) * (measured[i] - mean);
    sum_deviation += (residual - f.bias) * (residual - f.bias);
  }
  f.rmse = std::sqrt(sum_square / n);
  f.mean_absolute = sum_absolute / n;
  if (highest > lowest) {
    f.nrmse = f.rmse / (highest - lowest);
    f.r_squared = 1.0 - sum_square / sum_spread;
  }
  f.deviation = std::sqrt(sum_deviation / (n - 1.0));
  return f;
}

Plot make_agreement_plot(const std::string& title, const Pair& pair) {
  check(pair);
  const std::vector<double> time = copy(pair.time_s);
  Plot plot{.title = title, .x_label = "time [s]", .y_label = axis_label(pair.quantity, pair.unit)};
  plot.height_px = 200.0;
  plot.series.push_back(
      {.label = "measured", .x = time, .y = copy(pair.measured), .colour = kMeasuredColour});
  plot.series.push_back({.label = "modelled",
                         .x = time,
                         .y = copy(pair.modelled),
                         .style = Style::dashed,
                         .colour = kModelledColour});
  Plot residual{.y_label = axis_label("modelled − measured", pair.unit)};
  residual.height_px = 80.0;
  residual.series.push_back({.x = time, .y = residuals(pair), .colour = kResidualColour});
  residual.levels.push_back({.y = 0.0});
  plot.below.push_back(std::move(residual));
  plot.note = figures_sentence(pair);
  return plot;
}

Plot make_scatter_plot(const std::string& title, const Pair& pair) {
  check(pair);
  Plot plot{.title = title,
            .x_label = axis_label("measured " + pair.quantity, pair.unit),
            .y_label = axis_label("modelled " + pair.quantity, pair.unit)};
  plot.height_px = 300.0;
  plot.equal_axes = true;
  plot.series.push_back({.x = copy(pair.measured),
                         .y = copy(pair.modelled),
                         .style = Style::points,
                         .colour = kMeasuredColour});
  plot.note = figures_sentence(pair);
  return plot;
}

Plot make_bland_altman_plot(const std::string& title, const Pair& pair) {
  check(pair);
  Plot plot{.title = title,
            .x_label = axis_label("mean of measured and modelled", pair.unit),
            .y_label = axis_label("modelled − measured", pair.unit)};
  plot.height_px = 300.0;
  std::vector<double> mean(pair.measured.size());
  for (std::size_t i = 0; i < mean.size(); ++i) mean[i] = 0.5 * (pair.measured[i] + pair.modelled[i]);
  plot.series.push_back(
      {.x = std::move(mean), .y = residuals(pair), .style = Style::points, .colour = kMeasuredColour});
  try {
    const AgreementFigures f = agreement_figures(pair.measured, pair.modelled);
    const double half = kLimitFactor * f.deviation;
    plot.levels = {{.y = f.bias, .label = "bias " + quantity(f.bias, pair.unit, 3)},
                   {.y = f.bias + half, .label = "+1.96 sd " + quantity(f.bias + half, pair.unit, 3)},
                   {.y = f.bias - half, .label = "−1.96 sd " + quantity(f.bias - half, pair.unit, 3)}};
    plot.note =
        "Bias and limits of agreement, bias ± 1.96 sd (doi:10.1016/S0140-6736(86)90837-8). Frames of one "
        "recording depend on each other: the limits describe these " +
        std::to_string(f.frames) + " frames, not future ones.";
  } catch (const data::InputError& error) {
    plot.note = "No limits of agreement: " + error.diagnostics().front().message + ".";
  }
  return plot;
}

}  // namespace brachium::pipelines::report
