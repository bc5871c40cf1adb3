#include "emg/synthetic_emg.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "data/model/error.hpp"
#include "emg/butterworth.hpp"
#include "emg/random.hpp"

namespace brachium::emg {
namespace {

using std::numbers::pi;

enum Sequence : std::uint64_t { muscle, sensor, hum, heart, motion, dropout, sequences };

Random sequence(const SyntheticEmgOptions& o, Sequence which) {
  return Random(o.seed, o.stream * sequences + which);
}

void check(std::span<const double> excitation, double excitation_rate_hz, const SyntheticEmgOptions& o) {
  std::vector<data::Diagnostic> list;
  const auto need = [&](bool good, const std::string& name, double value, const char* must) {
    if (!good || !std::isfinite(value)) {
      list.push_back({data::Severity::error,
                      "out-of-range",
                      fmt::format("`{}` = {} must {}", name, value, must),
                      std::nullopt,
                      {}});
    }
  };
  need(excitation_rate_hz > 0.0, "excitation_rate_hz", excitation_rate_hz, "be > 0");
  need(o.rate_hz > 0.0, "rate_hz", o.rate_hz, "be > 0");
  need(o.amplitude_V > 0.0, "amplitude_V", o.amplitude_V, "be > 0");
  need(o.spectrum_low_hz > 0.0, "spectrum_low_hz", o.spectrum_low_hz, "be > 0");
  need(o.spectrum_high_hz > 0.0 && o.spectrum_high_hz < 0.5 * o.rate_hz, "spectrum_high_hz",
       o.spectrum_high_hz, "lie between 0 and half the rate");
  need(o.band_low_hz > 0.0 && o.band_low_hz < o.band_high_hz, "band_low_hz", o.band_low_hz,
       "lie between 0 and `band_high_hz`");
  need(o.band_high_hz < 0.5 * o.rate_hz, "band_high_hz", o.band_high_hz, "lie below half the rate");
  if (o.snr_db) need(true, "snr_db", *o.snr_db, "be finite");
  need(o.hum_V >= 0.0, "hum_V", o.hum_V, "be >= 0");
  need(o.hum_hz > 0.0 && o.hum_hz < 0.5 * o.rate_hz, "hum_hz", o.hum_hz, "lie between 0 and half the rate");
  need(o.hum_harmonics >= 1, "hum_harmonics", o.hum_harmonics, "be at least 1");
  need(o.ecg_V >= 0.0, "ecg_V", o.ecg_V, "be >= 0");
  need(o.heart_rate_hz > 0.0, "heart_rate_hz", o.heart_rate_hz, "be > 0");
  need(o.motion_V >= 0.0, "motion_V", o.motion_V, "be >= 0");
  need(true, "offset_V", o.offset_V, "be finite");
  need(true, "drift_V_per_s", o.drift_V_per_s, "be finite");
  need(o.clip_V >= 0.0, "clip_V", o.clip_V, "be >= 0");
  need(o.dropouts_per_minute >= 0.0, "dropouts_per_minute", o.dropouts_per_minute, "be >= 0");
  need(o.dropout_s > 0.0, "dropout_s", o.dropout_s, "be > 0");
  for (std::size_t k = 0; k < excitation.size(); ++k) {
    if (!(excitation[k] >= 0.0) || !std::isfinite(excitation[k])) {
      list.push_back(
          {data::Severity::error,
           "not-finite",
           fmt::format("the excitation is `{}` at sample {}; it must be finite and >= 0", excitation[k], k),
           std::nullopt,
           {}});
      break;
    }
  }
  if (!list.empty()) throw data::InputError(std::move(list));
}

// White Gaussian noise through a cascade, scaled to unit variance.
class ColouredNoise {
 public:
  ColouredNoise(std::vector<Biquad> sections, double rate_hz, Random random)
      : sections_(std::move(sections)), state_(sections_.size()), random_(random) {
    // Variance of the output: the sum of the squared impulse response.
    double power = 0.0, input = 1.0;
    for (std::size_t k = 0; k < static_cast<std::size_t>(4.0 * rate_hz); ++k) {
      const double h = filter(input);
      power += h * h;
      input = 0.0;
    }
    scale_ = 1.0 / std::sqrt(power);
    std::fill(state_.begin(), state_.end(), State{});
    for (std::size_t k = 0; k < static_cast<std::size_t>(rate_hz); ++k) (*this)();  // settled
  }

