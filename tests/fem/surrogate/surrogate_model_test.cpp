// Surrogates as a muscle model.

#include "fem/surrogate/surrogate_model.hpp"

#include "data/limb/static_balance.hpp"
#include "data/model/error.hpp"
#include "fem/surrogate/tensor.hpp"
#include "surrogate_cases.hpp"

namespace brachium::fem::test {
namespace {

OutputValue flexor(double t, double a) {
  return {400.0 - 140.0 * t + 300.0 * a, -140.0, 300.0};
}
OutputValue arm_of(double t, double a) {
  return {0.03 + 0.004 * std::sin(t) + 0.001 * a, 0.004 * std::cos(t), 0.001};
}
OutputValue moment_of(double t, double a) {
  const OutputValue F = flexor(t, a), l = arm_of(t, a);
  return {F.value * l.value, F.dtheta * l.value + F.value * l.dtheta,
          F.dalpha * l.value + F.value * l.dalpha};
}

std::shared_ptr<const Surrogate> surrogate(const std::vector<Truth>& truths,
                                           const std::vector<std::string>& names) {
  SampleGrid grid = sample_grid(equidistant(10.0 * deg, 150.0 * deg, 9), equidistant(0.0, 1.0, 5), truths);
  grid.samples.outputs = names;
  return std::make_shared<Surrogate>(hermite_surrogate(grid));
}

SurrogateModel model() {
  return SurrogateModel(
      "elbow_flexion",
      {{"biceps", surrogate({flexor, arm_of}, {"force_n", "vrla_m"}), "force_n", ArmOutput{"vrla_m", 1.0}},
       {"triceps", surrogate({muscle}, {"force_n"}), "force_n", ArmOfAngle{[](double q) {
          return data::CurveValue{-0.02 - 0.002 * q, -0.002};
        }}},
       {"brachialis", surrogate({flexor, moment_of}, {"force_n", "moment_n_m"}), "force_n",
        MomentOutput{"moment_n_m"}}});
}

const Eigen::VectorXd none, still = Eigen::VectorXd::Zero(1);

TEST(SurrogateModel, SumsMomentsAndSaysWhatItIs) {
  const SurrogateModel m = model();
  EXPECT_EQ(m.traits().rung, "fem.surrogate");
  EXPECT_EQ(m.traits().state_size, 0u);
  EXPECT_TRUE(m.traits().gives_error_bound);
  limb::Evaluation e;
  const double q = 1.2;
  m.evaluate(Eigen::VectorXd::Constant(1, q), still, Eigen::Vector3d(0.3, 0.6, 0.9), none, e);
  const double expected =
      moment_of(q, 0.3).value - (0.02 + 0.002 * q) * muscle(q, 0.6).value + moment_of(q, 0.9).value;
  EXPECT_NEAR(e.moment(0), expected, 1e-3);
  EXPECT_NEAR(e.moment(0), (e.moment_arm * e.force)(0), 1e-12);
  EXPECT_GT(e.error_bound(0), 0.0);
}

double mismatch(double wrong) {
  const SurrogateModel m = model();
  limb::Evaluation at, low, high;
  double most = 0.0;
  for (double q : {0.4, 1.1, 2.3}) {
    const Eigen::VectorXd angle = Eigen::VectorXd::Constant(1, q);
    Eigen::VectorXd a = Eigen::Vector3d(0.3, 0.6, 0.9);
    m.evaluate(angle, still, a, none, at);
    const double h = 1e-5;
    m.evaluate(angle.array() - h, still, a, none, low), m.evaluate(angle.array() + h, still, a, none, high);
    most =
        std::max(most, std::abs(wrong * at.dmoment_dq(0, 0) - (high.moment(0) - low.moment(0)) / (2.0 * h)));
    for (int i = 0; i < 3; ++i) {
      Eigen::VectorXd less = a, more = a;
      less(i) -= h, more(i) += h;
      m.evaluate(angle, still, less, none, low), m.evaluate(angle, still, more, none, high);
      most = std::max(most, std::abs(wrong * at.dmoment_dactivation(0, i) -
                                     (high.moment(0) - low.moment(0)) / (2.0 * h)));
    }
  }
  return most;
}

TEST(SurrogateModel, DerivativesAreThoseOfItsMomentAndAWrongOneIsFound) {
  EXPECT_LT(mismatch(1.0), 1e-6);
  EXPECT_GT(mismatch(1.001), 5e-3);
}

TEST(SurrogateModel, BalancesLikeAnyOtherModel) {
  const SurrogateModel m(
      "elbow_flexion",
      {{"biceps", surrogate({flexor, arm_of}, {"force_n", "vrla_m"}), "force_n", ArmOutput{"vrla_m", 1.0}},
       {"triceps", surrogate({muscle}, {"force_n"}), "force_n", ArmOfAngle{[](double) {
          return data::CurveValue{-0.021, 0.0};
        }}}});
  const limb::Balance b = limb::static_balance(m, Eigen::Vector2d(0.2, 0.4), {}, Eigen::VectorXd::Ones(1),
                                               m.angles().lower, m.angles().upper);
  ASSERT_EQ(b.equilibria.size(), 1u);
  EXPECT_TRUE(b.equilibria[0].stable);
  const double q = b.equilibria[0].angle_rad;
  EXPECT_NEAR(moment_of(q, 0.2).value, 0.021 * muscle(q, 0.4).value, 1e-3);
}

TEST(SurrogateModel, NamesTheMuscleThatLeavesItsStates) {
  limb::Evaluation e;
  try {
    model().evaluate(Eigen::VectorXd::Constant(1, 1.0), still, Eigen::Vector3d(0.3, 1.2, 0.9), none, e);
    FAIL();
  } catch (const data::InputError& error) {
    EXPECT_EQ(error.diagnostics().front().code, "outside-surrogate");
    EXPECT_NE(error.diagnostics().front().message.find("`triceps`"), std::string::npos);
  }
  EXPECT_THROW(model().evaluate(Eigen::VectorXd::Ones(1), still, Eigen::Vector2d(0.3, 0.2), none, e),
               data::InputError);
  EXPECT_THROW(SurrogateModel("q", {}), data::InputError);
  EXPECT_THROW(SurrogateModel("q", {{"a", surrogate({muscle}, {"F"}), "force_n", MomentOutput{"F"}}}),
               data::InputError);
}

}  // namespace
}  // namespace brachium::fem::test
