/// The tangents of the forward chain against differences of the whole chain, velocities in time included.

#include <gtest/gtest.h>

#include <cmath>
#include <tuple>

#include "hill/forward.hpp"
#include "tests/hill/finite_difference.hpp"
#include "tests/hill/swing.hpp"

namespace brachium::hill {
namespace {

using tests::relative_error;
using tests::slopes_of;
using tests::Swing;
using tests::triceps;

constexpr MuscleParameter kParameters[] = {MuscleParameter::max_isometric_force,
                                           MuscleParameter::strength,
                                           MuscleParameter::optimal_fibre_length,
                                           MuscleParameter::tendon_slack_length,
                                           MuscleParameter::pennation,
                                           MuscleParameter::max_contraction_velocity,
                                           MuscleParameter::fibre_damping};

std::vector<double> direction(const Swing& s) {
  std::vector<double> d;
  for (std::size_t k = 0; k < s.length.size(); ++k)
    d.push_back(0.5 + 0.4 * std::sin(0.07 * static_cast<double>(k)));
  return d;
}

std::vector<double> force(const data::MuscleParameters& p, const MuscleModelOptions& o, const Swing& s,
                          double along) {
  Swing moved = s;
  const std::vector<double> d = direction(s);
  for (std::size_t k = 0; k < d.size(); ++k) moved.activation[k] += along * d[k];
  MuscleScratch scratch;
  MuscleTrace out;
  forward(MuscleTendon("TRI", p, o), {s.rate_hz, s.length, s.velocity, {}}, moved.activation, scratch, out);
  return out.force_N;
}

std::vector<double> tangent(const data::MuscleParameters& p, const MuscleModelOptions& o, const Swing& s,
                            std::optional<MuscleParameter> parameter, bool along_activation) {
  const std::vector<double> d = direction(s);
  std::vector<double> dforce(s.length.size());
  const Tangent wanted[] = {
      {along_activation ? std::span<const double>(d) : std::span<const double>(), parameter, dforce}};
  MuscleScratch scratch;
  MuscleTrace out;
  forward(MuscleTendon("TRI", p, o), {s.rate_hz, s.length, s.velocity, {}}, s.activation, scratch, out,
          wanted);
  return dforce;
}

/// Worst relative error over all parameters and the activation; analytic tangents are scaled by `factor`.
double worst_error(const MuscleModelOptions& o, const Swing& s, double factor) {
  const data::MuscleParameters p = triceps();
  double worst = 0.0;
  for (const MuscleParameter which : kParameters) {
    const double at = get(p, which), h = 2e-6 * at;
    const auto numeric = slopes_of(
        [&](double value) {
          data::MuscleParameters changed = p;
          set(changed, which, value);
          return force(changed, o, s, 0.0);
        },
        at, h);
    auto analytic = tangent(p, o, s, which, false);
    for (double& x : analytic) x *= factor;
    worst = std::max(worst, relative_error(analytic, numeric));
  }
  const auto numeric = slopes_of([&](double along) { return force(p, o, s, along); }, 0.0, 1e-6);
  auto analytic = tangent(p, o, s, std::nullopt, true);
  for (double& x : analytic) x *= factor;
  return std::max(worst, relative_error(analytic, numeric));
}

using Case = std::tuple<std::string, TendonKind, FibreVelocity, Compatibility>;
class Tangents : public ::testing::TestWithParam<Case> {
 protected:
  static MuscleModelOptions options() {
    MuscleModelOptions o;
    const auto& [set, tendon, velocity, compatibility] = GetParam();
    o.curves = CurveSet::named(set);
    o.tendon = tendon;
    o.velocity = velocity;
    o.compatibility = compatibility;
    o.optimal_length_coupling = 0.15;
    return o;
  }
};

std::string name_of(const ::testing::TestParamInfo<Case>& test) {
  const auto& [set, tendon, velocity, compatibility] = test.param;
  return set + "_" + to_string(tendon) + "_" + to_string(velocity) +
         (compatibility == Compatibility::ceinms ? "_ceinms" : "");
}
INSTANTIATE_TEST_SUITE_P(OfOurChains, Tangents,
                         ::testing::Combine(::testing::ValuesIn(CurveSet::names()),
                                            ::testing::Values(TendonKind::rigid, TendonKind::elastic),
                                            ::testing::Values(FibreVelocity::zero_lag, FibreVelocity::causal,
                                                              FibreVelocity::none),
                                            ::testing::Values(Compatibility::none)),
                         name_of);
INSTANTIATE_TEST_SUITE_P(OfCeinms, Tangents,
                         ::testing::Combine(::testing::ValuesIn(CurveSet::names()),
                                            ::testing::Values(TendonKind::rigid, TendonKind::elastic),
                                            ::testing::Values(FibreVelocity::zero_lag),
                                            ::testing::Values(Compatibility::ceinms)),
                         name_of);

TEST_P(Tangents, AreThoseOfTheDiscreteChain) {
  EXPECT_LT(worst_error(options(), Swing(200.0, 120), 1.0), 1e-5);
}

TEST_P(Tangents, WrongByATenthOfAPercentAreFound) {
  EXPECT_GT(worst_error(options(), Swing(200.0, 120), 1.001), 5e-4);
}

TEST(ForwardTangents, AParameterAndItsActivationAddUp) {
  MuscleModelOptions o;
  o.tendon = TendonKind::elastic;
  const Swing s(200.0, 120);
  const auto both = tangent(triceps(), o, s, MuscleParameter::tendon_slack_length, true);
  const auto one = tangent(triceps(), o, s, MuscleParameter::tendon_slack_length, false);
  const auto other = tangent(triceps(), o, s, std::nullopt, true);
  for (std::size_t k = 0; k < both.size(); ++k)
    EXPECT_NEAR(both[k], one[k] + other[k], 1e-9 * (1.0 + std::abs(both[k])));
}

TEST(ForwardTangents, HoldAcrossSlackFrames) {
  for (const auto tendon : {TendonKind::rigid, TendonKind::elastic}) {
    MuscleModelOptions o;
    o.curves = DeGrooteFregly2016();
    o.tendon = tendon;
    o.velocity = FibreVelocity::causal;
    Swing s(200.0, 120);
    for (std::size_t k = 40; k < 60; ++k) s.length[k] = 0.05;
    EXPECT_LT(worst_error(o, s, 1.0), 1e-5) << to_string(tendon);
  }
}

TEST(ForwardTangents, TheVelocityInTimeIsPartOfThem) {
  // What a tangent would be that held the fibre velocity fixed is far off.
  MuscleModelOptions o;
  o.curves = DeGrooteFregly2016();
  o.tendon = TendonKind::elastic;
  const Swing s(200.0, 120);
  const auto exact = tangent(triceps(), o, s, MuscleParameter::tendon_slack_length, false);
  o.velocity = FibreVelocity::none;
  const auto frozen = tangent(triceps(), o, s, MuscleParameter::tendon_slack_length, false);
  EXPECT_GT(relative_error(frozen, exact), 0.01);
}

}  // namespace
}  // namespace brachium::hill
