#include "hill/forward.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "data/model/error.hpp"
#include "tests/hill/swing.hpp"

namespace brachium::hill {
namespace {

using tests::Swing;
using tests::triceps;

MuscleTrace run(const MuscleTendon& muscle, const Swing& s, bool with_rate = true, bool parts = false) {
  MuscleScratch scratch;
  MuscleTrace out;
  out.parts = parts;
  forward(muscle,
          {s.rate_hz, s.length, with_rate ? std::span<const double>(s.velocity) : std::span<const double>(),
           s.arm},
          s.activation, scratch, out);
  return out;
}

class EverySetForward : public ::testing::TestWithParam<std::string> {
 protected:
  static MuscleModelOptions options(TendonKind tendon, FibreVelocity velocity = FibreVelocity::zero_lag) {
    MuscleModelOptions o;
    o.curves = CurveSet::named(GetParam());
    o.tendon = tendon;
    o.velocity = velocity;
    o.optimal_length_coupling = 0.15;
    return o;
  }
};
INSTANTIATE_TEST_SUITE_P(Forward, EverySetForward, ::testing::ValuesIn(CurveSet::names()),
                         [](const auto& set) { return set.param; });

TEST_P(EverySetForward, RigidPiecesOfATrialAreTheTrialToTheLastBit) {
  const MuscleModelOptions o = options(TendonKind::rigid);
  ASSERT_TRUE(frames_are_independent(o, true));
  EXPECT_FALSE(frames_are_independent(o, false));
  EXPECT_FALSE(frames_are_independent(options(TendonKind::elastic), true));
  EXPECT_FALSE(frames_are_independent(ceinms_options(TendonKind::rigid), true));
  const MuscleTendon muscle("TRI", triceps(), o);
  const Swing s(200.0, 400);
  const MuscleTrace whole = run(muscle, s);
  for (const auto& [from, count] : {std::pair<std::size_t, std::size_t>{0, 137}, {137, 1}, {138, 262}}) {
    MuscleScratch scratch;
    MuscleTrace out;
    const auto piece = [&](const std::vector<double>& v) { return std::span(v).subspan(from, count); };
    forward(muscle, {s.rate_hz, piece(s.length), piece(s.velocity), piece(s.arm)}, piece(s.activation),
            scratch, out);
    for (std::size_t k = 0; k < count; ++k) ASSERT_EQ(out.force_N[k], whole.force_N[from + k]);
  }
}

TEST_P(EverySetForward, RigidForceIsTheFormula) {
  const data::MuscleParameters p = triceps();
  const MuscleTendon muscle("TRI", p, options(TendonKind::rigid));
  const Swing s(200.0, 400);
  const MuscleTrace out = run(muscle, s, true, true);
  const CurveSet& c = muscle.options().curves;
  for (std::size_t k = 0; k < s.length.size(); ++k) {
    const double z = s.length[k] - p.tendon_slack_length_m,
                 h = p.optimal_fibre_length_m * std::sin(p.pennation_at_optimal_rad);
    const double l = std::hypot(z, h), phi = std::asin(h / l), v = s.velocity[k] * std::cos(phi),
                 a = s.activation[k];
    const double vn = v / (p.max_contraction_velocity * p.optimal_fibre_length_m),
                 x = l / p.optimal_fibre_length_m;
    const double fibre = a * c.active(x / (1.0 + 0.15 * (1.0 - a))).value * c.velocity(vn, a).value +
                         c.passive(x).value + p.fibre_damping * vn;
    EXPECT_NEAR(out.force_N[k], p.max_isometric_force_N * p.strength * fibre * std::cos(phi), 1e-9);
    EXPECT_NEAR(out.moment_N_m[k], s.arm[k] * out.force_N[k], 1e-12);
    EXPECT_NEAR(out.fibre_length_m[k], l, 1e-15);
    EXPECT_NEAR(out.fibre_velocity_m_s[k], v, 1e-14);
    EXPECT_NEAR(out.pennation_rad[k], phi, 1e-7);
    EXPECT_NEAR(out.active_norm[k] + out.passive_norm[k] + out.damping_norm[k], fibre, 1e-13);
    EXPECT_EQ(out.status[k], FrameStatus::ok);
  }
}

// The force must be the tendon's and the fibres' at once; written with the public curves only.
TEST_P(EverySetForward, ElasticForceIsInEquilibrium) {
  const data::MuscleParameters p = triceps();
  for (const auto velocity : {FibreVelocity::zero_lag, FibreVelocity::causal, FibreVelocity::none}) {
    const MuscleTendon muscle("TRI", p, options(TendonKind::elastic, velocity));
    const Swing s(200.0, 400);
    const MuscleTrace out = run(muscle, s);
    const CurveSet& c = muscle.options().curves;
    const double S = p.max_isometric_force_N * p.strength;
    const double damping = velocity == FibreVelocity::none ? 0.0 : p.fibre_damping;
    for (std::size_t k = 0; k < s.length.size(); ++k) {
      const double l = out.fibre_length_m[k],
                   h = p.optimal_fibre_length_m * std::sin(p.pennation_at_optimal_rad), a = s.activation[k];
      const double cosine = std::sqrt(1.0 - h * h / (l * l));
      const double vn = out.fibre_velocity_m_s[k] / (p.max_contraction_velocity * p.optimal_fibre_length_m),
                   x = l / p.optimal_fibre_length_m;
      const double fv = velocity == FibreVelocity::none ? 1.0 : c.velocity(vn, a).value;
      const double fibre =
          a * c.active(x / (1.0 + 0.15 * (1.0 - a))).value * fv + c.passive(x).value + damping * vn;
      EXPECT_NEAR(out.force_N[k], S * fibre * cosine, 1e-6 * S) << k;
      const double strain = (s.length[k] - l * cosine) / p.tendon_slack_length_m - 1.0;
      EXPECT_NEAR(out.force_N[k], S * c.tendon(strain).value, 1e-9 * S) << k;
      EXPECT_EQ(out.status[k], FrameStatus::ok);
    }
  }
}

TEST(Forward, AStiffTendonIsTheRigidOne) {
  // A strain of 1e-5 at F0.
  DeGrooteFregly2016::Parameters stiff;
  stiff.tendon_strain_at_one_force = 1e-5;
  MuscleModelOptions o;
  o.curves = DeGrooteFregly2016(stiff);
  const Swing s(200.0, 400);
  const MuscleTrace rigid = run(MuscleTendon("TRI", triceps(), o), s);
  o.tendon = TendonKind::elastic;
  const MuscleTrace elastic = run(MuscleTendon("TRI", triceps(), o), s);
  for (std::size_t k = 4; k < s.length.size(); ++k)
    EXPECT_NEAR(elastic.force_N[k], rigid.force_N[k], 1e-3 * triceps().max_isometric_force_N) << k;
}

TEST(Forward, RigidVelocityByDifferencesConvergesWithItsOrder) {
  for (const auto& [kind, order] : {std::pair{FibreVelocity::zero_lag, 4.0}, {FibreVelocity::causal, 2.0}}) {
    MuscleModelOptions o;
    o.curves = DeGrooteFregly2016();
    o.velocity = kind;
    const MuscleTendon muscle("TRI", triceps(), o);
    const auto error = [&](double rate, std::size_t n) {
      const Swing s(rate, n);
      const MuscleTrace given = run(muscle, s), differenced = run(muscle, s, false);
      double worst = 0.0;
      for (std::size_t k = 2; k < n; ++k)
        worst = std::max(worst, std::abs(given.fibre_velocity_m_s[k] - differenced.fibre_velocity_m_s[k]));
      return worst;
    };
    EXPECT_NEAR(std::log2(error(100.0, 200) / error(200.0, 400)), order, 0.15) << to_string(kind);
  }
}

TEST(Forward, ElasticChainsConvergeToTheDifferentialEquationWithTheirOrder) {
  // Reference: the same chain at 16 times the rate, whose own error is far below.
  for (const auto& [kind, order] : {std::pair{FibreVelocity::zero_lag, 4.0}, {FibreVelocity::causal, 2.0}}) {
    MuscleModelOptions o;
    o.curves = DeGrooteFregly2016();
    o.tendon = TendonKind::elastic;
    o.velocity = kind;
    const MuscleTendon muscle("TRI", triceps(), o);
    o.velocity = FibreVelocity::zero_lag;
    const MuscleTrace fine = run(MuscleTendon("TRI", triceps(), o), Swing(3200.0, 6400));
    const auto error = [&](std::size_t every) {
      const std::size_t n = 6400 / every;
      const MuscleTrace coarse = run(muscle, Swing(3200.0 / static_cast<double>(every), n));
      double worst = 0.0;
      // After the start has died away, and before the one-sided differences at the end.
      for (std::size_t k = n / 2; k + 8 < n; ++k)
        worst = std::max(worst, std::abs(coarse.force_N[k] - fine.force_N[k * every]));
      return worst;
    };
    const double observed = std::log2(error(16) / error(8));
    EXPECT_NEAR(observed, order, 0.35) << to_string(kind) << ' ' << error(16) << ' ' << error(8);
  }
}

TEST(Forward, TheCausalChainDoesNotLookAhead) {
  for (const auto tendon : {TendonKind::rigid, TendonKind::elastic}) {
    MuscleModelOptions o;
    o.tendon = tendon;
    o.velocity = FibreVelocity::causal;
    const MuscleTendon muscle("TRI", triceps(), o);
    const Swing all(200.0, 400), part(200.0, 250);
    const MuscleTrace a = run(muscle, all, false), b = run(muscle, part, false);
    for (std::size_t k = 0; k < 250; ++k) EXPECT_EQ(a.force_N[k], b.force_N[k]);
  }
}

TEST(Forward, ASlackPathIsAStatusAndCarriesNothing) {
  for (const auto tendon : {TendonKind::rigid, TendonKind::elastic}) {
    for (const auto compatibility : {Compatibility::none, Compatibility::ceinms}) {
      MuscleModelOptions o;
      o.tendon = tendon;
      o.compatibility = compatibility;
      const MuscleTendon muscle("TRI", triceps(), o);
      Swing s(200.0, 400);
      for (std::size_t k = 100; k < 120; ++k) s.length[k] = 0.5 * triceps().tendon_slack_length_m;
      const MuscleTrace out = run(muscle, s);
      EXPECT_EQ(out.count(FrameStatus::slack), 20u);
      for (std::size_t k = 100; k < 120; ++k) {
        EXPECT_EQ(out.status[k], FrameStatus::slack);
        EXPECT_EQ(out.force_N[k], 0.0);
        EXPECT_LT(out.fibre_length_m[k], 0.2 * triceps().optimal_fibre_length_m);  // not the mirrored length
      }
      EXPECT_EQ(out.status[90], FrameStatus::ok);  // symmetric differences see the jump a little ahead
      for (const double f : out.force_N) EXPECT_TRUE(std::isfinite(f));
    }
  }
}

TEST(Forward, FibresNeverPush) {
  // Without activation and with fast shortening the damping would push: nothing is carried instead.
  for (const auto tendon : {TendonKind::rigid, TendonKind::elastic}) {
    MuscleModelOptions o;
    o.tendon = tendon;
    const MuscleTendon muscle("TRI", triceps(), o);
    Swing s(200.0, 200);
    std::fill(s.activation.begin(), s.activation.end(), 0.0);
    for (std::size_t k = 0; k < 200; ++k) {
      s.length[k] = 0.2211 - 0.2 * static_cast<double>(k) / 1000.0;
      s.velocity[k] = -0.2 / 5.0;
    }
    const MuscleTrace out = run(muscle, s);
    EXPECT_GT(out.count(FrameStatus::unloaded), 150u) << to_string(tendon);
    for (std::size_t k = 0; k < 200; ++k) {
      EXPECT_GE(out.force_N[k], 0.0);
      if (out.status[k] == FrameStatus::unloaded) {
        EXPECT_EQ(out.force_N[k], 0.0);
      }
    }
  }
}

TEST(Forward, EquilibriumIsFoundOverTheWholeRangeOfLengthAndActivation) {
  for (const std::string& set : CurveSet::names()) {
    MuscleModelOptions o;
    o.curves = CurveSet::named(set);
    o.tendon = TendonKind::elastic;
    o.velocity = FibreVelocity::none;
    const data::MuscleParameters p = triceps();
    const MuscleTendon muscle("TRI", p, o);
    Swing s(200.0, 5);
    for (double l = 0.1; l < 1.9; l += 0.0731) {
      for (const double a : {0.0, 1e-9, 1e-4, 0.01, 0.3, 1.0}) {
        std::fill(s.length.begin(), s.length.end(), p.tendon_slack_length_m + l * p.optimal_fibre_length_m);
        std::fill(s.activation.begin(), s.activation.end(), a);
        const MuscleTrace out = run(muscle, s);
        EXPECT_TRUE(std::isfinite(out.force_N[4]));
        EXPECT_GE(out.force_N[4], 0.0);
        EXPECT_LE(out.fibre_length_m[4] * std::sqrt(1.0 - std::pow(p.optimal_fibre_length_m *
                                                                       std::sin(p.pennation_at_optimal_rad) /
                                                                       out.fibre_length_m[4],
                                                                   2)),
                  l * p.optimal_fibre_length_m * (1.0 + 1e-9));
      }
    }
  }
}

void expect_input_error(const MuscleTendon& muscle, const Swing& s, const char* code, const char* message) {
  try {
    run(muscle, s, false);
    FAIL() << message;
  } catch (const data::InputError& e) {
    EXPECT_EQ(e.diagnostics()[0].code, code);
    EXPECT_EQ(e.diagnostics()[0].message, message);
  }
}

TEST(Forward, WrongInputsAreNamed) {
  const MuscleTendon muscle("TRI", triceps(), {});
  Swing s(200.0, 10);
  s.activation[3] = 1.5;
  expect_input_error(muscle, s, "activation-range", "the activation of muscle `TRI` is 1.5 at frame 3");
  s.activation[3] = std::nan("");
  expect_input_error(muscle, s, "activation-range", "the activation of muscle `TRI` is nan at frame 3");
  s = Swing(200.0, 10);
  s.length[7] = std::nan("");
  expect_input_error(muscle, s, "not-finite", "`length_m` of muscle `TRI` is nan at frame 7");
  s = Swing(200.0, 10);
  s.arm.pop_back();
  expect_input_error(muscle, s, "size-mismatch", "`moment_arm_m` of muscle `TRI` has 9 frames, its path 10");
  s = Swing(200.0, 10);
  s.activation.pop_back();
  expect_input_error(muscle, s, "size-mismatch", "`activation` of muscle `TRI` has 9 frames, its path 10");
  s = Swing(200.0, 4);
  expect_input_error(muscle, s, "trial-too-short",
                     "the path of muscle `TRI` has 4 frames; the fibre velocity needs at least 5");
  s = Swing(200.0, 10);
  s.rate_hz = 0.0;
  expect_input_error(muscle, s, "bad-rate", "the path of muscle `TRI` has a rate of 0 Hz");
}

TEST(Forward, ParametersGoByTheirNames) {
  data::MuscleParameters p = triceps();
  for (const char* name :
       {"max_isometric_force_N", "strength", "optimal_fibre_length_m", "tendon_slack_length_m",
        "pennation_at_optimal_rad", "max_contraction_velocity", "fibre_damping"}) {
    const MuscleParameter which = parse_muscle_parameter(name);
    EXPECT_EQ(to_string(which), name);
    set(p, which, 0.25);
    EXPECT_EQ(get(p, which), 0.25);
  }
  EXPECT_THROW(parse_muscle_parameter("slack"), data::InputError);
}

}  // namespace
}  // namespace brachium::hill
