// Surrogates on full grids.

#include "fem/surrogate/tensor.hpp"

#include "data/model/error.hpp"
#include "surrogate_cases.hpp"

namespace brachium::fem::test {
namespace {

std::vector<double> angles(std::size_t n) {
  return equidistant(10.0 * deg, 150.0 * deg, n);
}
std::vector<double> activations(std::size_t n) {
  return equidistant(0.0, 1.0, n);
}

double order(double coarse, double fine) {
  return std::log2(coarse / fine);
}

TEST(TensorSpline, ReproducesPolynomialsOfItsDegreeInEachVariable) {
  const std::vector<double> theta{0.2, 0.5, 0.9, 1.5, 1.6, 2.2, 2.6}, alpha{0.0, 0.1, 0.4, 0.6, 0.9, 1.0};
  for (const auto& [t, a, p] : {std::tuple(ThetaCurve::linear, AlphaCurve::linear, 1),
                                std::tuple(ThetaCurve::cubic, AlphaCurve::cubic, 3),
                                std::tuple(ThetaCurve::quintic, AlphaCurve::quintic, 5)}) {
    const Polynomial truth(p, p);
    const Differences d = differences(tensor_spline(sample_grid(theta, alpha, {truth}), {t, a}), truth);
    EXPECT_LT(d.value, 1e-10) << p;
    EXPECT_LT(d.dtheta, 1e-9) << p;
    EXPECT_LT(d.dalpha, 1e-9) << p;
  }
}

TEST(TensorSpline, ConvergesWithItsOrderPlusOne) {
  for (const auto& [t, a, p] : {std::tuple(ThetaCurve::cubic, AlphaCurve::cubic, 3),
                                std::tuple(ThetaCurve::quintic, AlphaCurve::quintic, 5)}) {
    const auto error = [&](std::size_t n) {
      return differences(tensor_spline(sample_grid(angles(n), activations(n), {muscle}), {t, a, false}),
                         muscle)
          .value;
    };
    EXPECT_GT(order(error(17), error(33)), p + 1 - 0.4) << p;
  }
}

TEST(TensorSpline, IsTwiceDifferentiableAcrossMeshLines) {
  const auto theta = angles(9);
  const Surrogate s = tensor_spline(sample_grid(theta, activations(5), {muscle}));
  std::vector<OutputValue> l(1), r(1), c(1);
  const double h = 1e-5;
  for (std::size_t i = 1; i + 1 < theta.size(); ++i) {
    s.evaluate(theta[i] - h, 0.4, l), s.evaluate(theta[i], 0.4, c), s.evaluate(theta[i] + h, 0.4, r);
    EXPECT_NEAR(r[0].dtheta - c[0].dtheta, c[0].dtheta - l[0].dtheta, 1e-5);
  }
}

TEST(TensorSpline, MonotoneInTheAngleDoesNotOvershoot) {
  const Truth step = [](double t, double a) {
    return OutputValue{(t < 1.3 ? 0.0 : 1.0) * (0.5 + a), 0.0, 0.0};
  };
  const Surrogate s =
      tensor_spline(sample_grid(angles(8), {0.0, 1.0}, {step}), {ThetaCurve::monotone, AlphaCurve::linear});
  std::vector<OutputValue> out(1);
  for (const double t : angles(301)) {
    s.evaluate(t, 0.5, out);
    EXPECT_GE(out[0].value, -1e-15);
    EXPECT_LE(out[0].value, 1.0 + 1e-15);
    EXPECT_GE(out[0].dtheta, -1e-12);
  }
}

TEST(Hermite, ReproducesPolynomialsOfItsDegreeInEachVariable) {
  const std::vector<double> theta{0.2, 0.5, 0.9, 1.5, 1.6, 2.2, 2.6}, alpha{0.0, 0.1, 0.4, 0.6, 0.9, 1.0};
  for (const auto& [degree, p] : {std::pair(HermiteDegree::cubic, 3), std::pair(HermiteDegree::quintic, 5)}) {
    const Polynomial truth(p, p);
    const Differences d = differences(hermite_surrogate(sample_grid(theta, alpha, {truth}), {degree}), truth);
    EXPECT_LT(d.value, 1e-10) << p;
    EXPECT_LT(d.dtheta, 1e-9) << p;
    EXPECT_LT(d.dalpha, 1e-9) << p;
  }
}

TEST(Hermite, MeetsValuesAndBothDerivativesAtTheStates) {
  const SampleGrid grid = sample_grid(angles(6), activations(4), {muscle});
  for (const HermiteDegree degree : {HermiteDegree::cubic, HermiteDegree::quintic}) {
    const Surrogate s = hermite_surrogate(grid, {degree});
    std::vector<OutputValue> out(1);
    for (const Sample& x : grid.samples.samples) {
      s.evaluate(x.at.theta_rad, x.at.activation, out);
      EXPECT_NEAR(out[0].value, x.value(0), 1e-9);
      EXPECT_NEAR(out[0].dtheta, x.dtheta(0), 1e-8);
      EXPECT_NEAR(out[0].dalpha, x.dalpha(0), 1e-8);
    }
  }
}

TEST(Hermite, ConvergesWithTheFourthAndTheSixthOrder) {
  for (const auto& [degree, p] :
       {std::pair(HermiteDegree::cubic, 4.0), std::pair(HermiteDegree::quintic, 6.0)}) {
    const auto error = [&](std::size_t n) {
      return differences(hermite_surrogate(sample_grid(angles(n), activations(n), {muscle}), {degree, false}),
                         muscle)
          .value;
    };
    EXPECT_GT(order(error(25), error(49)), p - 0.4);
  }
}

TEST(Hermite, FromFewerStatesIsBetterThanASplineWithoutDerivatives) {
  const double hermite =
      differences(hermite_surrogate(sample_grid(angles(7), activations(4), {muscle})), muscle).value;
  const double spline =
      differences(tensor_spline(sample_grid(angles(9), activations(5), {muscle})), muscle).value;
  EXPECT_LT(hermite, 0.5 * spline);
}

TEST(Hermite, RefusesStatesWithoutDerivatives) {
  SampleGrid grid = sample_grid(angles(4), activations(3), {muscle});
  grid.samples.samples[5].dalpha.resize(0);
  EXPECT_THROW(hermite_surrogate(grid), data::InputError);
}

TEST(Surrogates, DerivativesAreThoseOfTheirValuesAndAWrongOneIsFound) {
  const SampleGrid grid = sample_grid(angles(7), activations(5), {muscle, Polynomial(2, 2)});
  for (const Surrogate& s :
       {tensor_spline(grid), tensor_spline(grid, {ThetaCurve::monotone, AlphaCurve::linear}),
        hermite_surrogate(grid), hermite_surrogate(grid, {HermiteDegree::cubic})}) {
    EXPECT_LT(derivative_mismatch(s), 2e-6) << s.method();
    EXPECT_GT(derivative_mismatch(s, 1.001), 5e-4) << s.method();
  }
}

TEST(Surrogates, GiveSeveralOutputsAtOnceAsEachAlone) {
  std::vector<Truth> truths;
  for (int k = 0; k < 6; ++k)
    truths.push_back([k](double t, double a) {
      return OutputValue{std::sin(t + k) + k * a * a, std::cos(t + k), 2.0 * k * a};
    });
  const auto theta = angles(6), alpha = activations(4);
  const Surrogate all = hermite_surrogate(sample_grid(theta, alpha, truths));
  std::vector<OutputValue> six(6), one(1);
  for (std::size_t k = 0; k < 6; ++k) {
    const Surrogate alone = hermite_surrogate(sample_grid(theta, alpha, {truths[k]}));
    all.evaluate(1.1, 0.37, six);
    alone.evaluate(1.1, 0.37, one);
    EXPECT_DOUBLE_EQ(six[k].value, one[0].value);
    EXPECT_DOUBLE_EQ(six[k].dtheta, one[0].dtheta);
    EXPECT_DOUBLE_EQ(six[k].dalpha, one[0].dalpha);
  }
}

TEST(Surrogates, RefuseStatesOutsideTheirBounds) {
  const Surrogate s = tensor_spline(sample_grid(angles(5), {0.1, 0.5, 0.9}, {muscle}));
  std::vector<OutputValue> out(1);
  EXPECT_NO_THROW(s.evaluate(150.0 * deg * (1.0 + 1e-15), 0.5, out));
  const double nan = std::nan("");
  for (const auto& [t, a] :
       {std::pair(9.9 * deg, 0.5), {150.1 * deg, 0.5}, {1.0, 0.05}, {1.0, 0.95}, {nan, 0.5}, {1.0, nan}}) {
    EXPECT_THROW(s.evaluate(t, a, out), data::InputError);
  }
  try {
    const std::vector<double> theta{1.0, 1.0, 3.0}, alpha{0.2, 0.3, 0.4};
    s.evaluate_series(theta, alpha);
    FAIL();
  } catch (const data::InputError& e) {
    EXPECT_EQ(e.diagnostics().front().code, "outside-surrogate");
    EXPECT_NE(e.diagnostics().front().message.find("sample 2"), std::string::npos);
  }
}

TEST(Surrogates, AlongASeriesGiveWhatTheyGiveOneByOne) {
  const Surrogate s = hermite_surrogate(sample_grid(angles(5), activations(3), {muscle, Polynomial(2, 1)}));
  std::vector<double> theta, alpha;
  for (int i = 0; i < 100; ++i)
    theta.push_back((80.0 + 60.0 * std::sin(0.1 * i)) * deg), alpha.push_back(0.5 + 0.5 * std::cos(0.3 * i));
  const Surrogate::Series series = s.evaluate_series(theta, alpha);
  std::vector<OutputValue> out(2);
  for (std::size_t i = 0; i < theta.size(); ++i) {
    s.evaluate(theta[i], alpha[i], out);
    for (std::size_t o = 0; o < 2; ++o) {
      EXPECT_EQ(series.value(static_cast<Eigen::Index>(o), static_cast<Eigen::Index>(i)), out[o].value);
      EXPECT_EQ(series.dtheta(static_cast<Eigen::Index>(o), static_cast<Eigen::Index>(i)), out[o].dtheta);
      EXPECT_EQ(series.dalpha(static_cast<Eigen::Index>(o), static_cast<Eigen::Index>(i)), out[o].dalpha);
    }
  }
}

TEST(PatchKernels, AgreeToTheLastDigits) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> u(-1.0, 1.0);
  for (int q = 1; q <= 5; ++q) {
    std::vector<double> c(static_cast<std::size_t>(6 * (q + 1) * 8));
    for (double& x : c) x = u(random);
    OutputValue a[5], b[5];
    choose_patch_kernel(false)(c.data(), 5, q, 5, 0.3, 0.8, 2.0, 3.0, a);
    choose_patch_kernel(true)(c.data(), 5, q, 5, 0.3, 0.8, 2.0, 3.0, b);
    for (int o = 0; o < 5; ++o) {
      EXPECT_NEAR(a[o].value, b[o].value, 1e-14);
      EXPECT_NEAR(a[o].dtheta, b[o].dtheta, 1e-13);
      EXPECT_NEAR(a[o].dalpha, b[o].dalpha, 1e-13);
    }
  }
}

TEST(LeaveOutError, IsAboveTheTrueErrorAndNoMoreThanItsOrderAbove) {
  for (const bool hermite : {false, true}) {
    const SampleGrid grid = sample_grid(angles(13), activations(7), {muscle});
    const Surrogate s = hermite ? hermite_surrogate(grid, {HermiteDegree::cubic}) : tensor_spline(grid);
    ASSERT_TRUE(s.error().has_value());
    const LeaveOutError& e = *s.error();
    EXPECT_EQ(e.left_out, 11u * 7u + 5u * 13u);
    EXPECT_EQ(e.order, 4);
    const double truth = differences(s, muscle).value;
    EXPECT_GT(e.outputs[0].greatest, truth);
    EXPECT_LT(e.outputs[0].greatest, 100.0 * truth);
  }
}

TEST(LeaveOutError, VanishesForWhatTheSurrogateReproduces) {
  const Surrogate s = tensor_spline(sample_grid(angles(8), activations(6), {Polynomial(3, 3)}));
  EXPECT_LT(s.error()->outputs[0].greatest, 1e-11);
}

TEST(SampleGrids, NameTheStateThatIsMissing) {
  SampleSet set = sample(grid_states({0.2, 0.4}, {0.0, 0.5, 1.0}), {muscle});
  std::swap(set.samples[0], set.samples[4]);
  EXPECT_EQ(as_grid(set).samples.samples[0].at.theta_rad, 0.2);
  set.samples.erase(set.samples.begin() + 1);
  try {
    as_grid(set);
    FAIL();
  } catch (const data::InputError& e) {
    EXPECT_EQ(e.diagnostics().front().code, "not-a-grid");
    EXPECT_NE(e.diagnostics().front().message.find("(0.2 rad, 0.5)"), std::string::npos);
  }
}

// Outputs whose derivatives are known keep them; the others get those of a spline, which is exact for
// polynomials.
TEST(WithSplineSlopes, KeepsWhatIsKnownAndFindsTheRest) {
  SampleSet values{{"known", "rest"}, {}}, known{{"known"}, {}};
  for (const StatePoint& p : grid_states(equidistant(0.2, 2.4, 7), equidistant(0.0, 1.0, 4))) {
    const double t = p.theta_rad, a = p.activation;
    values.samples.push_back({p, Eigen::Vector2d(std::sin(t) * a, t * t * t * a * a)});
    known.samples.push_back({p, Eigen::VectorXd::Constant(1, std::sin(t) * a),
                             Eigen::VectorXd::Constant(1, 7.0), Eigen::VectorXd::Constant(1, -3.0)});
  }
  const SampleSet all = with_spline_slopes(values, known);
  ASSERT_TRUE(all.has_derivatives());
  for (const Sample& s : all.samples) {
    const double t = s.at.theta_rad, a = s.at.activation;
    EXPECT_EQ(s.dtheta(0), 7.0);
    EXPECT_EQ(s.dalpha(0), -3.0);
    EXPECT_NEAR(s.dtheta(1), 3.0 * t * t * a * a, 1e-10);
    EXPECT_NEAR(s.dalpha(1), 2.0 * t * t * t * a, 1e-10);
  }
  for (Sample& s : known.samples) s.dtheta.resize(0);
  EXPECT_THROW(with_spline_slopes(values, known), data::InputError);
}

}  // namespace
}  // namespace brachium::fem::test
