#include "pipelines/stages/calibration_options.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <cmath>

#include "optimise/excitation_error.hpp"
#include "pipelines/report/text.hpp"
#include "pipelines/stages/common.hpp"
#include "pipelines/stages/model_options.hpp"

namespace brachium::pipelines {
namespace {

OptionSpec free_option() {
  OptionSpec free;
  free.key = "free";
  free.type = OptionType::tables;
  free.doc = "what the calibration may change, one [[stage.free]] each";
  OptionSpec parameter = text_option("parameter", "strength", "what is free");
  parameter.fallback.reset();
  parameter.allowed = {"strength",
                       "optimal_fibre_length",
                       "tendon_slack_length",
                       "pennation",
                       "max_contraction_velocity",
                       "delay",
                       "time_constant_1",
                       "time_constant_2",
                       "recursion_1",
                       "recursion_2",
                       "shape",
                       "gain"};
  free.fields = {
      parameter,
      choice_option("scope", "muscle", {"muscle", "channel", "group", "global"},
                    "one value for each muscle (or channel, for gains), group, or for all"),
      texts_option("only", {}, "patterns of the muscles, groups or channels it is restricted to"),
      optional_number("lower", "", {},
                      "lower bound, in the parameter's SI unit or, if relative, as a factor on the start"),
      optional_number("upper", "", {}, "upper bound, likewise"),
      flag_option("relative", false, "bounds and prior are factors on the start"),
      optional_number("prior_mean", "", {}, "centre of a normal prior; default: the start"),
      optional_number("prior_sd", "", above(0), "its standard deviation; none: no prior")};
  Options strength, slack, shape, delay;
  const auto common = [](Options& o, const char* parameter_name, const char* scope) {
    o.set("parameter", std::string(parameter_name));
    o.set("scope", std::string(scope));
    o.set("only", std::vector<std::string>{});
    o.set("relative", false);
  };
  common(strength, "strength", "group");
  common(slack, "tendon_slack_length", "group");
  slack.set("relative", true);
  slack.set("prior_sd", 0.05);
  common(shape, "shape", "global");
  common(delay, "delay", "global");
  free.fallback = std::vector<Options>{strength, slack, shape, delay};
  return free;
}

OptionSpec gains_option() {
  OptionSpec gains;
  gains.key = "gain";
  gains.type = OptionType::tables;
  gains.doc = "start (or fixed value) of a channel's gain, one [[stage.gain]] each; 1 where absent";
  OptionSpec channel = text_option("channel", "", "channel");
  channel.fallback.reset();
  OptionSpec value = number_option("value", "", 1.0, above(0), "gain");
  value.fallback.reset();
  gains.fields = {channel, value};
  gains.fallback = std::vector<Options>{};
  return gains;
}

}  // namespace

std::vector<OptionSpec> calibration_option_specs() {
  std::vector<OptionSpec> specs = {
      optional_text("coordinate", "joint coordinate; may be left out where the scene has one"),
      free_option(),
      gains_option(),
      flag_option("linear_strength_first", true,
                  "start from the bounded linear fit of the strengths, where they are free"),
      choice_option("solver", "levenberg_marquardt", optimise::solver_names(),
                    "own or GSL's Levenberg-Marquardt, or one of NLopt's"),
      integer_option("starts", 1, between(1, 1000),
                     "multi-start: the parameters' own start and further ones drawn between the bounds"),
      integer_option("seed", 1, at_least(0), "of multi-starts and of the simulation of excitation errors"),
      integer_option("max_iterations", 200, between(1, 100000), "of one start"),
      optional_number(
          "scale_N_m", "N m", above(0),
          "what a residual is divided by; default: the standard deviation of the training trials' moment"),
      number_option("edge_s", "s", 0.5, at_least(0), "left out at both ends of each trial"),
      optional_number("independent_rate_hz", "Hz", above(0),
                      "independent residuals a second: below the reference's rate it weighs the data down "
                      "against priors, whatever the rate of recording; "
                      "default: every residual counts"),
      integer_option("decimate", 1, between(1, 1000), "use every n-th sample of the reference moment"),
      optional_number("excitation_cv", "", at_least(0),
                      "coefficient of variation of the envelopes' noise; default: from the EMG's band and "
                      "the envelope's cut-off; 0: none"),
      number_option("emg_band_low_hz", "Hz", 30.0, above(0),
                    "lower edge of the conditioned EMG's band, for that noise"),
      number_option("emg_band_high_hz", "Hz", 220.0, above(0),
                    "upper edge of the flat band that varies as much as EMG does: its statistical bandwidth "
                    "is about 190 Hz"),
      number_option("noise_band_high_hz", "Hz", 500.0, above(0),
                    "upper edge of the sensor noise that emg.envelope took off at rest: half the sampling "
                    "rate, or the amplifier's"),
      number_option("envelope_lowpass_hz", "Hz", 6.0, above(0), "cut-off of the envelope, for that noise"),
      integer_option("noise_replicates", 20, between(4, 10000),
                     "simulated data sets behind the bias and the intervals"),
      flag_option("correct_bias", true, "take the bias from errors in the excitation off the fitted values"),
  };
  for (OptionSpec& o : muscle_option_specs()) specs.push_back(std::move(o));
  for (OptionSpec& o : activation_option_specs()) specs.push_back(std::move(o));
  return specs;
}

/// Envelope at rest that emg.envelope has taken off, in units of excitation: root mean square over the channels; 0 where
/// it took off none, or did not normalise.
double rest_level(const StageData& excitation) {
  const auto found = excitation.tables.find("normalisation");
  if (found == excitation.tables.end() || found->second.rows() == 0) return 0.0;
  const data::Table& table = found->second;
  double square = 0.0;
  for (std::size_t k = 0; k < table.rows(); ++k)
    square += std::pow(table.numbers("rest_V")[k] / table.numbers("reference_V")[k], 2);
  return std::sqrt(square / static_cast<double>(table.rows()));
}

optimise::CalibrationOptions calibration_options(const StageContext& context,
                                                 const data::Coordinate& coordinate) {
  const Options& o = *context.options;
  optimise::CalibrationOptions c;
  c.problem.coordinate = coordinate.name;
  c.problem.model = model_choice(o);
  for (const Options& f : o.tables("free")) {
    optimise::FreeQuantity q;
    q.quantity = optimise::parse_quantity(f.text("parameter"));
    q.scope = optimise::parse_scope(f.text("scope"));
    q.only = f.texts("only");
    q.lower = f.maybe_number("lower");
    q.upper = f.maybe_number("upper");
    q.relative = f.boolean("relative");
    q.prior_mean = f.maybe_number("prior_mean");
    q.prior_sd = f.maybe_number("prior_sd");
    c.problem.free.push_back(q);
  }
  for (const Options& g : o.tables("gain")) c.problem.channel_gains[g.text("channel")] = g.number("value");
  c.problem.scale_N_m = o.maybe_number("scale_N_m");
  c.problem.edge_s = o.number("edge_s");
  c.problem.independent_rate_hz = o.maybe_number("independent_rate_hz");
  c.problem.decimate = static_cast<std::size_t>(o.integer("decimate"));
  c.problem.threads = context.threads;
  c.linear_strength_first = o.boolean("linear_strength_first");
  c.solver.solver = optimise::parse_solver(o.text("solver"));
  c.solver.starts = static_cast<std::size_t>(o.integer("starts"));
  c.solver.seed = static_cast<std::uint64_t>(o.integer("seed"));
  c.solver.max_iterations = static_cast<int>(o.integer("max_iterations"));
  c.solver.threads = context.threads;
  if (context.progress) {
    c.solver.progress = [&context, limit = c.solver.max_iterations](const optimise::Iteration& row) {
      context.progress(static_cast<double>(row.iteration) / static_cast<double>(limit),
                       optimise::log_row(row));
    };
  }
  const double band_low = o.number("emg_band_low_hz"), band_high = o.number("emg_band_high_hz"),
               cutoff = o.number("envelope_lowpass_hz");
  const std::optional<double> cv = o.maybe_number("excitation_cv");
  c.excitation_noise.coefficient_of_variation =
      cv ? *cv : optimise::envelope_coefficient_of_variation(band_low, band_high, cutoff);
  c.excitation_noise.cutoff_hz = cutoff;
  // What was taken off at rest is sensor noise, flat up to its own edge: it beats with the EMG where both are.
  const double floor = rest_level(context.input("excitation")),
               noise_high = std::max(band_high, o.number("noise_band_high_hz"));
  c.excitation_noise.subtracted_floor = floor;
  c.excitation_noise.overlapping_floor = floor * std::sqrt((band_high - band_low) / (noise_high - band_low));
  c.excitation_noise.rest_coefficient_of_variation =
      cv && *cv == 0.0 ? 0.0 : optimise::envelope_coefficient_of_variation(band_low, noise_high, cutoff);
  c.excitation_noise.replicates = static_cast<int>(o.integer("noise_replicates"));
  c.excitation_noise.seed = c.solver.seed;
  c.correct_bias = o.boolean("correct_bias");
  return c;
}

data::Signal moment_signal(const std::string& name, const std::string& coordinate,
                           const std::vector<double>& time_s, const std::vector<double>& values) {
  data::Signal signal;
  signal.info.name = name;
  signal.info.quantity = data::Quantity::joint_moment;
  signal.info.unit = "N m";
  signal.info.coordinate = coordinate;
  signal.info.start_time_s = time_s.front();
  double step = 1.0;
  for (std::size_t i = 1; i < time_s.size(); ++i)
    step = i == 1 ? time_s[1] - time_s[0] : std::min(step, time_s[i] - time_s[i - 1]);
  signal.info.rate_hz = 1.0 / step;
  std::vector<std::string> gaps;
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (i > 0) {
      // Frames that are not compared lie on the straight line between their neighbours, and the attribute says where.
      const auto missing = std::lround((time_s[i] - time_s[i - 1]) / step) - 1;
      for (long k = 1; k <= missing; ++k) {
        signal.samples.push_back(values[i - 1] + (values[i] - values[i - 1]) * static_cast<double>(k) /
                                                     static_cast<double>(missing + 1));
      }
      if (missing > 0) gaps.push_back(fmt::format("{:.3f} to {:.3f}", time_s[i - 1], time_s[i]));
    }
    signal.samples.push_back(values[i]);
  }
  signal.info.count = signal.samples.size();
  if (!gaps.empty()) signal.info.attributes["not_compared_s"] = fmt::format("{}", fmt::join(gaps, "; "));
  return signal;
}

