/// emg.onset: when does each muscle switch on and off?

#include <fmt/format.h>

#include "emg/onset.hpp"
#include "pipelines/stages/common.hpp"
#include "pipelines/stages/emg_common.hpp"

namespace brachium::pipelines {
namespace {

void run(const StageContext& context, StageOutput& out) {
  const Options& o = *context.options;
  const StageData& input = context.input("signals");
  emg::OnsetOptions onset;
  onset.method = emg::parse_onset_method(o.text("method"));
  onset.factor = o.number("factor");
  onset.lowpass_hz = o.number("detector_lowpass_hz");
  onset.window_s = o.number("window_s");
  onset.minimum_active_s = o.number("minimum_active_s");
  onset.minimum_gap_s = o.number("minimum_gap_s");
  onset.baseline_from_s = o.number("baseline_from_s");
  onset.baseline_to_s = o.number("baseline_to_s");
  onset.baseline_length_s = o.number("baseline_length_s");
  emg::ConditioningOptions band = conditioning_options(o);
  band.rectify = false;
  band.lowpass_hz = 0.0;
  const std::vector<std::string> excluded = excluded_channels(context.maybe_input("quality"));

  TableBuilder bursts("bursts of activity");
  bursts.text("trial")
      .text("channel")
      .number("onset_s", "s")
      .number("offset_s", "s")
      .number("strength", "1")
      .text("remark");
  TableBuilder baselines("baselines");
  baselines.text("trial")
      .text("channel")
      .number("from_s", "s")
      .number("to_s", "s")
      .number("threshold", "1")
      .number("bursts", "1");
  std::size_t done = 0;
  for (const std::string& name : context.trials) {
    const std::size_t t = trial_index(input, name);
    const data::TrialInfo& trial = input.signals->info().trials[t];
    for (const std::size_t s : emg_channels(trial, o.texts("channels"), excluded)) {
      data::Signal signal = input.signals->signal(t, s);
      const emg::ConditioningChain chain = emg::design_conditioning(band, signal.info.rate_hz);
      std::vector<std::span<double>> spans{signal.samples};
      const std::vector<std::string> names{signal.info.name};
      const emg::OutputLayout layout = emg::condition(chain, spans, names, name);
      const emg::OnsetResult result =
          emg::detect_onsets(std::span(signal.samples).first(layout.count), chain.output_rate_hz,
                             signal.info.start_time_s + layout.start_shift_s, signal.info.name, onset);
      for (const emg::Burst& b : result.bursts) {
        bursts.row({name, signal.info.name, b.onset_s, b.offset_s, b.mean_detector,
                    std::string(b.cut_at_start ? "active at the first sample"
                                : b.cut_at_end ? "active at the last sample"
                                               : "")});
      }
      baselines.row({name, signal.info.name, result.baseline_from_s, result.baseline_to_s, result.threshold,
                     static_cast<double>(result.bursts.size())});
    }
    if (context.progress)
      context.progress(static_cast<double>(++done) / static_cast<double>(context.trials.size()), name);
  }
  out.tables["bursts"] = bursts.take();
  out.tables["baselines"] = baselines.take();
}

void fill(const ReportContext& context, report::Section& section) {
  report::GridOptions grid;
  section.title += ": onsets of activity";
  grid.columns = {"trial", "channel", "from_s", "to_s", "bursts"};
  grid.names = {{"from_s", "baseline from"},
                {"to_s", "baseline to"},
                {"onset_s", "onset"},
                {"offset_s", "offset"},
                {"bursts", "bursts found"}};
  grid.decimals = {{"from_s", 2}, {"to_s", 2}, {"onset_s", 3}, {"offset_s", 3}};
  section.blocks.push_back(report::make_grid(context.output->tables.at("baselines"), grid));
  report::Section folded;
  grid.columns = {"trial", "channel", "onset_s", "offset_s", "remark"};
  folded.blocks.push_back(report::make_grid(context.output->tables.at("bursts"), grid));
  section.blocks.push_back(
      report::Details{fmt::format("all {} bursts", context.output->tables.at("bursts").rows()), {folded}});
}

std::string methods(const ReportContext& context) {
  return context.options->text("method") == "tkeo"
             ? "Muscle onsets were detected after Teager-Kaiser energy conditioning (Li, Zhou & Aruin 2007, "
               "doi:10.1007/s10439-007-9320-z) with thresholds in amplitude and duration."
             : "Muscle onsets were detected with thresholds in amplitude and duration (Hodges & Bui 1996, "
               "doi:10.1016/S0921-884X(96)95190-5).";
}

}  // namespace

void add_emg_onset(Catalogue& catalogue) {
  const emg::OnsetOptions d;
  StageSpec spec;
  spec.name = "emg.onset";
  spec.summary = "onset and offset of every burst of activity";
  spec.doc =
      "Detects bursts of activity in the band-passed EMG with a threshold over the baseline and a second one "
      "in time (Hodges & Bui 1996, "
      "doi:10.1016/S0921-884X(96)95190-5), by default after the Teager-Kaiser operator (Li, Zhou & Aruin "
      "2007, doi:10.1007/s10439-007-9320-z). "
      "The baseline is the quietest piece of the trial unless it is given.";
  spec.inputs = {
      {"signals", PortType::signals, "raw EMG", false, false, true},
      {"quality", PortType::tables, "output of emg.quality: its excluded channels are left out", true}};
  spec.output = PortType::tables;
  spec.options = {
      texts_option("channels", {}, "patterns of EMG signal names; empty: every signal of quantity emg"),
      choice_option("method", "tkeo", {"tkeo", "threshold"}, "detector"),
      number_option("factor", "", d.factor, at_least(0),
                    "threshold in standard deviations of the baseline; 0: 3 for threshold, 15 for tkeo"),
      number_option("detector_lowpass_hz", "Hz", d.lowpass_hz, above(0),
                    "smoothing of the detector signal, zero lag"),
      number_option("window_s", "s", d.window_s, above(0),
                    "length of the mean that must exceed the threshold"),
      number_option("minimum_active_s", "s", d.minimum_active_s, at_least(0), "shorter bursts do not count"),
      number_option("minimum_gap_s", "s", d.minimum_gap_s, at_least(0), "shorter gaps do not count"),
      number_option("baseline_from_s", "s", d.baseline_from_s, {},
                    "start of the rest that is the baseline, on the trial's clock"),
      number_option("baseline_to_s", "s", d.baseline_to_s, {},
                    "its end; equal to the start: the quietest piece is found"),
      number_option("baseline_length_s", "s", d.baseline_length_s, above(0),
                    "length of that quietest piece")};
  for (OptionSpec& o : conditioning_option_specs()) spec.options.push_back(std::move(o));
  spec.run = run;
  spec.report = fill;
  spec.methods = methods;
  catalogue.add(std::move(spec));
}

}  // namespace brachium::pipelines
