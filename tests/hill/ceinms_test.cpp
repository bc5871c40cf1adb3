/// The elbow that CEINMS computed, with CEINMS' conventions and with ours. The reference folder's README tells the
/// conventions and its own re-implementation's deviations.

#include <gtest/gtest.h>

#include <cmath>

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

TEST(Ceinms, ElasticTorqueDiffersByItsRootToleranceOnly) {
  BRACHIUM_NEEDS_REFERENCE();
  const ElbowReference ref("equilibriumElastic");
  MuscleScratch scratch;
  MuscleTrace out;
  double fibre = 0.0;
  for (const auto& m : tests::elbow_muscles()) {
    const MuscleTendon muscle(m.name, m.parameters, ceinms_options(TendonKind::elastic));
    forward(muscle, {ElbowReference::kRate, ref.length.at(m.name), {}, {}}, ref.activation.at(m.name), scratch, out);
    fibre = std::max(fibre, largest_difference(out.fibre_length_m, ref.fibre.at(m.name)));
    std::printf("%s %g\n", m.name.c_str(), largest_difference(out.fibre_length_m, ref.fibre.at(m.name)));
  }
  // Brent's method stops within 1e-6 m of the root.
  EXPECT_LT(fibre, 1e-6);
  const auto moment = ref.moment(ceinms_options(TendonKind::elastic));
  const double worst = largest_difference(moment, ref.torque.at("elbow_flexion"));
  std::printf("worst %g\n", worst);
  EXPECT_LT(worst, 0.033);
}

TEST(Ceinms, Variants) {
  BRACHIUM_NEEDS_REFERENCE();
  const ElbowReference ref("equilibriumElastic");
  for (const std::string& set : CurveSet::names()) {
    for (auto tendon : {TendonKind::rigid, TendonKind::elastic}) {
      for (auto v : {FibreVelocity::zero_lag, FibreVelocity::causal, FibreVelocity::none}) {
        MuscleModelOptions o;
        o.curves = CurveSet::named(set);
        o.tendon = tendon;
        o.velocity = v;
        const auto moment = ref.moment(o);
        std::printf("%s %s %s %g\n", set.c_str(), to_string(tendon).c_str(), to_string(v).c_str(), largest_difference(moment, ref.torque.at("elbow_flexion")));
      }
    }
  }
}

}  // namespace
}  // namespace brachium::hill
