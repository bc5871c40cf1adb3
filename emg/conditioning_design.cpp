#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "data/model/error.hpp"
#include "emg/conditioning.hpp"

namespace brachium::emg {
namespace {

void check(const ConditioningOptions& o, double rate_hz) {
  std::vector<data::Diagnostic> list;
  const auto add = [&](const char* code, std::string message) {
    list.push_back({data::Severity::error, code, std::move(message), std::nullopt, {}});
  };
  if (!(rate_hz > 0.0) || !std::isfinite(rate_hz)) {
    throw data::InputError("out-of-range", fmt::format("the sampling rate `{}` Hz must be > 0", rate_hz));
  }
  const double nyquist = 0.5 * rate_hz;
  const auto edge = [&](const char* name, double value) {
    if (!(value >= 0.0) || !std::isfinite(value)) {
      add("out-of-range", fmt::format("`{}` = {} Hz must be >= 0", name, value));
    } else if (value >= nyquist) {
      add("cutoff-above-nyquist",
          fmt::format("`{}` = {} Hz is not below {} Hz, half the sampling rate of {} Hz", name, value,
                      nyquist, rate_hz));
    }
  };
  edge("highpass_hz", o.highpass_hz);
  edge("band_high_hz", o.band_high_hz);
  edge("notch_hz", o.notch_hz);
  edge("lowpass_hz", o.lowpass_hz);
  if (o.highpass_hz > 0.0 && o.band_high_hz > 0.0 && !(o.highpass_hz < o.band_high_hz)) {
    add("out-of-range", fmt::format("`highpass_hz` = {} Hz must lie below `band_high_hz` = {} Hz",
                                    o.highpass_hz, o.band_high_hz));
  }
  for (const auto& [name, order] :
       {std::pair{"band_order", o.band_order}, std::pair{"lowpass_order", o.lowpass_order}}) {
    if (order < 1 || order > 10)
      add("out-of-range", fmt::format("`{}` = {} must lie between 1 and 10", name, order));
  }
  if (o.notch_hz > 0.0) {
    if (o.notch_harmonics < 1)
      add("out-of-range", fmt::format("`notch_harmonics` = {} must be >= 1", o.notch_harmonics));
    if (!(o.notch_width_hz > 0.0 && o.notch_width_hz < o.notch_hz)) {
      add("out-of-range",
          fmt::format("`notch_width_hz` = {} Hz must lie between 0 and `notch_hz`", o.notch_width_hz));
    }
  }
  if (!(o.offset_edge_s >= 0.0))
    add("out-of-range", fmt::format("`offset_edge_s` = {} s must be >= 0", o.offset_edge_s));
  if (!(o.output_rate_hz >= 0.0) || o.output_rate_hz > rate_hz * (1.0 + 1e-12)) {
    add("out-of-range",
        fmt::format("`output_rate_hz` = {} Hz must lie between 0 and the sampling rate of {} Hz",
                    o.output_rate_hz, rate_hz));
  }
  if (!list.empty()) throw data::InputError(std::move(list));
}

FilterSpec with_phase(FilterSpec spec, const ConditioningOptions& o) {
  spec.phase = o.phase;
  spec.cutoff = o.cutoff;
  return spec;
}

// The lowest output rate that the filters allow, for the help text.
double lowest_rate(const ConditioningChain& chain) {
  double low = 1e-3, high = chain.rate_hz;
  for (int i = 0; i < 60; ++i) {
    const double middle = std::sqrt(low * high);
    (gain(chain.envelope, 0.5 * middle) <= max_alias_gain ? high : low) = middle;
  }
  return high;
}

}  // namespace

ConditioningChain design_conditioning(const ConditioningOptions& options, double rate_hz) {
  check(options, rate_hz);
  ConditioningChain chain;
  chain.options = options;
  chain.rate_hz = rate_hz;
  chain.output_rate_hz = options.output_rate_hz > 0.0 ? options.output_rate_hz : rate_hz;

  const auto& o = options;
  if (o.highpass_hz > 0.0 && o.band_high_hz > 0.0) {
    chain.band.push_back(
        design(with_phase(FilterSpec::band_pass(o.highpass_hz, o.band_high_hz, o.band_order), o), rate_hz));
  } else if (o.highpass_hz > 0.0) {
    chain.band.push_back(design(with_phase(FilterSpec::high_pass(o.highpass_hz, o.band_order), o), rate_hz));
  } else if (o.band_high_hz > 0.0) {
    chain.band.push_back(design(with_phase(FilterSpec::low_pass(o.band_high_hz, o.band_order), o), rate_hz));
  }
  if (o.notch_hz > 0.0) {
    chain.band.push_back(
        design(with_phase(FilterSpec::notch(o.notch_hz, o.notch_harmonics, o.notch_width_hz), o), rate_hz));
  }
  if (o.lowpass_hz > 0.0) {
    chain.envelope.push_back(
        design(with_phase(FilterSpec::low_pass(o.lowpass_hz, o.lowpass_order), o), rate_hz));
  }

  for (const auto* part : {&chain.band, &chain.envelope}) {
    for (const DesignedFilter& filter : *part) chain.filters.push_back(describe(filter));
  }
  chain.band_report = describe(chain.band);
  chain.envelope_report = describe(chain.envelope);
  chain.group_delay_s = chain.band_report.group_delay_s + chain.envelope_report.group_delay_s;
  const double transient = chain.band_report.transient_s + chain.envelope_report.transient_s;
  chain.edge_start_samples = static_cast<std::size_t>(std::ceil(transient * rate_hz));
  chain.edge_end_samples = o.phase == Phase::zero_lag ? chain.edge_start_samples : 0;

  if (chain.output_rate_hz < rate_hz) {
    chain.gain_at_output_nyquist = gain(chain.envelope, 0.5 * chain.output_rate_hz);
    if (chain.envelope.empty()) {
      throw data::InputError(
          "output-rate-too-low",
          fmt::format("`output_rate_hz` = {} Hz needs an envelope filter: `lowpass_hz` is 0",
                      chain.output_rate_hz));
    }
    if (!(chain.gain_at_output_nyquist <= max_alias_gain)) {
      throw data::InputError(
          "output-rate-too-low",
          fmt::format("`output_rate_hz` = {} Hz would fold frequencies above {} Hz back: the envelope filter "
                      "still has "
                      "a gain of {:.3g} there, the limit is {}",
                      chain.output_rate_hz, 0.5 * chain.output_rate_hz, chain.gain_at_output_nyquist,
                      max_alias_gain),
          fmt::format("use at least {:.4g} Hz, or a lower `lowpass_hz`", lowest_rate(chain)));
    }
  }
  return chain;
}

OutputLayout output_layout(const ConditioningChain& chain, std::size_t count, const std::string& trial) {
  std::size_t needed = 2;
  for (const auto* part : {&chain.band, &chain.envelope}) {
    for (const DesignedFilter& filter : *part) {
      if (filter.spec.phase == Phase::zero_lag) needed = std::max(needed, padding(filter.sections) + 1);
    }
  }
  const std::size_t edges = chain.options.trim_edges ? chain.edge_start_samples + chain.edge_end_samples : 0;
  needed = std::max(needed, edges + 2);
  if (count < needed) {
    throw data::InputError(
        "trial-too-short",
        fmt::format("trial `{}` has {} samples ({:.4g} s); its filters need at least {} ({:.4g} s)", trial,
                    count, static_cast<double>(count) / chain.rate_hz, needed,
                    static_cast<double>(needed) / chain.rate_hz),
        chain.options.trim_edges
            ? "a higher edge has a shorter transient; `trim_edges = false` keeps the ends"
            : "");
  }
  OutputLayout layout;
  layout.first = chain.options.trim_edges ? chain.edge_start_samples : 0;
  layout.kept = count - edges;
  const double ratio = chain.rate_hz / chain.output_rate_hz;
  layout.count =
      static_cast<std::size_t>(std::floor(static_cast<double>(layout.kept - 1) / ratio * (1.0 + 1e-12))) + 1;
  layout.start_shift_s = static_cast<double>(layout.first) / chain.rate_hz;
  return layout;
}

std::map<std::string, std::string> attributes(const ConditioningChain& chain) {
  const auto& o = chain.options;
  std::map<std::string, std::string> result;
  const auto edges = [](const FilterReport& report) {
    std::string text;
    for (const double f : report.edges_hz) text += fmt::format("{}{:.9g}", text.empty() ? "" : " ", f);
    return text;
  };
  result["emg.offset_removed"] =
      o.remove_offset ? fmt::format("mean of the trial without its first and last {:g} s", o.offset_edge_s)
                      : "no";
  result["emg.filters_before_rectification"] = chain.band_report.description;
  result["emg.edges_before_rectification_hz"] = edges(chain.band_report);
  result["emg.rectified"] = o.rectify ? "full wave" : "no";
  result["emg.envelope_filter"] = chain.envelope_report.description;
  result["emg.envelope_edges_hz"] = edges(chain.envelope_report);
  result["emg.effective_order_before_rectification"] = fmt::format("{}", chain.band_report.effective_order);
  result["emg.effective_order_envelope"] = fmt::format("{}", chain.envelope_report.effective_order);
  result["emg.phase"] = to_string(o.phase);
  result["emg.cutoff"] = to_string(o.cutoff);
  result["emg.group_delay_s"] = fmt::format("{:.9g}", chain.group_delay_s);
  result["emg.edges_trimmed"] = o.trim_edges ? "yes" : "no";
  result["emg.edge_start_s"] =
      fmt::format("{:.9g}", static_cast<double>(chain.edge_start_samples) / chain.rate_hz);
  result["emg.edge_end_s"] =
      fmt::format("{:.9g}", static_cast<double>(chain.edge_end_samples) / chain.rate_hz);
  result["emg.input_rate_hz"] = fmt::format("{:.9g}", chain.rate_hz);
  result["emg.gain_at_output_nyquist"] = fmt::format("{:.3g}", chain.gain_at_output_nyquist);
  return result;
}

}  // namespace brachium::emg
