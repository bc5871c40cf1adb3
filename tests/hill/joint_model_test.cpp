#include "hill/joint_model.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "data/model/error.hpp"
#include "hill/forward.hpp"
#include "tests/hill/finite_difference.hpp"
#include "tests/hill/swing.hpp"

namespace brachium::hill {
namespace {

data::Coordinate elbow() {
  data::Coordinate c;
  c.name = "elbow";
  c.lower_rad = 0.0;
  c.upper_rad = 2.4;
  return c;
}

limb::MusclePath path(const std::string& muscle, std::vector<double> length) {
  data::PathGeometry g;
  g.kind = data::PathGeometry::Kind::polynomial;
  g.coordinate = "elbow";
  g.length_m = std::move(length);
  return limb::MusclePath(muscle, g, elbow());
}

data::MuscleParameters brachialis() {
  data::MuscleParameters p;
  p.max_isometric_force_N = 987.26;
  p.optimal_fibre_length_m = 0.0858;
  p.tendon_slack_length_m = 0.0535;
  return p;
}

JointModel model(const std::string& set, TendonKind tendon) {
  MuscleModelOptions o;
  o.curves = CurveSet::named(set);
  o.tendon = tendon;
  o.optimal_length_coupling = 0.15;
  if (tendon == TendonKind::elastic) o.velocity = FibreVelocity::none;
  return JointModel("elbow",
                    {{MuscleTendon("TRI", tests::triceps(), o), path("TRI", {0.18, 0.021, 0.0015})},
                     {MuscleTendon("BRA", brachialis(), o), path("BRA", {0.156, -0.013, -0.006, 0.0013})}});
}

struct Question {
  Eigen::VectorXd q{1}, qdot{1}, a{2}, state{0};
};
Question question(double q, double qdot, double a0, double a1) {
  Question x;
  x.q << q;
  x.qdot << qdot;
  x.a << a0, a1;
  return x;
}
double moment(const JointModel& m, const Question& x) {
  limb::Evaluation out;
  m.evaluate(x.q, x.qdot, x.a, x.state, out);
  return out.moment[0];
}

class JointModelOfEverySet : public ::testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(Hill, JointModelOfEverySet, ::testing::ValuesIn(CurveSet::names()),
                         [](const auto& set) { return set.param; });

TEST_P(JointModelOfEverySet, GivesTheNumbersOfTheBatchChain) {
  for (const auto tendon : {TendonKind::rigid, TendonKind::elastic}) {
    const JointModel m = model(GetParam(), tendon);
    EXPECT_EQ(m.traits().rung, tendon == TendonKind::rigid ? "hill.rigid" : "hill.elastic");
    const std::size_t n = 40;
    std::vector<double> q(n), qdot(n), a(n, 0.35);
    for (std::size_t k = 0; k < n; ++k) {
      q[k] = 0.3 + 0.045 * static_cast<double>(k);
      qdot[k] = tendon == TendonKind::rigid ? 1.5 * std::sin(0.2 * static_cast<double>(k)) : 0.0;
    }
    MuscleModelOptions o;
    o.curves = CurveSet::named(GetParam());
    o.tendon = tendon;
    o.optimal_length_coupling = 0.15;
    if (tendon == TendonKind::elastic) o.velocity = FibreVelocity::none;
    std::vector<double> L(n), r(n), v(n);
    const limb::MusclePath bra = path("BRA", {0.156, -0.013, -0.006, 0.0013});
    bra.evaluate(q, qdot, L, r, v);
    MuscleScratch scratch;
    MuscleTrace trace;
    forward(MuscleTendon("BRA", brachialis(), o), {100.0, L, v, r}, a, scratch, trace);
    for (std::size_t k = 0; k < n; ++k) {
      const Question x = question(q[k], qdot[k], 0.1, 0.35);
      limb::Evaluation out;
      m.evaluate(x.q, x.qdot, x.a, x.state, out);
      EXPECT_NEAR(out.force[1], trace.force_N[k], 1e-9 * 987.26);
      EXPECT_NEAR(out.moment_arm(0, 1), r[k], 1e-15);
      EXPECT_NEAR(out.moment[0], out.moment_arm(0, 0) * out.force[0] + trace.moment_N_m[k], 1e-8);
    }
  }
}

TEST_P(JointModelOfEverySet, GivesExactDerivatives) {
  for (const auto tendon : {TendonKind::rigid, TendonKind::elastic}) {
    const JointModel m = model(GetParam(), tendon);
    for (const double q : {0.4137, 1.1317, 1.8253}) {
      const Question x = question(q, tendon == TendonKind::rigid ? 0.7 : 0.0, 0.313, 0.427);
      limb::Evaluation out;
      m.evaluate(x.q, x.qdot, x.a, x.state, out);
      const double by_q = tests::slope_of(
          [&](double t) { return moment(m, question(t, x.qdot[0], x.a[0], x.a[1])); }, q, 1e-5);
      const double by_tri = tests::slope_of(
          [&](double t) { return moment(m, question(q, x.qdot[0], t, x.a[1])); }, x.a[0], 1e-5);
      const double by_bra = tests::slope_of(
          [&](double t) { return moment(m, question(q, x.qdot[0], x.a[0], t)); }, x.a[1], 1e-5);
      EXPECT_NEAR(out.dmoment_dq(0, 0), by_q, 2e-6 * (1.0 + std::abs(by_q))) << q;
      EXPECT_NEAR(out.dmoment_dactivation(0, 0), by_tri, 2e-6 * (1.0 + std::abs(by_tri))) << q;
      EXPECT_NEAR(out.dmoment_dactivation(0, 1), by_bra, 2e-6 * (1.0 + std::abs(by_bra))) << q;
      // The wrong twin: moment arm held constant.
      const double frozen = out.dmoment_dq(0, 0) * 1.001;
      EXPECT_GT(std::abs(frozen - by_q), 5e-4 * std::abs(by_q));
    }
  }
}

TEST(JointModel, AtZeroActivationTheForceStillRisesWithIt) {
  const JointModel m = model("lloyd_2003", TendonKind::elastic);
  limb::Evaluation out;
  const Question x = question(1.6, 0.0, 0.0, 0.0);  // both fibres are short: no passive force in BRA
  m.evaluate(x.q, x.qdot, x.a, x.state, out);
  EXPECT_EQ(out.force[1], 0.0);
  const double slope =
      (moment(m, question(1.6, 0.0, 0.0, 1e-7)) - moment(m, question(1.6, 0.0, 0.0, 0.0))) / 1e-7;
  EXPECT_NEAR(out.dmoment_dactivation(0, 1), slope, 2e-2 * std::abs(slope));
}

void expect_message(const JointModel& m, const Question& x, const std::string& message) {
  try {
    moment(m, x);
    FAIL() << message;
  } catch (const data::InputError& e) {
    EXPECT_EQ(e.diagnostics()[0].message, message);
  }
}

TEST(JointModel, WrongQuestionsAreNamed) {
  const JointModel m = model("lloyd_2003", TendonKind::rigid);
  expect_message(m, question(1.0, 0.0, 0.1, 1.01), "the activation of muscle `BRA` is 1.01");
  expect_message(m, question(1.0, std::nan(""), 0.1, 0.1), "the velocity of `elbow` is nan");
  Question x = question(1.0, 0.0, 0.1, 0.1);
  x.a.resize(1);
  expect_message(m, x, "`activation` has 1 entries, the model 2");
  EXPECT_THROW(moment(m, question(2.5, 0.0, 0.1, 0.1)), data::InputError);
}

TEST(JointModel, MistakesOfTheSetAreAllNamed) {
  MuscleModelOptions rigid, elastic;
  elastic.tendon = TendonKind::elastic;
  elastic.compatibility = Compatibility::ceinms;
  try {
    JointModel("wrist", {{MuscleTendon("BRA", brachialis(), rigid), path("BRA", {0.156, -0.013})},
                         {MuscleTendon("BRA", brachialis(), elastic), path("BRA", {0.156, -0.013})}});
    FAIL();
  } catch (const data::InputError& e) {
    std::vector<std::string> codes;
    for (const auto& d : e.diagnostics()) codes.push_back(d.code);
    EXPECT_THAT(codes, ::testing::ElementsAre("wrong-coordinate", "duplicate-muscle", "wrong-coordinate",
                                              "mixed-tendons", "no-joint-compatibility"));
  }
}

}  // namespace
}  // namespace brachium::hill
