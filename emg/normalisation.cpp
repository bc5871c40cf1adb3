#include "emg/normalisation.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "emg/names.hpp"

namespace brachium::emg {
namespace {

constexpr std::array<std::pair<Normalisation, const char*>, 3> methods{
    {{Normalisation::mvc, "mvc"},
     {Normalisation::trials_maximum, "trials_maximum"},
     {Normalisation::none, "none"}}};

void check(const NormalisationOptions& o) {
  std::vector<data::Diagnostic> list;
  const auto need = [&](bool good, const char* name, double value, const char* must) {
    if (!good || !std::isfinite(value)) {
      list.push_back({data::Severity::error,
                      "out-of-range",
                      fmt::format("`{}` = {} must be {}", name, value, must),
                      std::nullopt,
                      {}});
    }
  };
  need(o.window_s >= 0.0, "window_s", o.window_s, ">= 0");
  need(o.lowpass_hz > 0.0, "lowpass_hz", o.lowpass_hz, "> 0");
  need(o.plateau_s > 0.0, "plateau_s", o.plateau_s, "> 0");
  need(o.bandwidth_hz > 0.0, "bandwidth_hz", o.bandwidth_hz, "> 0");
  if (!list.empty()) throw data::InputError(std::move(list));
}

}  // namespace

std::string to_string(Normalisation normalisation) {
  return name_of(methods, normalisation);
}
Normalisation parse_normalisation(const std::string& name) {
  return parse_name(methods, name, "unknown-normalisation", "a method of normalisation");
}

WindowMaximum moving_window_maximum(std::span<const double> samples, double rate_hz, double window_s) {
  WindowMaximum best;
  best.width = std::max<std::size_t>(1, static_cast<std::size_t>(std::lround(window_s * rate_hz)));
  if (samples.size() < best.width) {
    throw data::InputError("trial-too-short",
                           fmt::format("{} samples are fewer than the `window_s` of {} s at {} Hz needs ({})",
                                       samples.size(), window_s, rate_hz, best.width));
  }
  double sum = 0.0;
  bool first = true;
  for (std::size_t k = 0; k + best.width <= samples.size(); ++k) {
    if (k % best.width == 0) {  // anew once per window: the rounding error does not grow with the length
      sum = 0.0;
      for (const double x : samples.subspan(k, best.width)) sum += x;
    } else {
      sum += samples[k + best.width - 1] - samples[k - 1];
    }
    const double mean = sum / static_cast<double>(best.width);
    if (first || mean > best.value) {
      best.value = mean;
      best.first = k;
      first = false;
    }
  }
  return best;
}

ReferenceSearch::ReferenceSearch(std::string channel, NormalisationOptions options) : options_(options) {
  check(options_);
  best_.channel = std::move(channel);
  best_.method = options_.method;
  best_.window_s = options_.window_s;
}

void ReferenceSearch::take(const EnvelopeView& envelope) {
  if (options_.method == Normalisation::none) return;
  for (const double x : envelope.samples) {
    if (std::isfinite(x)) continue;
    throw data::InputError("not-finite",
                           fmt::format("the envelope of channel `{}` in trial `{}` has samples that are "
                                       "not finite",
                                       best_.channel, envelope.trial));
  }
  WindowMaximum maximum;
  try {
    maximum = moving_window_maximum(envelope.samples, envelope.rate_hz, options_.window_s);
  } catch (const data::InputError&) {
    throw data::InputError(
        "trial-too-short",
        fmt::format("trial `{}` has {:.4g} s of channel `{}`, the normalisation's window is {} s",
                    envelope.trial, static_cast<double>(envelope.samples.size()) / envelope.rate_hz,
                    best_.channel, options_.window_s),
        "use a shorter `window_s`, or leave the trial out");
  }
  if (best_.trials == 0 || maximum.value > best_.value) {
    best_.value = maximum.value;
    best_.trial = envelope.trial;
    best_.time_s = envelope.start_time_s +
                   (static_cast<double>(maximum.first) + 0.5 * static_cast<double>(maximum.width - 1)) /
                       envelope.rate_hz;
  }
  ++best_.trials;
}

NormalisationReference ReferenceSearch::finish() const {
  NormalisationReference result = best_;
  if (options_.method == Normalisation::none) {
    result.value = 1.0;
    result.window_s = 0.0;
    result.diagnostics.push_back(
        {data::Severity::note,
         "not-normalised",
         fmt::format(
             "channel `{}` is not normalised: its gain is fitted in the calibration, where gain and muscle "
             "strength are one parameter",
             result.channel),
         std::nullopt,
         {}});
    return result;
  }
  if (result.trials == 0) {
    throw data::InputError("mvc-absent",
                           options_.method == Normalisation::mvc
                               ? fmt::format("channel `{}` has no MVC trial to normalise by", result.channel)
                               : fmt::format("channel `{}` has no trial to normalise by", result.channel),
                           "name trials of kind mvc, or choose normalisation `trials_maximum` or `none`");
  }
  if (!(result.value > 0.0)) {
    throw data::InputError(
        "constant-channel",
        fmt::format("the largest envelope of channel `{}` is {}: there is nothing to normalise by",
                    result.channel, result.value),
        "leave the channel out by name");
  }
  result.expected_bias = emg::expected_bias(options_.window_s, options_.lowpass_hz, options_.plateau_s,
                                            result.trials, options_.bandwidth_hz);
  if (options_.method == Normalisation::trials_maximum) {
    result.diagnostics.push_back(
        {data::Severity::warning, "normalised-by-trials",
         fmt::format(
             "channel `{}` is normalised by its maximum over {} trials, not by an MVC: excitations cannot be "
             "compared between channels, days or people",
             result.channel, result.trials),
         std::nullopt, "record MVC trials, or fit the gain in the calibration"});
  }
  return result;
}

NormalisationReference find_reference(const std::string& channel, std::span<const EnvelopeView> envelopes,
                                      const NormalisationOptions& options) {
  ReferenceSearch search(channel, options);
  for (const EnvelopeView& envelope : envelopes) search.take(envelope);
  return search.finish();
}

Excess normalise(std::span<double> envelope, double reference, double rate_hz, double start_time_s) {
  if (!(reference > 0.0) || !std::isfinite(reference)) {
    throw data::InputError("out-of-range", fmt::format("the reference `{}` must be > 0", reference));
  }
  Excess excess;
  bool above = false;
  for (std::size_t k = 0; k < envelope.size(); ++k) {
    envelope[k] /= reference;
    const double e = envelope[k];
    const double t = start_time_s + static_cast<double>(k) / rate_hz;
    if (k == 0 || e > excess.maximum) {
      excess.maximum = e;
      excess.maximum_time_s = t;
    }
    if (e > 1.0) {
      ++excess.samples;
      if (!above) excess.intervals.push_back({t, t, e});
      excess.intervals.back().to_s = t;
      excess.intervals.back().maximum = std::max(excess.intervals.back().maximum, e);
    }
    above = e > 1.0;
  }
  return excess;
}

}  // namespace brachium::emg
