#include "emg/rest_level.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>
#include <vector>

#include "data/model/error.hpp"
#include "emg/conditioning.hpp"
#include "emg/synthetic_emg.hpp"

namespace brachium::emg {
namespace {

double mean_envelope(double excitation, double rest, double unit) {
  SyntheticEmgOptions electrode;
  electrode.snr_db = 20.0;
  electrode.seed = 5;
  std::vector<double> raw = synthesise_emg(std::vector<double>(12000, excitation), 200.0, electrode).raw;
  const ConditioningChain chain = design_conditioning({}, electrode.rate_hz);
  const std::vector<std::span<double>> channels{raw};
  const std::vector<std::string> names{"biceps"};
  const OutputLayout layout = condition(chain, channels, names, "hold");
  std::vector<double> envelope(raw.begin(), raw.begin() + static_cast<std::ptrdiff_t>(layout.count));
  if (rest > 0.0) remove_rest(envelope, rest);
  return std::accumulate(envelope.begin(), envelope.end(), 0.0) / static_cast<double>(envelope.size()) / unit;
}

TEST(RestLevel, GivesBackTheEnvelopeThatNoiseHasRaised) {
  const double rest = mean_envelope(0.0, 0.0, 1.0);
  const double unit = std::sqrt(std::pow(mean_envelope(1.0, 0.0, 1.0), 2) - rest * rest);
  EXPECT_GT(mean_envelope(0.2, 0.0, unit), 0.215);  // the noise alone adds more than 7 %
  EXPECT_NEAR(mean_envelope(0.2, rest, unit), 0.2, 0.006);
  EXPECT_NEAR(mean_envelope(0.5, rest, unit), 0.5, 0.01);
}

TEST(RestLevel, CountsSamplesAtOrBelowRest) {
  std::vector<double> envelope{0.5, 0.3, 0.1, -0.01};
  EXPECT_EQ(remove_rest(envelope, 0.3), 3u);
  EXPECT_DOUBLE_EQ(envelope[0], 0.4);
  EXPECT_EQ(envelope[1], 0.0);
  EXPECT_EQ(envelope[3], 0.0);
  EXPECT_THROW(remove_rest(envelope, std::nan("")), data::InputError);
}

}  // namespace
}  // namespace brachium::emg
