#include "optimise/metrics.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "data/model/error.hpp"

namespace brachium::optimise {
namespace {

TEST(Metrics, FollowTheirDefinitionsOnFourSamples) {
  const std::vector<double> reference = {0.0, 1.0, 2.0, 5.0}, model = {1.0, 1.0, 1.0, 7.0};
  const Metrics m = metrics(reference, model);  // errors 1, 0, -1, 2
  EXPECT_DOUBLE_EQ(m.rmse, std::sqrt(1.5));
  EXPECT_DOUBLE_EQ(m.bias, 0.5);
  EXPECT_DOUBLE_EQ(m.mean_absolute_error, 1.0);
  EXPECT_DOUBLE_EQ(m.max_absolute_error, 2.0);
  EXPECT_DOUBLE_EQ(*m.nrmse_range, std::sqrt(1.5) / 5.0);
  EXPECT_DOUBLE_EQ(*m.nrmse_sd, std::sqrt(1.5) / std::sqrt(14.0 / 4.0));
  EXPECT_DOUBLE_EQ(*m.r2, 1.0 - 6.0 / 14.0);
  EXPECT_NEAR(*m.correlation, 18.0 / std::sqrt(14.0 * 27.0), 1e-15);
}

TEST(Metrics, OfAConstantReferenceHaveNoR2) {
  const Metrics m = metrics(std::vector<double>{2.0, 2.0}, std::vector<double>{1.0, 3.0});
  EXPECT_FALSE(m.r2);
  EXPECT_FALSE(m.nrmse_range);
  EXPECT_DOUBLE_EQ(m.rmse, 1.0);
}

TEST(Metrics, PooledTakeTheVarianceAboutTheCommonMean) {
  // Two trials, each predicted by its own mean: R2 within a trial is 0, pooled it is not.
  const std::vector<std::vector<double>> reference = {{0.0, 2.0}, {10.0, 12.0}},
                                         model = {{1.0, 1.0}, {11.0, 11.0}};
  EXPECT_DOUBLE_EQ(*metrics(reference[0], model[0]).r2, 0.0);
  EXPECT_DOUBLE_EQ(*pooled_metrics(reference, model).r2, 1.0 - 4.0 / 104.0);
}

TEST(Metrics, RefuseWhatCannotBeCompared) {
  const auto message = [](const std::vector<double>& a, const std::vector<double>& b) {
    try {
      metrics(a, b);
    } catch (const data::InputError& error) {
      return error.diagnostics()[0].message;
    }
    return std::string("accepted");
  };
  EXPECT_EQ(message({1.0}, {1.0, 2.0}), "a reference of 1 samples cannot be compared with 2 modelled ones");
  EXPECT_EQ(message({}, {}), "there is no sample to compare");
  EXPECT_EQ(message({1.0, std::nan("")}, {1.0, 2.0}), "sample 1 of the reference is not finite");
}

}  // namespace
}  // namespace brachium::optimise
