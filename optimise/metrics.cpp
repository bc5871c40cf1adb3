#include "optimise/metrics.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "data/model/error.hpp"

namespace brachium::optimise {

Metrics metrics(std::span<const double> reference, std::span<const double> model) {
  if (reference.size() != model.size())
    throw data::InputError("wrong-size",
                           fmt::format("a reference of {} samples cannot be compared with {} modelled ones",
                                       reference.size(), model.size()));
  if (reference.empty()) throw data::InputError("empty-signal", "there is no sample to compare");
  Metrics m;
  m.count = reference.size();
  const double n = static_cast<double>(m.count);
  double mean_reference = 0.0, mean_model = 0.0, square = 0.0;
  double lowest = reference[0], highest = reference[0];
  for (std::size_t i = 0; i < m.count; ++i) {
    if (!std::isfinite(reference[i]) || !std::isfinite(model[i]))
      throw data::InputError("not-finite", fmt::format("sample {} of the {} is not finite", i,
                                                       std::isfinite(reference[i]) ? "model" : "reference"));
    const double error = model[i] - reference[i];
    mean_reference += reference[i] / n;
    mean_model += model[i] / n;
    square += error * error;
    m.bias += error / n;
    m.mean_absolute_error += std::abs(error) / n;
    m.max_absolute_error = std::max(m.max_absolute_error, std::abs(error));
    lowest = std::min(lowest, reference[i]);
    highest = std::max(highest, reference[i]);
  }
  m.rmse = std::sqrt(square / n);
  double rr = 0.0, mm = 0.0, rm = 0.0;
  for (std::size_t i = 0; i < m.count; ++i) {
    const double r = reference[i] - mean_reference, y = model[i] - mean_model;
    rr += r * r;
    mm += y * y;
    rm += r * y;
  }
  const bool varies = highest > lowest;
  if (varies && rr > 0.0) {
    m.nrmse_range = m.rmse / (highest - lowest);
    m.nrmse_sd = m.rmse / std::sqrt(rr / n);
    m.r2 = 1.0 - square / rr;
    if (mm > 0.0) m.correlation = rm / std::sqrt(rr * mm);
  }
  return m;
}

Metrics pooled_metrics(std::span<const std::vector<double>> reference,
                       std::span<const std::vector<double>> model) {
  if (reference.size() != model.size())
    throw data::InputError("wrong-size",
                           fmt::format("{} reference trials cannot be compared with {} modelled ones",
                                       reference.size(), model.size()));
  std::vector<double> all_reference, all_model;
  for (std::size_t t = 0; t < reference.size(); ++t) {
    if (reference[t].size() != model[t].size())
      throw data::InputError("wrong-size",
                             fmt::format("trial {}: a reference of {} samples cannot be compared with {}", t,
                                         reference[t].size(), model[t].size()));
    all_reference.insert(all_reference.end(), reference[t].begin(), reference[t].end());
    all_model.insert(all_model.end(), model[t].begin(), model[t].end());
  }
  return metrics(all_reference, all_model);
}

}  // namespace brachium::optimise
