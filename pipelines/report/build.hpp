#pragma once
/// What fills documents: numbers with the digits they deserve, tables out of data::Table, curves out of
/// data::Signal, and the pictures that stages share. Nothing here knows of HTML.

#include <functional>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "data/model/error.hpp"
#include "data/model/session.hpp"
#include "data/model/signal.hpp"
#include "data/model/table.hpp"
#include "pipelines/report/document.hpp"
#include "pipelines/report/number.hpp"  // significant, fixed, quantity, percent, duration

namespace brachium::pipelines::report {

// ---------------------------------------------------------------- text and numbers

Cell make_text_cell(std::string text, Tone tone = Tone::plain);
Cell make_number_cell(double value, int digits = 4, Tone tone = Tone::plain);

Tone tone_of(data::Severity severity);
/// Code, message, place and help as one finding.
Paragraph make_finding(const data::Diagnostic& diagnostic);

// ---------------------------------------------------------------- tables

/// The tone of verdict texts as calibration and quality write them: bad for "NOT IDENTIFIED" and "failed",
/// warning for "AT ... BOUND", "excluded", "correlated", good for "identified", "ok" and "passed"; else
/// plain.
Tone verdict_tone(const std::string& text);
/// Good, warning or bad by thresholds; falling = true: small values are good.
Tone threshold_tone(double value, double good, double bad);

struct GridOptions {
  int digits = 4;                              ///< significant digits of numbers
  std::map<std::string, int> column_digits{};  ///< by column name, where they differ
  std::map<std::string, int> decimals{};       ///< by column name: a fixed number of decimals instead
  std::set<std::string> words{};               ///< text columns of option names, shown in words
  std::map<std::string, std::string> names{};  ///< shown instead of the column's name (its words)
  std::map<std::string, std::string> units{};  ///< shown in another unit of the same dimension
  std::map<std::string, std::function<Tone(double)>> number_tone{};            ///< by column name
  std::map<std::string, std::function<Tone(const std::string&)>> text_tone{};  ///< by column name
  std::vector<std::string> columns{};  ///< which and in which order; empty: all
  bool verdicts = true;                ///< verdict_tone on text columns without a rule
  std::string undefined = "–";         ///< shown for NaN
};

/// A data table as a grid; names in words, units in the header: "rmse_N_m" is "RMSE [N m]"; captions start
/// with a capital. Throws InputError("missing-column") for a column that the table does not have.
Grid make_grid(const data::Table& table, const GridOptions& options = {});

// ---------------------------------------------------------------- plots

/// A signal over its own clock [s], converted to `unit` ("" keeps the stored one; "deg" for rad, "µV" for V,
/// ...).
Series make_series(const data::Signal& signal, const std::string& label, const std::string& unit = "",
                   Style style = Style::line);

/// The same read piece by piece from a source. A signal of more than 4 x long_series samples is thinned on
/// the way: of each of long_series equal pieces the first, last, lowest and highest sample are kept
/// (thin.hpp), so that the memory it takes does not grow with the length of the recording.
Series make_series(const data::SessionSource& source, std::size_t trial, std::size_t signal,
                   const std::string& label, const std::string& unit = "", Style style = Style::line);
inline constexpr std::size_t long_series = 4096;

/// Time series of one quantity: x is "time [s]", y is `quantity_name [unit]`. Labels are muscle names, else
/// signal names.
Plot make_time_plot(const std::string& title, const std::string& quantity_name,
                    const data::SessionSource& source, std::size_t trial,
                    std::span<const std::size_t> signals, const std::string& unit = "");

/// Measured and modelled values of one quantity on the same frames.
struct Pair {
  std::span<const double> time_s;    ///< [n]
  std::span<const double> measured;  ///< [n] in `unit`
  std::span<const double> modelled;  ///< [n] in `unit`
  std::string quantity;              ///< "elbow moment"
  std::string unit;                  ///< "N m"
};

/// Figures of agreement over the frames where both are finite; residual = modelled - measured.
struct AgreementFigures {
  std::size_t frames = 0;
  double rmse = 0.0, mean_absolute = 0.0, largest = 0.0;  ///< in the unit of the values
  /// rmse / (largest - smallest measured), and 1 - sum residual^2 / sum (measured - mean)^2, negative when
  /// worse than the mean; none where the measured values do not vary.
  std::optional<double> nrmse, r_squared;
  double bias = 0.0;       ///< mean residual
  double deviation = 0.0;  ///< standard deviation of the residual, n - 1
};

/// Needs 2 frames with both values finite: InputError("no-common-frames").
AgreementFigures agreement_figures(std::span<const double> measured, std::span<const double> modelled);

/// Measured (line) and modelled (dashed) over time with the residual under them, figures in the note.
Plot make_agreement_plot(const std::string& title, const Pair& pair);
/// Modelled against measured, equal axes, identity line.
Plot make_scatter_plot(const std::string& title, const Pair& pair);
/// Difference against mean with bias and limits of agreement, bias +- 1.96 sd (Bland & Altman 1986,
/// doi:10.1016/S0140-6736(86)90837-8). Frames of one recording depend on each other, so the limits describe
/// these frames; the note says so.
Plot make_bland_altman_plot(const std::string& title, const Pair& pair);

}  // namespace brachium::pipelines::report
