#pragma once
/// How well a modelled moment follows a measured one.
///
/// | symbol | identifier  | meaning                                                              |
/// |--------|-------------|----------------------------------------------------------------------|
/// | e_i    | -           | model_i - reference_i                                                |
/// | RMSE   | rmse        | sqrt(mean e^2)                                                       |
/// | NRMSE  | nrmse_range | RMSE / (max reference - min reference)                               |
/// | -      | nrmse_sd    | RMSE / standard deviation of the reference                           |
/// | R2     | r2          | 1 - sum e^2 / sum (reference - mean reference)^2                     |

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace brachium::optimise {

struct Metrics {
  std::size_t count = 0;
  double rmse = 0.0;
  double mean_absolute_error = 0.0;
  double max_absolute_error = 0.0;
  double bias = 0.0;                  ///< mean of model - reference
  std::optional<double> nrmse_range;  ///< none where the reference is constant
  std::optional<double> nrmse_sd;     ///< none where the reference is constant
  std::optional<double> r2;  ///< none where the reference is constant: an isometric hold has no variance
  std::optional<double> correlation;  ///< Pearson's; none where either is constant
};

/// Throws InputError: "wrong-size" if the sizes differ, "empty-signal" if there is no sample, "not-finite".
Metrics metrics(std::span<const double> reference, std::span<const double> model);

/// Metrics of several trials as one sample (not a mean of metrics): variance about the common mean.
Metrics pooled_metrics(std::span<const std::vector<double>> reference,
                       std::span<const std::vector<double>> model);

}  // namespace brachium::optimise
