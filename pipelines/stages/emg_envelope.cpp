/// emg.envelope: raw EMG to normalised linear envelopes (excitations).

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <atomic>
#include <functional>
#include <mutex>

#include "data/model/parallel.hpp"
#include "emg/conditioning.hpp"
#include "emg/normalisation.hpp"
#include "emg/rest_level.hpp"
#include "pipelines/stages/common.hpp"
#include "pipelines/stages/emg_common.hpp"
#include "pipelines/stages/emg_envelope_report.hpp"

namespace brachium::pipelines {
namespace {

emg::ConditioningOptions envelope_options(const Options& o) {
  emg::ConditioningOptions c = conditioning_options(o);
  c.rectify = true;
  c.lowpass_hz = o.number("lowpass_hz");
  c.lowpass_order = static_cast<int>(o.integer("lowpass_order"));
  c.output_rate_hz = o.number("output_rate_hz");
  c.trim_edges = o.boolean("trim_edges");
  return c;
}

/// One trial's channels conditioned group by group; `take` is given each channel's envelope.
using Take = std::function<void(const data::SignalInfo& raw, std::span<double> envelope,
                                const emg::OutputLayout& layout)>;

void condition_by_groups(const emg::ConditioningChain& chain, const data::SessionSource& source,
                         std::size_t t, const std::vector<std::size_t>& channels, std::size_t budget_bytes,
                         const Take& take) {
  const data::TrialInfo& trial = source.info().trials[t];
  const std::size_t count = trial.signals[channels.front()].count;
  const std::size_t group =
      std::clamp<std::size_t>(budget_bytes / std::max<std::size_t>(1, count * sizeof(double)), 1, 8);
  std::vector<std::vector<double>> samples(std::min(group, channels.size()));
  for (std::size_t first = 0; first < channels.size(); first += group) {
    const std::size_t last = std::min(channels.size(), first + group);
    std::vector<std::span<double>> spans;
    std::vector<std::string> names;
    for (std::size_t c = first; c < last; ++c) {
      std::vector<double>& memory = samples[c - first];
      memory.resize(count);
      source.read(t, channels[c], 0, memory);
      spans.emplace_back(memory);
      names.push_back(trial.signals[channels[c]].name);
    }
    const emg::OutputLayout layout = emg::condition(chain, spans, names, trial.name);
    for (std::size_t c = first; c < last; ++c) {
      take(trial.signals[channels[c]], spans[c - first].subspan(0, layout.count), layout);
    }
  }
}

struct Plan {
  emg::ConditioningOptions conditioning;
  std::vector<std::string> patterns, excluded;

  std::vector<std::size_t> channels(const data::TrialInfo& trial) const {
    return emg_channels(trial, patterns, excluded);
  }