void add_calibration_findings(const std::vector<data::Diagnostic>& found, const data::Subject& subject,
                              StageOutput& out) {
  for (data::Diagnostic d : found) {
    for (const data::ParameterVerdict& v : subject.verdicts) {
      const std::string label = v.muscle + " " + v.parameter,
                        name = report::label_of_name(v.parameter, v.unit);
      const std::string words =
          (v.muscle == "*" ? "common" : v.muscle) + " " + name.substr(0, name.find(" ["));
      for (std::size_t at = d.message.find(label); at != std::string::npos;
           at = d.message.find(label, at + words.size()))
        d.message.replace(at, label.size(), words);
    }
    out.diagnostics.push_back(std::move(d));
  }
}

void add_calibration_tables(const optimise::CalibrationResult& result, StageOutput& out) {
  out.tables["verdicts"] = optimise::verdict_table(result.subject);
  TableBuilder fit("training trials");
  fit.text("trial")
      .number("frames", "1")
      .number("rmse_N_m", "N m")
      .number("nrmse_range", "1")
      .number("r2", "1")
      .number("bias_N_m", "N m")
      .number("first_s", "s")
      .number("last_s", "s")
      .number("left_out", "1");
  for (std::size_t i = 0; i < result.windows.size(); ++i) {
    const optimise::TrialWindow& w = result.windows[i];
    const optimise::Metrics& m = result.trial_metrics[i];
    fit.row({w.name, static_cast<double>(m.count), m.rmse, or_undefined(m.nrmse_range), or_undefined(m.r2),
             m.bias, w.first_time_s, w.last_time_s, static_cast<double>(w.before + w.after + w.masked)});
  }
  out.tables["training"] = fit.take();
  TableBuilder iterations("iterations of the best start");
  iterations.number("iteration", "1")
      .number("evaluations", "1")
      .number("cost", "1")
      .number("gradient", "1")
      .number("step", "1");
  for (const optimise::Iteration& i : result.summary.iterations) {
    iterations.row({static_cast<double>(i.iteration), static_cast<double>(i.evaluations), i.cost,
                    i.gradient_norm, i.step_norm});
  }
  out.tables["iterations"] = iterations.take();
  TableBuilder starts("multi-start");
  starts.number("start", "1")
      .number("cost_at_start", "1")
      .number("cost", "1")
      .number("iterations", "1")
      .text("reason");
  for (std::size_t i = 0; i < result.summary.starts.size(); ++i) {
    const optimise::StartResult& s = result.summary.starts[i];
    starts.row({static_cast<double>(i), s.cost_start, s.cost, static_cast<double>(s.iterations), s.reason});
  }
  out.tables["starts"] = starts.take();
  out.attributes["summary"] = result.summary.message();
}

