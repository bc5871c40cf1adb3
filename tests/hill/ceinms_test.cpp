/// The elbow that CEINMS computed: with CEINMS' conventions, and how far our own defaults are from it.

#include <gtest/gtest.h>

#include <cmath>

#include "hill/differences.hpp"
#include "tests/hill/elbow.hpp"

namespace brachium::hill {
namespace {

using tests::ElbowReference;
using tests::largest_difference;

TEST(Ceinms, StiffTorqueIsReproducedTo1eMinus9) {
  BRACHIUM_NEEDS_REFERENCE();
  const ElbowReference ref("stiff");
  const auto moment = ref.moment(ceinms_options(TendonKind::rigid));
  EXPECT_LT(largest_difference(moment, ref.torque.at("elbow_flexion")), 1e-9);
}

TEST(Ceinms, TheMonotoneInterpolantIsNotWhatItUses) {
  BRACHIUM_NEEDS_REFERENCE();
  const ElbowReference ref("stiff");
  MuscleModelOptions o = ceinms_options(TendonKind::rigid);
  o.curves = Lloyd2003();
  EXPECT_GT(largest_difference(ref.moment(o), ref.torque.at("elbow_flexion")), 0.1);
}

// The force of the fibres at CEINMS' own fibre lengths, written with the public curves: its scheme without
// its root.
TEST(Ceinms, ElasticForceFollowsFromItsOwnFibreLengthsTo1eMinus9) {
  BRACHIUM_NEEDS_REFERENCE();
  const ElbowReference ref("equilibriumElastic");
  const CurveSet curves = CurveSet::named("lloyd_2003_spline");
  SplineSlopes spline;
  spline.prepare(ref.frames(), 1.0 / ElbowReference::kRate);
  std::vector<double> moment(ref.frames(), 0.0), slope(ref.frames());
  for (const auto& m : tests::elbow_muscles()) {
    const data::MuscleParameters& p = m.parameters;
    const std::vector<double>& l = ref.fibre.at(m.name);
    spline.apply(l, slope);
    for (std::size_t k = 0; k < l.size(); ++k) {
      const double a = ref.activation.at(m.name)[k], lo = p.optimal_fibre_length_m,
                   vn = slope[k] / (10.0 * lo);
      const double cosine = std::cos(std::asin(lo * std::sin(p.pennation_at_optimal_rad) / l[k]));
      const double fibre =
          a * curves.active(l[k] / (lo * (1.0 + 0.15 * (1.0 - a)))).value * curves.velocity(vn, a).value +
          curves.passive(l[k] / lo).value + 0.1 * vn;
      moment[k] += ref.arm.at(m.name)[k] * p.max_isometric_force_N * fibre * cosine;
    }
  }
  EXPECT_LT(largest_difference(moment, ref.torque.at("elbow_flexion")), 1e-9);
}

// Given CEINMS' own past, our equation's root must lie within the tolerance of its Brent search.
TEST(Ceinms, ElasticFibreLengthsAreRootsOfOurEquationWithinItsTolerance) {
  BRACHIUM_NEEDS_REFERENCE();
  const ElbowReference ref("equilibriumElastic");
  const CurveSet curves = CurveSet::named("lloyd_2003_spline");
  const double h = 1.0 / ElbowReference::kRate;
  double worst = 0.0;
  for (const auto& m : tests::elbow_muscles()) {
    const data::MuscleParameters& p = m.parameters;
    const std::vector<double>& l = ref.fibre.at(m.name);
    const double lo = p.optimal_fibre_length_m;
    for (std::size_t k = 3; k < l.size(); ++k) {
      const double a = ref.activation.at(m.name)[k], L = ref.length.at(m.name)[k];
      const auto residual = [&](double x) {
        const double cosine = std::cos(std::asin(lo * std::sin(p.pennation_at_optimal_rad) / x));
        const double vn =
            (11.0 * x - 18.0 * l[k - 1] + 9.0 * l[k - 2] - 2.0 * l[k - 3]) / (6.0 * h) / (10.0 * lo);
        const double fibre =
            a * curves.active(x / (lo * (1.0 + 0.15 * (1.0 - a)))).value * curves.velocity(vn, a).value +
            curves.passive(x / lo).value + 0.1 * vn;
        return curves.tendon((L - x * cosine) / p.tendon_slack_length_m - 1.0).value - fibre * cosine;
      };
      double lower = l[k] - 1e-5, upper = l[k] + 1e-5;
      ASSERT_GT(residual(lower), 0.0) << m.name << ' ' << k;
      ASSERT_LT(residual(upper), 0.0) << m.name << ' ' << k;
      for (int i = 0; i < 45; ++i) {
        const double middle = 0.5 * (lower + upper);
        (residual(middle) > 0.0 ? lower : upper) = middle;
      }
      worst = std::max(worst, std::abs(lower - l[k]));
    }
  }
  EXPECT_LT(worst, 1e-6);
  EXPECT_GT(worst, 1e-7);  // and it makes use of its tolerance
}

TEST(Ceinms, ElasticTorqueDiffersByWhatItsRootToleranceMakesOfIt) {
  BRACHIUM_NEEDS_REFERENCE();
  const ElbowReference ref("equilibriumElastic");
  const double worst =
      largest_difference(ref.moment(ceinms_options(TendonKind::elastic)), ref.torque.at("elbow_flexion"));
  EXPECT_LT(worst, 0.032);
  EXPECT_NEAR(worst, 0.0217, 0.0005);
}

// The table of hill/README.md: one difference at a time against CEINMS' conventions with a tight root.
TEST(Ceinms, EachDifferenceOfOurDefaultsHasItsNumber) {
  BRACHIUM_NEEDS_REFERENCE();
  struct Row {
    const char* difference;
    void (*apply)(MuscleModelOptions&);
    double rigid_N_m, elastic_N_m;  // largest over the trial
  };
  const Row rows[] = {
      {"monotone interpolant", [](MuscleModelOptions& o) { o.curves = Lloyd2003(); }, 0.989, 0.825},
      {"optimal length without coupling", [](MuscleModelOptions& o) { o.optimal_length_coupling = 0.0; },
       6.02, 5.72},
      {"velocity and equilibrium", [](MuscleModelOptions& o) { o.compatibility = Compatibility::none; },
       6.4e-7, 0.0904},
      {"all of them",
       [](MuscleModelOptions& o) {
         o = MuscleModelOptions{{}, o.tendon, {}, {}, 0.0};
       },
       5.84, 5.43},
  };
  const ElbowReference stiff("stiff"), elastic("equilibriumElastic");
  for (const Row& row : rows) {
    for (const auto tendon : {TendonKind::rigid, TendonKind::elastic}) {
      const ElbowReference& ref = tendon == TendonKind::rigid ? stiff : elastic;
      MuscleModelOptions o = ceinms_options(tendon);
      const auto theirs = ref.moment(o);
      row.apply(o);
      const auto ours = ref.moment(o);
      const double stated = tendon == TendonKind::rigid ? row.rigid_N_m : row.elastic_N_m;
      EXPECT_NEAR(largest_difference(ours, theirs), stated, 0.01 * stated)
          << row.difference << ' ' << to_string(tendon);
      if (o.compatibility == Compatibility::none && o.optimal_length_coupling > 0.0) {
        // Only the start differs: CEINMS takes the first fibre at rest, we take the first tendon at rest.
        EXPECT_LT(largest_difference(ours, theirs, 200), 0.0016);
      }
    }
  }
}

}  // namespace
}  // namespace brachium::hill
