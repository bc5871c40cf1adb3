#pragma once
/// Options of a calibration, shared by optimise.calibrate and optimise.cross_validate, and what both show of one.

#include <vector>

#include "optimise/calibration.hpp"
#include "pipelines/stage.hpp"

namespace brachium::pipelines {

std::vector<OptionSpec> calibration_option_specs();
/// Options as the calibration takes them; `channels` are those whose gains may be named.
optimise::CalibrationOptions calibration_options(const StageContext& context,
                                                 const data::Coordinate& coordinate);

/// Tables of one fit: verdicts, metrics by trial, windows, iterations.
void add_calibration_tables(const optimise::CalibrationResult& result, StageOutput& out);
/// A calibration's findings with its parameters in words: "biceps tendon_slack_length_factor" as "biceps tendon slack
/// length factor".
void add_calibration_findings(const std::vector<data::Diagnostic>& found, const data::Subject& subject,
                              StageOutput& out);
/// Verdicts as a reader wants them: fitted value beside its bounds and interval, the verdict in its colour.
report::Grid verdict_grid(const data::Table& verdicts);
void add_calibration_report(const StageData& output, report::Section& section);
std::string calibration_methods(const ReportContext& context);

/// A contiguous run of samples as a joint moment signal.
data::Signal moment_signal(const std::string& name, const std::string& coordinate,
                           const std::vector<double>& time_s, const std::vector<double>& values);

}  // namespace brachium::pipelines