report::Grid verdict_grid(const data::Table& verdicts) {
  const auto text = [&](const char* column, std::size_t row) { return verdicts.texts(column)[row]; };
  const auto number = [&](const char* column, std::size_t row) {
    return report::significant(verdicts.numbers(column)[row], 3);
  };
  report::Grid grid;
  grid.caption = verdicts.title;
  grid.header = {"of", "parameter", "start", "fitted", "bounds", "95 % interval", "verdict", "remark"};
  for (std::size_t i = 0; i < verdicts.rows(); ++i) {
    const std::string verdict = text("verdict", i), unit = text("unit", i), owner = text("owner", i);
    const bool known = std::isfinite(verdicts.numbers("standard_error")[i]);
    const auto cell = [](std::string shown) {
      return report::Cell{.text = std::move(shown), .numeric = true};
    };
    grid.rows.push_back(
        {report::make_text_cell(owner == "*" ? "all" : owner),
         report::make_text_cell(report::typeset_label(report::label_of_name(text("parameter", i), unit))),
         cell(number("start", i)), cell(number("fitted", i)),
         cell(number("lower", i) + " to " + number("upper", i)),
         cell(known ? number("interval_lower", i) + " to " + number("interval_upper", i) : "unknown"),
         report::make_text_cell(verdict, report::verdict_tone(verdict)),
         report::make_text_cell(text("remark", i))});
  }
  return grid;
}

