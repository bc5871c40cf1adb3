#include "optimise/sampling.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "data/model/error.hpp"

namespace brachium::optimise {

Resampling::Resampling(const data::SignalInfo& from, std::span<const double> times_s)
    : first_(times_s.size()), weight_(times_s.size()) {
  const auto n = static_cast<std::ptrdiff_t>(from.count);
  identity_ = times_s.size() == from.count;
  for (std::size_t i = 0; i < times_s.size(); ++i) {
    const double position = (times_s[i] - from.start_time_s) * from.rate_hz;
    if (!(position >= -1e-3 && position <= static_cast<double>(n - 1) + 1e-3))
      throw std::out_of_range("an instant lies outside the signal");
    const double nearest = std::round(position);
    if (std::abs(position - nearest) < 1e-6 || n == 1) {
      first_[i] = static_cast<std::size_t>(
          std::clamp<std::ptrdiff_t>(static_cast<std::ptrdiff_t>(nearest), 0, n - 1));
      weight_[i] = {1.0, 0.0, 0.0, 0.0};
      identity_ = identity_ && first_[i] == i;
      continue;
    }
    identity_ = false;
    const std::ptrdiff_t points = std::min<std::ptrdiff_t>(4, n);
    const auto base = std::clamp<std::ptrdiff_t>(
        static_cast<std::ptrdiff_t>(std::floor(position)) - (points == 4 ? 1 : 0), 0, n - points);
    first_[i] = static_cast<std::size_t>(base);
    const double s = position - static_cast<double>(base);
    weight_[i] = {0.0, 0.0, 0.0, 0.0};
    for (std::ptrdiff_t a = 0; a < points; ++a) {
      double w = 1.0;
      for (std::ptrdiff_t b = 0; b < points; ++b)
        if (b != a) w *= (s - static_cast<double>(b)) / static_cast<double>(a - b);
      weight_[i][static_cast<std::size_t>(a)] = w;
    }
  }
}

void Resampling::apply(std::span<const double> samples, std::span<double> out) const {
  if (identity_) {
    std::copy(samples.begin(), samples.end(), out.begin());
    return;
  }
  for (std::size_t i = 0; i < first_.size(); ++i) {
    double sum = 0.0;
    for (std::size_t a = 0; a < 4; ++a)
      if (weight_[i][a] != 0.0) sum += weight_[i][a] * samples[first_[i] + a];
    out[i] = sum;
  }
}

void check_samples(const data::Signal& signal, const std::string& what) {
  if (signal.samples.empty() || signal.info.count != signal.samples.size())
    throw data::InputError("empty-signal",
                           fmt::format("{}: signal `{}` has no samples", what, signal.info.name));
  if (!(signal.info.rate_hz > 0.0) || !std::isfinite(signal.info.rate_hz) ||
      !std::isfinite(signal.info.start_time_s))
    throw data::InputError("bad-rate", fmt::format("{}: signal `{}` has rate {} Hz", what, signal.info.name,
                                                   signal.info.rate_hz));
  for (std::size_t i = 0; i < signal.samples.size(); ++i)
    if (!std::isfinite(signal.samples[i]))
      throw data::InputError("not-finite",
                             fmt::format("{}: sample {} of signal `{}` is not finite ({:.3f} s)", what, i,
                                         signal.info.name, signal.info.time_s(i)));
}

}  // namespace brachium::optimise