  double operator()() { return scale_ * filter(random_.normal()); }

 private:
  struct State {
    double z1 = 0.0, z2 = 0.0;
  };

  double filter(double x) {
    for (std::size_t s = 0; s < sections_.size(); ++s) {
      const Biquad& b = sections_[s];
      State& z = state_[s];
      const double y = b.b0 * x + z.z1;
      z.z1 = b.b1 * x - b.a1 * y + z.z2;
      z.z2 = b.b2 * x - b.a2 * y;
      x = y;
    }
    return x;
  }

  std::vector<Biquad> sections_;
  std::vector<State> state_;
  Random random_;
  double scale_ = 1.0;
};

void append(std::vector<Biquad>& sections, FilterSpec spec, double rate_hz) {
  spec.phase = Phase::causal;
  for (const Biquad& s : design(spec, rate_hz).sections) sections.push_back(s);
}

// |H|^2 = f_h^4 f^2/((f^2 + f_l^2)(f^2 + f_h^2)^2) from H(s) = s ω_h^2/((s + ω_l)(s + ω_h)^2) by the bilinear transform:
// (s + a)(s + b) in Ω = tan(π f/rate); then the electrode's and amplifier's band.
std::vector<Biquad> muscle_spectrum(const SyntheticEmgOptions& o) {
  const double low = std::tan(pi * o.spectrum_low_hz / o.rate_hz);
  const double high = std::tan(pi * o.spectrum_high_hz / o.rate_hz);
  const double d = (1.0 + low) * (1.0 + high);
  std::vector<Biquad> sections;
  sections.push_back(
      {high / d, 0.0, -high / d, 2.0 * (low * high - 1.0) / d, (1.0 - low) * (1.0 - high) / d});
  sections.push_back({high / (1.0 + high), high / (1.0 + high), 0.0, (high - 1.0) / (1.0 + high), 0.0});
  append(sections, FilterSpec::high_pass(o.band_low_hz), o.rate_hz);
  append(sections, FilterSpec::low_pass(o.band_high_hz), o.rate_hz);
  return sections;
}

void add_hum(std::vector<double>& x, const SyntheticEmgOptions& o) {
  Random random = sequence(o, hum);
  for (int i = 0; i < o.hum_harmonics; ++i) {
    const int k = 2 * i + 1;
    const double phase = 2.0 * pi * random.uniform();
    const double f = k * o.hum_hz;
    if (!(f < 0.5 * o.rate_hz)) break;
    for (std::size_t j = 0; j < x.size(); ++j) {
      x[j] += o.hum_V / k * std::sin(2.0 * pi * f * static_cast<double>(j) / o.rate_hz + phase);
    }
  }
}

void add_heart(std::vector<double>& x, const SyntheticEmgOptions& o) {
  struct Wave {
    double height, centre_s, width_s;
  };
  static constexpr Wave waves[] = {
      {-0.12, -0.028, 0.009}, {1.0, 0.0, 0.010}, {-0.25, 0.030, 0.011}, {0.20, 0.250, 0.045}};
  Random random = sequence(o, heart);
  const double duration = static_cast<double>(x.size()) / o.rate_hz;
  double beat = -random.uniform() / o.heart_rate_hz;
  for (; beat < duration + 0.1; beat += (1.0 + 0.03 * random.normal()) / o.heart_rate_hz) {
    for (const Wave& w : waves) {
      const double centre = beat + w.centre_s;
      const double from = std::max(0.0, std::ceil((centre - 6.0 * w.width_s) * o.rate_hz));
      const double to = std::min(static_cast<double>(x.size()), (centre + 6.0 * w.width_s) * o.rate_hz);
      for (double j = from; j < to; j += 1.0) {
        const double s = (j / o.rate_hz - centre) / w.width_s;
        x[static_cast<std::size_t>(j)] += o.ecg_V * w.height * std::exp(-0.5 * s * s);
      }
    }
  }
}

void add_dropouts(SyntheticEmg& emg, const SyntheticEmgOptions& o) {
  Random random = sequence(o, dropout);
  emg.dropout_samples =
      std::max<std::size_t>(1, static_cast<std::size_t>(std::lround(o.dropout_s * o.rate_hz)));
  const double mean_gap = 60.0 / o.dropouts_per_minute;
  const double duration = static_cast<double>(emg.raw.size()) / o.rate_hz;
  for (double t = -mean_gap * portable_log(random.uniform()); t < duration;
       t += o.dropout_s - mean_gap * portable_log(random.uniform())) {
    const auto first = static_cast<std::size_t>(t * o.rate_hz);
    if (first >= emg.raw.size()) break;
    emg.dropout_first.push_back(first);
    const std::size_t last = std::min(emg.raw.size(), first + emg.dropout_samples);
    std::fill(emg.raw.begin() + static_cast<std::ptrdiff_t>(first),
              emg.raw.begin() + static_cast<std::ptrdiff_t>(last), 0.0);
  }
}

}  // namespace

SyntheticEmg synthesise_emg(std::span<const double> excitation, double excitation_rate_hz,
                            const SyntheticEmgOptions& o) {
  check(excitation, excitation_rate_hz, o);
  SyntheticEmg emg;
  emg.mean_rectified_at_unit_V = o.amplitude_V * std::sqrt(2.0 / pi);
  if (excitation.empty()) return emg;

  const double last = static_cast<double>(excitation.size() - 1);
  const double ratio = excitation_rate_hz / o.rate_hz;
  const auto n = static_cast<std::size_t>(std::floor(last / ratio * (1.0 + 1e-12))) + 1;
  emg.excitation.resize(n);
  emg.clean.resize(n);
  ColouredNoise noise(muscle_spectrum(o), o.rate_hz, sequence(o, muscle));
  for (std::size_t k = 0; k < n; ++k) {
    const double position = std::min(static_cast<double>(k) * ratio, last);
    const auto i = static_cast<std::size_t>(position);
    const double next = excitation[std::min(i + 1, excitation.size() - 1)];
    emg.excitation[k] = excitation[i] + (position - std::floor(position)) * (next - excitation[i]);
    emg.clean[k] = o.amplitude_V * emg.excitation[k] * noise();
  }

  emg.raw = emg.clean;
  if (o.snr_db) {
    Random random = sequence(o, sensor);
    const double sd = o.amplitude_V * std::pow(10.0, -*o.snr_db / 20.0);
    for (double& x : emg.raw) x += sd * random.normal();
  }
  if (o.hum_V > 0.0) add_hum(emg.raw, o);
  if (o.ecg_V > 0.0) add_heart(emg.raw, o);
  if (o.motion_V > 0.0) {
    std::vector<Biquad> sections;
    append(sections, FilterSpec::low_pass(std::min(10.0, 0.2 * o.rate_hz)), o.rate_hz);
    ColouredNoise slow(std::move(sections), o.rate_hz, sequence(o, motion));
    for (double& x : emg.raw) x += o.motion_V * slow();
  }
  for (std::size_t k = 0; k < n; ++k)
    emg.raw[k] += o.offset_V + o.drift_V_per_s * static_cast<double>(k) / o.rate_hz;
  if (o.clip_V > 0.0) {
    for (double& x : emg.raw) {
      if (std::abs(x) > o.clip_V) {
        x = std::copysign(o.clip_V, x);
        ++emg.clipped_samples;
      }
    }
  }
  if (o.dropouts_per_minute > 0.0) add_dropouts(emg, o);
  return emg;
}

}  // namespace brachium::emg