/// How the fit ended, in a sentence: the solver's reason, and by how much it lowered the cost.
report::Paragraph outcome_paragraph(const StageData& output, const std::string& summary) {
  const bool converged = summary.starts_with("converged");
  std::string text = summary.substr(0, summary.find(';'));
  if (const auto found = output.tables.find("iterations");
      found != output.tables.end() && found->second.rows() > 1) {
    const std::vector<double>& cost = found->second.numbers("cost");
    text += fmt::format(
        "; {} iterations lowered the cost (half the sum of squared weighted residuals and priors) from {} to "
        "{}",
        static_cast<long>(found->second.numbers("iteration").back()), report::significant(cost.front(), 3),
        report::significant(cost.back(), 3));
  }
  text[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(text[0])));
  return {text + ".", converged ? report::Tone::plain : report::Tone::warning};
}

void add_calibration_report(const StageData& output, report::Section& section) {
  section.title += ": calibration";
  if (const auto summary = output.attributes.find("summary"); summary != output.attributes.end())
    section.blocks.push_back(outcome_paragraph(output, summary->second));
  section.blocks.push_back(verdict_grid(output.tables.at("verdicts")));
  report::GridOptions training;
  training.digits = 3;
  training.undefined = undefined_text;
  training.names = {{"nrmse_range", "NRMSE of the range"},
                    {"first_s", "from"},
                    {"last_s", "to"},
                    {"left_out", "frames left out"}};
  training.decimals = {{"first_s", 2}, {"last_s", 2}};
  section.blocks.push_back(report::make_grid(output.tables.at("training"), training));
  report::PlotRow plots;
  plots.min_width_px = 420.0;
  for (std::size_t t = 0; t < output.signals->info().trials.size(); ++t) {
    const data::TrialInfo& trial = output.signals->info().trials[t];
    if (!trial.has_signal("reference") || !trial.has_signal("modelled")) continue;
    const data::Signal reference = output.signals->signal(t, trial.signal_index("reference")),
                       modelled = output.signals->signal(t, trial.signal_index("modelled"));
    std::vector<double> time(reference.samples.size());
    for (std::size_t i = 0; i < time.size(); ++i) time[i] = reference.info.time_s(i);
    plots.plots.push_back(report::make_agreement_plot(
        trial.name, {time, reference.samples, modelled.samples, "moment", "N m"}));
  }
  if (!plots.plots.empty()) {
    report::Section folded;
    folded.blocks.push_back(plots);
    section.blocks.push_back(
        report::Details{"measured and modelled moment on the training trials", {folded}});
  }
  if (output.tables.contains("starts") && output.tables.at("starts").rows() > 1)
    section.blocks.push_back(report::make_grid(output.tables.at("starts")));
}

std::string calibration_methods(const ReportContext& context) {
  const Options& o = *context.options;
  std::vector<std::string> free;
  for (const Options& f : o.tables("free")) {
    std::string name = f.text("parameter");
    for (char& c : name) {
      if (c == '_') c = ' ';
    }
    free.push_back(fmt::format("{} ({})", name, f.text("scope")));
  }
  const std::string noise =
      o.maybe_number("excitation_cv") == 0.0
          ? "; noise in the excitation was not allowed for"
          : fmt::format(
                " and for noise in the excitation, by a corrected score (Nakamura 1990, "
                "doi:10.1093/biomet/77.1.127) simulated as by Cook & Stefanski 1994, "
                "doi:10.1080/01621459.1994.10476871; the bias that it brings was {}",
                o.boolean("correct_bias") ? "taken off the fitted values" : "reported, not taken off");
  return fmt::format(
      "The model was calibrated by bounded least squares ({}) with exact derivatives of the whole chain; "
      "free were {}. Standard errors allow for autocorrelated residuals (Newey & West 1987, "
      "doi:10.2307/1913610){}.",
      report::in_words(o.text("solver")), fmt::join(free, ", "), noise);
}

}  // namespace brachium::pipelines
