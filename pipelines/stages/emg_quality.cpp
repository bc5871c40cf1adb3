/// emg.quality: is each channel of each trial worth using?

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <set>

#include "data/model/parallel.hpp"
#include "emg/quality.hpp"
#include "pipelines/stages/common.hpp"
#include "pipelines/stages/emg_common.hpp"

namespace brachium::pipelines {
namespace {

const emg::QualityOptions defaults;

emg::QualityOptions quality_options(const Options& o) {
  emg::QualityOptions q;
  q.line_hz = o.number("line_hz");
  q.line_harmonics = static_cast<int>(o.integer("line_harmonics"));
  q.clipping_fraction = o.number("clipping_fraction");
  q.dropout_s = o.number("dropout_s");
  q.dropout_fraction = o.number("dropout_fraction");
  q.line_ratio = o.number("line_ratio");
  q.snr_db = o.number("snr_db");
  q.baseline_drift = o.number("baseline_drift");
  q.median_low_hz = o.number("median_low_hz");
  q.median_high_hz = o.number("median_high_hz");
  return q;
}

void run(const StageContext& context, StageOutput& out) {
  const Options& options = *context.options;
  const StageData& input = context.input("signals");
  const emg::QualityOptions thresholds = quality_options(options);
  const std::vector<std::string> excluded_by_name = options.texts("exclude");

  struct Task {
    std::size_t trial, signal;
  };
  std::vector<Task> tasks;
  std::set<std::string> channels;
  for (const std::string& name : context.trials) {
    const std::size_t t = trial_index(input, name);
    for (const std::size_t s : emg_channels(input.signals->info().trials[t], options.texts("channels"), {})) {
      tasks.push_back({t, s});
      channels.insert(input.signals->info().trials[t].signals[s].name);
    }
  }
  select(excluded_by_name, {channels.begin(), channels.end()},
         "EMG channel");  // a name that is not there is a mistake

  std::vector<emg::ChannelQuality> rows(tasks.size());
  data::parallel_for(
      tasks.size(), threads_within_budget(context.threads, input.signals->info(), context.trials),
      [&](std::size_t i) {
        const data::TrialInfo& trial = input.signals->info().trials[tasks[i].trial];
        const data::Signal signal = input.signals->signal(tasks[i].trial, tasks[i].signal);
        rows[i] = emg::assess(signal.samples, signal.info.rate_hz, trial.name, signal.info.name, thresholds);
        if (context.progress)
          context.progress(static_cast<double>(i + 1) / static_cast<double>(tasks.size()), signal.info.name);
      });

  const std::string on_bad = options.text("on_bad");
  std::set<std::string> excluded(excluded_by_name.begin(), excluded_by_name.end());
  std::vector<data::Diagnostic> bad;
  for (const emg::ChannelQuality& row : rows) {
    if (row.good() || excluded.contains(row.channel)) continue;
    const bool quiet_by_design = trial_info(input, row.trial).kind == data::TrialKind::rest ||
                                 trial_info(input, row.trial).kind == data::TrialKind::passive;
    std::vector<std::string> reasons = row.reasons;
    // A muscle at rest has no activity to compare its rest with.
    if (quiet_by_design) std::erase_if(reasons, [](const std::string& r) { return r.starts_with("SNR"); });
    if (reasons.empty()) continue;
    bad.push_back(
        {data::Severity::error, "bad-channel",
         fmt::format("channel `{}` of trial `{}` is bad: {}", row.channel, row.trial,
                     fmt::join(reasons, "; ")),
         std::nullopt,
         "look at the recording; then fix it, name it in `exclude`, set `on_bad`, or change the threshold"});
  }
  if (on_bad == "fail" && !bad.empty()) throw data::InputError(std::move(bad));
  for (data::Diagnostic& d : bad) {
    d.severity = data::Severity::warning;
    out.diagnostics.push_back(d);
  }
  if (on_bad == "exclude") {
    for (const data::Diagnostic& d : bad) {
      for (const std::string& channel : channels) {
        if (d.message.starts_with(fmt::format("channel `{}` ", channel))) excluded.insert(channel);
      }
    }
  }
  for (const std::string& channel : excluded)
    out.note("excluded-channel", fmt::format("channel `{}` is excluded from all trials", channel));
  out.attributes["excluded_channels"] = fmt::format("{}", fmt::join(excluded, ","));
  out.attributes["bad_channels"] = std::to_string(bad.size());
  out.tables["quality"] = emg::quality_table(rows);
}

void fill(const ReportContext& context, report::Section& section) {
  section.blocks.push_back(
      report::Paragraph{"Measures of every channel in every trial, as shares of the samples, of the power "
                        "(line frequency) or of the EMG's RMS (baseline drift)."});
  report::GridOptions grid;
  grid.digits = 3;
  grid.decimals = {{"snr_db", 1}, {"median_hz", 0}, {"line_ratio", 3}, {"baseline_drift", 2}};
  grid.column_digits = {{"clipped_fraction", 2}, {"dropout_fraction", 2}};
  grid.names = {{"snr_db", "SNR"},
                {"line_ratio", "line power"},
                {"median_hz", "median frequency"},
                {"clipped_fraction", "clipped"},
                {"dropout_fraction", "dropouts"}};
  grid.columns = {"trial",     "channel",          "verdict",          "snr_db",         "line_ratio",
                  "median_hz", "clipped_fraction", "dropout_fraction", "baseline_drift", "reasons"};
  section.title += ": EMG quality";
  section.blocks.push_back(report::make_grid(context.output->tables.at("quality"), grid));
}

std::string methods(const ReportContext& context) {
  return fmt::format(
      "Every EMG channel was checked for clipping, dropouts, a flat line, power at the line frequency (limit "
      "{:.0f} % of the power), "
      "signal-to-noise ratio between activity and rest (limit {:.0f} dB), baseline drift and median "
      "frequency (Welch 1967, doi:10.1109/TAU.1967.1161901; "
      "plausible range {:.0f} to {:.0f} Hz).",
      100.0 * context.options->number("line_ratio"), context.options->number("snr_db"),
      context.options->number("median_low_hz"), context.options->number("median_high_hz"));
}

}  // namespace

void add_emg_quality(Catalogue& catalogue) {
  StageSpec spec;
  spec.name = "emg.quality";
  spec.summary = "checks every raw EMG channel: clipping, dropouts, line noise, SNR, drift, median frequency";
  spec.doc =
      "Measures each EMG channel of each trial and compares it with thresholds. A bad channel fails the "
      "stage (`on_bad = \"fail\"`), is "
      "reported (`warn`), or is excluded by name from all trials (`exclude`); `emg.envelope` takes this "
      "stage as its input `quality` and leaves "
      "excluded channels out. In trials of kind `rest` or `passive` the signal-to-noise ratio is not judged.";
  spec.inputs = {{"signals", PortType::signals, "raw EMG", false, false, true}};
  spec.output = PortType::tables;
  spec.options = {
      texts_option("channels", {}, "patterns of EMG signal names; empty: every signal of quantity emg"),
      texts_option("exclude", {}, "channels to leave out of everything that follows, by name"),
      choice_option("on_bad", "warn", {"fail", "warn", "exclude"}, "what to do with a bad channel"),
      number_option("line_hz", "Hz", defaults.line_hz, at_least(0),
                    "line frequency; 0 looks at 50 and 60 Hz"),
      integer_option("line_harmonics", defaults.line_harmonics, between(1, 20),
                     "harmonics looked at, the fundamental among them"),
      number_option("clipping_fraction", "", defaults.clipping_fraction, between(0, 1),
                    "largest share of samples at the extremes, in runs of two or more"),
      number_option("dropout_s", "s", defaults.dropout_s, above(0),
                    "a run of one repeated value at least this long is a dropout"),
      number_option("dropout_fraction", "", defaults.dropout_fraction, between(0, 1),
                    "largest share of the trial in dropouts"),
      number_option("line_ratio", "", defaults.line_ratio, between(0, 1),
                    "largest share of the power that stands above its surroundings at line frequencies"),
      number_option("snr_db", "dB", defaults.snr_db, {}, "smallest ratio of activity to rest"),
      number_option("baseline_drift", "", defaults.baseline_drift, above(0),
                    "largest movement of the baseline over the RMS of the EMG"),
      number_option("median_low_hz", "Hz", defaults.median_low_hz, at_least(0),
                    "lower end of plausible median frequencies"),
      number_option("median_high_hz", "Hz", defaults.median_high_hz, above(0),
                    "upper end of plausible median frequencies"),
  };
  spec.run = run;
  spec.report = fill;
  spec.methods = methods;
  catalogue.add(std::move(spec));
}

}  // namespace brachium::pipelines