  emg::ConditioningChain chain(const data::TrialInfo& trial, const std::vector<std::size_t>& signals) const {
    for (const std::size_t s : signals) {
      const data::SignalInfo& a = trial.signals[signals.front()];
      const data::SignalInfo& b = trial.signals[s];
      if (a.rate_hz != b.rate_hz || a.count != b.count) {
        throw data::InputError(
            "rate-mismatch",
            fmt::format(
                "EMG channels `{}` ({} Hz, {} samples) and `{}` ({} Hz, {} samples) of trial `{}` differ",
                a.name, a.rate_hz, a.count, b.name, b.rate_hz, b.count, trial.name),
            "condition them in two stages, each with its own `channels`");
      }
    }
    return emg::design_conditioning(conditioning, trial.signals[signals.front()].rate_hz);
  }
};

double rest_of(const std::map<std::string, double>& rest, const std::string& channel) {
  const auto found = rest.find(channel);
  return found == rest.end() ? 0.0 : found->second;
}

/// The references of all channels, found over the trials one after the other.
std::map<std::string, emg::NormalisationReference> find_references(
    const StageContext& context, const StageData& input, const Plan& plan,
    const std::vector<std::string>& trials, const emg::NormalisationOptions& options,
    const std::map<std::string, double>& rest) {
  std::map<std::string, emg::ReferenceSearch> searches;
  for (const std::string& name : trials) {
    const std::size_t t = trial_index(input, name);
    const data::TrialInfo& trial = input.signals->info().trials[t];
    const std::vector<std::size_t> channels = plan.channels(trial);
    const emg::ConditioningChain chain = plan.chain(trial, channels);
    condition_by_groups(
        chain, *input.signals, t, channels, sample_budget_bytes,
        [&](const data::SignalInfo& raw, std::span<double> envelope, const emg::OutputLayout& layout) {
          if (!rest.empty()) emg::remove_rest(envelope, rest_of(rest, raw.name));
          const auto [search, added] = searches.try_emplace(raw.name, raw.name, options);
          search->second.take(
              {name, envelope, chain.output_rate_hz, raw.start_time_s + layout.start_shift_s});
        });
    if (context.progress) context.progress(0.0, "maxima: " + name);
  }
  std::map<std::string, emg::NormalisationReference> references;
  for (const auto& [channel, search] : searches) references.emplace(channel, search.finish());
  return references;
}

/// Each channel's mean envelope over the trials at rest.
std::map<std::string, double> find_rest(const StageContext& context, const StageData& input,
                                        const Plan& plan) {
  std::vector<std::string> all, quiet;
  for (const data::TrialInfo& trial : input.signals->info().trials) {
    all.push_back(trial.name);
    if (trial.kind == data::TrialKind::rest || trial.kind == data::TrialKind::passive)
      quiet.push_back(trial.name);
  }
  const std::vector<std::string>& patterns = context.options->texts("rest_trials");
  if (!patterns.empty()) quiet = data::match_names(patterns, all, "trial");
  if (quiet.empty()) {
    throw data::InputError(
        "rest-absent",
        fmt::format("stage `{}` takes off the envelope at rest, and no trial is of kind `rest` or `passive`",
                    context.name),
        "record one, name trials in `rest_trials`, or set `subtract_rest = false`");
  }
  std::map<std::string, std::pair<double, std::size_t>> sums;
  for (const std::string& name : quiet) {
    const std::size_t t = trial_index(input, name);
    const data::TrialInfo& trial = input.signals->info().trials[t];
    const std::vector<std::size_t> channels = plan.channels(trial);
    condition_by_groups(
        plan.chain(trial, channels), *input.signals, t, channels, sample_budget_bytes,
        [&](const data::SignalInfo& raw, std::span<double> envelope, const emg::OutputLayout&) {
          auto& [sum, count] = sums[raw.name];
          for (const double e : envelope) sum += e;
          count += envelope.size();
        });
  }
  std::map<std::string, double> rest;
  for (const auto& [channel, sum] : sums)
    rest[channel] = std::max(0.0, sum.first / static_cast<double>(sum.second));
  return rest;
}

std::vector<std::string> reference_trials(const StageContext& context, const StageData& input,
                                          emg::Normalisation method) {
  const std::vector<std::string>& patterns = context.options->texts("reference_trials");
  std::vector<std::string> all, mvc;
  for (const data::TrialInfo& trial : input.signals->info().trials) {
    all.push_back(trial.name);
    if (trial.kind == data::TrialKind::mvc) mvc.push_back(trial.name);
  }
  if (!patterns.empty()) return data::match_names(patterns, all, "trial");
  if (method == emg::Normalisation::trials_maximum) return context.trials;
  if (mvc.empty()) {
    throw data::InputError(
        "mvc-absent",
        fmt::format("stage `{}` normalises by maximum voluntary contractions, and no trial is of kind `mvc`",
                    context.name),
        "record one, name trials in `reference_trials`, or choose `normalise = \"trials_maximum\"` or "
        "`\"none\"` (the gain is then fitted)");
  }
  return mvc;
}

/// The conditioning steps of one channel around the largest envelope of a trial.
data::Table step_table(const emg::ConditioningChain& chain, const data::SessionSource& source, std::size_t t,
                       std::size_t signal, double window_s) {
  const data::TrialInfo& trial = source.info().trials[t];
  const data::SignalInfo& info = trial.signals[signal];
  std::vector<double> samples = source.read(t, signal);
  const std::vector<std::string> names{info.name};
  const std::vector<std::span<double>> span{samples};
  const emg::OutputLayout layout = emg::condition(chain, span, names, trial.name);
  const auto peak =
      std::max_element(samples.begin(), samples.begin() + static_cast<std::ptrdiff_t>(layout.count)) -
      samples.begin();
  const double stride = chain.rate_hz / chain.output_rate_hz;
  const auto centre =
      static_cast<std::size_t>(static_cast<double>(layout.first) + static_cast<double>(peak) * stride);
  emg::ConditioningSteps steps;
  steps.count = std::min(info.count, static_cast<std::size_t>(window_s * info.rate_hz));
  steps.first = std::min(centre - std::min(centre, steps.count / 2), info.count - steps.count);
  source.read(t, signal, 0, samples);  // again: it was worked on in place
  emg::condition(chain, span, names, trial.name, &steps);
  TableBuilder table(fmt::format("conditioning of `{}` in trial `{}`", info.name, trial.name));
  table.number("time_s", "s")
      .number("raw_V", info.unit)
      .number("offset_removed_V", info.unit)
      .number("filtered_V", info.unit)
      .number("rectified_V", info.unit)
      .number("envelope_V", info.unit);
  for (std::size_t i = 0; i < steps.count; ++i) {
    table.row({info.time_s(steps.first + i), steps.raw[i], steps.offset_removed[i], steps.filtered[i],
               steps.rectified[i], steps.envelope[i]});
  }
  return table.take();
}

data::Table filter_table(const emg::ConditioningChain& chain) {
  TableBuilder table(fmt::format("filters at {} Hz", chain.rate_hz));
  table.text("filter")
      .number("effective_order", "1")
      .text("edges_at_minus_3_dB_Hz")
      .number("group_delay_s", "s")
      .number("transient_s", "s");
  const auto add = [&table](const std::string& name, const emg::FilterReport& r) {
    std::vector<std::string> edges;
    for (const double e : r.edges_hz) edges.push_back(fmt::format("{:.4g}", e));
    table.row({name, static_cast<double>(r.effective_order), fmt::format("{}", fmt::join(edges, ", ")),
               r.group_delay_s, r.transient_s});
  };
  for (const emg::FilterReport& r : chain.filters) add(r.description, r);
  if (chain.band.size() > 1) add("all filters before rectification together", chain.band_report);
  return table.take();
}

void run(const StageContext& context, StageOutput& out) {
  const Options& options = *context.options;
  const StageData& input = context.input("signals");
  Plan plan{envelope_options(options), options.texts("channels"), options.texts("exclude")};
  std::vector<std::string> recorded;
  for (const std::string& name : context.trials) {
    const data::TrialInfo& trial = trial_info(input, name);
    for (const std::string& channel : names_of(trial, signals_of(trial, data::Quantity::emg)))
      recorded.push_back(channel);
  }
  select(plan.excluded, recorded, "EMG channel");  // a name that is not there is a mistake
  for (const std::string& name : excluded_channels(context.maybe_input("quality")))
    plan.excluded.push_back(name);

  emg::NormalisationOptions normalisation;
  normalisation.method = emg::parse_normalisation(options.text("normalise"));
  normalisation.window_s = options.number("reference_window_s");
  normalisation.lowpass_hz = options.number("lowpass_hz");
  std::map<std::string, double> rest;
  if (options.boolean("subtract_rest")) rest = find_rest(context, input, plan);
  std::map<std::string, emg::NormalisationReference> references;
  if (normalisation.method != emg::Normalisation::none) {
    references = find_references(context, input, plan, reference_trials(context, input, normalisation.method),
                                 normalisation, rest);
    if (options.boolean("correct_reference_bias")) {
      for (auto& [channel, r] : references) r.value /= 1.0 + r.expected_bias;
    }
    TableBuilder table("normalisation");
    table.text("channel")
        .text("method")
        .number("reference_V", "V")
        .text("trial")
        .number("time_s", "s")
        .number("window_s", "s")
        .number("expected_bias", "1")
        .text("bias_taken_off")
        .number("rest_V", "V");
    for (const auto& [channel, r] : references) {
      table.row({channel, emg::to_string(r.method), r.value, r.trial, r.time_s, r.window_s, r.expected_bias,
                 std::string(options.boolean("correct_reference_bias") ? "yes" : "no"),
                 rest_of(rest, channel)});
      out.diagnostics.insert(out.diagnostics.end(), r.diagnostics.begin(), r.diagnostics.end());
    }
    out.tables["normalisation"] = table.take();
  }

  begin_output(context, input, out);
  struct TrialExcess {
    std::string channel;
    emg::Excess excess;
  };
  std::vector<std::vector<TrialExcess>> excesses(context.trials.size());
  std::vector<double> lost_start(context.trials.size()), lost_end(context.trials.size());
  std::atomic<std::size_t> done{0};
  const std::size_t threads = threads_within_budget(context.threads, input.signals->info(), context.trials);
  data::parallel_for(context.trials.size(), threads, [&](std::size_t i) {
    const std::size_t t = trial_index(input, context.trials[i]);
    const data::TrialInfo& trial = input.signals->info().trials[t];
    const std::vector<std::size_t> channels = plan.channels(trial);
    const emg::ConditioningChain chain = plan.chain(trial, channels);
    condition_by_groups(
        chain, *input.signals, t, channels, sample_budget_bytes / std::min(threads, context.trials.size()),
        [&](const data::SignalInfo& raw, std::span<double> envelope, const emg::OutputLayout& layout) {
          data::SignalInfo info = raw;
          info.quantity = data::Quantity::excitation;
          info.rate_hz = chain.output_rate_hz;
          info.start_time_s = raw.start_time_s + layout.start_shift_s;
          info.count = layout.count;
          for (const auto& [key, value] : emg::attributes(chain)) info.attributes[key] = value;
          if (!rest.empty()) {
            const std::size_t floored = emg::remove_rest(envelope, rest_of(rest, raw.name));
            info.attributes["rest_taken_off"] =
                fmt::format("{:.6g} V in the mean square; {} of {} samples at or below it are 0",
                            rest_of(rest, raw.name), floored, envelope.size());
          }
          if (normalisation.method != emg::Normalisation::none) {
            const auto reference = references.find(raw.name);
            if (reference == references.end()) {
              throw data::InputError(
                  "mvc-absent",
                  fmt::format("channel `{}` of trial `{}` is in none of the reference trials", raw.name,
                              trial.name),
                  "name trials that record it in `reference_trials`");
            }
            info.unit = "1";
            info.attributes["normalisation"] =
                fmt::format("{} {:.6g} V, trial {}", emg::to_string(normalisation.method),
                            reference->second.value, reference->second.trial);
            excesses[i].push_back({raw.name, emg::normalise(envelope, reference->second.value, info.rate_hz,
                                                            info.start_time_s)});
          } else {
            info.attributes["normalisation"] = "none: the gain is fitted";
          }
          lost_start[i] = layout.start_shift_s;
          lost_end[i] = raw.end_time_s() - info.end_time_s();
          out.signals->begin_signal(trial.name, info);
          out.signals->write_samples(trial.name, info.name, 0, envelope);
        });
    if (context.progress)
      context.progress(static_cast<double>(++done) / static_cast<double>(context.trials.size()), trial.name);
  });

  TableBuilder excess("excitation above 1");
  excess.text("trial")
      .text("channel")
      .number("samples", "1")
      .number("maximum", "1")
      .number("time_of_maximum_s", "s")
      .text("intervals_s");
  for (std::size_t i = 0; i < context.trials.size(); ++i) {
    for (const TrialExcess& e : excesses[i]) {
      if (e.excess.samples == 0) continue;
      std::vector<std::string> intervals;
      for (const auto& k : e.excess.intervals)
        intervals.push_back(fmt::format("{:.3f}-{:.3f}", k.from_s, k.to_s));
      excess.row({context.trials[i], e.channel, static_cast<double>(e.excess.samples), e.excess.maximum,
                  e.excess.maximum_time_s, fmt::format("{}", fmt::join(intervals, " "))});
      if (trial_info(input, context.trials[i]).kind != data::TrialKind::mvc) {
        out.warn(
            "excitation-above-one",
            fmt::format(
                "excitation of `{}` in trial `{}` exceeds 1 in {} samples (largest {:.3f} at {:.2f} s)",
                e.channel, context.trials[i], e.excess.samples, e.excess.maximum, e.excess.maximum_time_s),
            "the reference contraction was not maximal; nothing was clamped");
      }
    }
  }
  data::Table excess_table = excess.take();
  if (excess_table.rows() > 0) out.tables["above_one"] = std::move(excess_table);

  // What the report shows, from the first trial in which something is done but no reference contraction.
  const auto shown = std::find_if(context.trials.begin(), context.trials.end(), [&](const std::string& n) {
    const data::TrialKind kind = trial_info(input, n).kind;
    return kind == data::TrialKind::calibration || kind == data::TrialKind::test;
  });
  const std::size_t t = trial_index(input, shown == context.trials.end() ? context.trials.front() : *shown);
  const data::TrialInfo& trial = input.signals->info().trials[t];
  const std::vector<std::size_t> channels = plan.channels(trial);
  const emg::ConditioningChain chain = plan.chain(trial, channels);
  out.tables["filters"] = filter_table(chain);
  for (const std::size_t s : channels)
    out.tables["steps_" + trial.signals[s].name] =
        step_table(chain, *input.signals, t, s, options.number("steps_window_s"));
  out.attributes["trimmed"] = fmt::format("{:.3f} s at the start and {:.3f} s at the end of each trial",
                                          *std::max_element(lost_start.begin(), lost_start.end()),
                                          *std::max_element(lost_end.begin(), lost_end.end()));
}

}  // namespace

void add_emg_envelope(Catalogue& catalogue) {
  const emg::ConditioningOptions d;
  StageSpec spec;
  spec.name = "emg.envelope";
  spec.summary = "raw EMG to linear envelopes: filter, rectify, low-pass, normalise";
  spec.doc =
      "Takes off the offset, filters (high- or band-pass, optional notch with harmonics), rectifies, "
      "low-passes to the linear envelope, brings it to "
      "the output rate and normalises it. Normalisation is by the largest windowed mean over all trials of "
      "kind `mvc` (or those in `reference_trials`), "
      "by that of the trials themselves with a warning, or by nothing: then the envelope stays in V and a "
      "gain is fitted by the calibration. Samples "
      "that the filters' transients reach are left out at both ends. An excitation above 1 is counted and "
      "time-stamped, never clamped.\n"
      "Default filters: Lloyd & Besier 2003, doi:10.1016/S0021-9290(03)00010-1, and the CEINMS manual.";
  spec.inputs = {
      {"signals", PortType::signals, "raw EMG", false, false, true},
      {"quality", PortType::tables, "output of emg.quality: its excluded channels are left out", true}};
  spec.options = {
      texts_option("channels", {}, "patterns of EMG signal names; empty: every signal of quantity emg"),
      texts_option("exclude", {}, "channels to leave out, by name")};
  for (OptionSpec& o : conditioning_option_specs()) spec.options.push_back(std::move(o));
  const std::vector<OptionSpec> more = {
      number_option("lowpass_hz", "Hz", d.lowpass_hz, above(0), "edge of the envelope's low-pass"),
      integer_option("lowpass_order", d.lowpass_order, between(1, 10), "order of one pass of that low-pass"),
      number_option("output_rate_hz", "Hz", 0.0, at_least(0), "rate of the envelopes; 0: the input's rate"),
      flag_option("trim_edges", true, "leave out the samples that the filters' transients reach"),
      choice_option("normalise", "mvc", {"mvc", "trials_maximum", "none"}, "what an excitation of 1 means"),
      texts_option("reference_trials", {},
                   "patterns of the trials whose maximum counts; empty: kind `mvc`, or the stage's trials "
                   "for trials_maximum"),
      number_option(
          "reference_window_s", "s", 0.5, at_least(0),
          "length of the mean whose maximum counts; 0: the largest single sample (biased by about +25 %)"),
      flag_option("correct_reference_bias", false,
                  "divide the reference by what a maximum is expected to exceed the plateau's mean by "
                  "(reported either way)"),
      flag_option("subtract_rest", false,
                  "take the envelope at rest off in the mean square: at 20 dB an excitation of 0 otherwise "
                  "reads as 0.1"),
      texts_option("rest_trials", {}, "patterns of the trials at rest; empty: kinds `rest` and `passive`"),
      number_option("steps_window_s", "s", 1.0, above(0),
                    "length of the piece of each channel that the report shows step by step"),
  };
  for (const OptionSpec& o : more) spec.options.push_back(o);
  spec.run = run;
  spec.report = fill_envelope_report;
  spec.methods = envelope_methods;
  catalogue.add(std::move(spec));
}

}  // namespace brachium::pipelines
