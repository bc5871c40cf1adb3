#pragma once
/// Values of a sampled signal at other instants. Internal to optimise/.

#include <array>
#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "data/model/signal.hpp"

namespace brachium::optimise {

/// Cubic Lagrange interpolation between the four nearest samples (fewer at the ends); exact, one sample
/// alone, where an instant coincides with a sample to 1e-6 of the period. Linear in the samples, with weights
/// fixed once.
class Resampling {
 public:
  Resampling() = default;
  /// Instants must lie inside the signal's span (to 1e-3 of a period); std::out_of_range otherwise.
  Resampling(const data::SignalInfo& from, std::span<const double> times_s);
  std::size_t size() const { return first_.size(); }
  bool identity() const { return identity_; }
  void apply(std::span<const double> samples, std::span<double> out) const;

 private:
  std::vector<std::size_t> first_;
  std::vector<std::array<double, 4>> weight_;
  bool identity_ = false;
};

/// Throws InputError: "empty-signal", "not-finite" (naming the sample), "bad-rate", with `what` in the
/// message.
void check_samples(const data::Signal& signal, const std::string& what);

}  // namespace brachium::optimise
