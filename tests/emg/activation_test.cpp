#include "emg/activation.hpp"

#include <functional>
#include <numbers>

#include "emg/second_order.hpp"
#include "tests/emg/support.hpp"

namespace brachium::emg {
namespace {

using data::ActivationParameters;
using std::numbers::pi;
using tests::input_error;

std::vector<double> excitation(std::size_t n, double rate, double frequency = 3.0) {
  std::vector<double> e(n);
  for (std::size_t k = 0; k < n; ++k) {
    const double t = static_cast<double>(k) / rate;
    e[k] = 0.4 - 0.3 * std::cos(2 * pi * frequency * t) + 0.1 * std::sin(2 * pi * 1.7 * t);
  }
  return e;
}

ActivationModel model_of(ActivationForm form, Nonlinearity nonlinearity = Nonlinearity::none,
                         StartUp start_up = StartUp::steady_state) {
  return {form, nonlinearity, start_up};
}

std::vector<double> run(const ActivationModel& model, const ActivationParameters& p,
                        const std::vector<double>& e, double rate, double gain = 1.0) {
  std::vector<double> a(e.size());
  activate(model, p, e, rate, a, gain);
  return a;
}

const ActivationModel continuous = model_of(ActivationForm::continuous);

// Step response of two lags from rest, e = 1 from t = 0 on (first-order hold: from the first sample on).
double step_response(double t, double tau1, double tau2) {
  if (tau1 == tau2) return 1.0 - (1.0 + t / tau1) * std::exp(-t / tau1);
  return 1.0 - (tau1 * std::exp(-t / tau1) - tau2 * std::exp(-t / tau2)) / (tau1 - tau2);
}

TEST(Continuous, EqualsTheClosedFormStepResponseAtEverySubSampleDelay) {
  const double rate = 200.0;
  const std::vector<double> e(200, 1.0);
  for (const double delay : {0.0, 0.0013, 0.005, 0.0399, 0.040, 0.0421}) {
    for (const auto& [tau1, tau2] : {std::pair{0.010, 0.040}, std::pair{0.02, 0.02},
                                     std::pair{0.02, 0.02 * (1 + 1e-9)}, std::pair{0.0005, 0.1}}) {
      const std::vector<double> u =
          run(model_of(ActivationForm::continuous, Nonlinearity::none, StartUp::rest),
              {delay, tau1, tau2, 0.0}, e, rate);
      for (std::size_t k = 0; k < u.size(); ++k) {
        const double t = static_cast<double>(k) / rate - delay;
        const double tolerance =
            tau1 != tau2 && std::abs(tau1 - tau2) < 1e-6 ? 1e-6 : 1e-13;  // of the closed form
        ASSERT_NEAR(u[k], t <= 0.0 ? 0.0 : step_response(t, tau1, tau2), tolerance)
            << delay << " " << tau1 << " " << k;
      }
    }
  }
}

TEST(Continuous, StepSettlesAtTheExcitation) {
  const std::vector<double> e(2000, 0.7);
  for (const auto form : {ActivationForm::continuous, ActivationForm::recursive}) {
    const std::vector<double> u =
        run(model_of(form, Nonlinearity::none, StartUp::rest), {0.01, 0.01, 0.04, 0.0}, e, 500.0);
    EXPECT_NEAR(u.back(), 0.7, 1e-12);
    const std::vector<double> settled = run(model_of(form), {0.01, 0.01, 0.04, 0.0}, e, 500.0);
    for (const double x : settled) ASSERT_NEAR(x, 0.7, 1e-12);
  }
  EXPECT_NEAR(run(model_of(ActivationForm::first_order, Nonlinearity::none, StartUp::rest),
                  {0.01, 0.01, 0.04, 0.0}, e, 500.0)
                  .back(),
              0.7, 1e-12);
}

TEST(Continuous, ResultsAt500And1000And2000HertzAgreeWithin1eMinus3ForA3HertzExcitation) {
  const ActivationParameters p{0.0133, 0.010, 0.040, 0.0};
  const std::vector<double> at500 = run(continuous, p, excitation(1000, 500.0), 500.0);
  const std::vector<double> at1000 = run(continuous, p, excitation(2000, 1000.0), 1000.0);
  const std::vector<double> at2000 = run(continuous, p, excitation(4000, 2000.0), 2000.0);
  for (std::size_t k = 0; k < at500.size(); ++k) {
    ASSERT_NEAR(at500[k], at2000[4 * k], 1e-3);
    ASSERT_NEAR(at1000[2 * k], at2000[4 * k], 1e-3);
    ASSERT_NEAR(at500[k], at2000[4 * k], 2e-4);  // what is reached
  }
}

TEST(Recursive, LeadsTheContinuousModelByOneSampleSoThatItsRateMattersUnlessItsDelayIsLengthened) {
  const auto difference = [](double extra_samples) {
    double worst = 0.0;
    std::vector<std::vector<double>> u;
    for (const double rate : {500.0, 2000.0}) {
      const ActivationParameters p{0.02 + extra_samples / rate, 0.010, 0.040, 0.0};
      u.push_back(run(model_of(ActivationForm::recursive), p,
                      excitation(static_cast<std::size_t>(2 * rate), rate), rate));
    }
    for (std::size_t k = 100; k < u[0].size(); ++k) worst = std::max(worst, std::abs(u[0][k] - u[1][4 * k]));
    return worst;
  };
  EXPECT_GT(difference(0.0), 0.005);  // theory: 0.011 for a full-range excitation
  EXPECT_LT(difference(1.0), 3e-4);

  const double rate = 1000.0;
  const std::vector<double> e = excitation(2000, rate);
  const std::vector<double> reference =
      run(continuous, {equivalent_continuous_delay(0.03, rate), 0.010, 0.040, 0.0}, e, rate);
  const std::vector<double> u = run(model_of(ActivationForm::recursive), {0.03, 0.010, 0.040, 0.0}, e, rate);
  for (std::size_t k = 100; k < u.size(); ++k) ASSERT_NEAR(u[k], reference[k], 3e-4);
}

TEST(Continuous, DoesNotChangeWhenTheTimeConstantsSwap) {
  const std::vector<double> e = excitation(500, 500.0);
  const std::vector<double> one = run(continuous, {0.011, 0.010, 0.040, 0.0}, e, 500.0);
  const std::vector<double> other = run(continuous, {0.011, 0.040, 0.010, 0.0}, e, 500.0);
  for (std::size_t k = 0; k < one.size(); ++k) ASSERT_NEAR(one[k], other[k], 1e-14);
}

TEST(Continuous, EqualsTheSameEquationInsideASolver) {
  // Classical Runge-Kutta with 20 steps a sample on neural_state_rate.
  const double rate = 200.0, h = 1.0 / rate / 20;
  const ActivationParameters p{0.0, 0.015, 0.035, 0.0};
  const std::vector<double> e = excitation(200, rate);
  const std::vector<double> u = run(continuous, p, e, rate);
  std::array<double, 2> x{e[0], e[0]};
  for (std::size_t k = 0; k + 1 < e.size(); ++k) {
    for (int i = 0; i < 20; ++i) {
      const auto at = [&](double s) { return e[k] + (e[k + 1] - e[k]) * s / 20; };
      const auto go = [](const std::array<double, 2>& y, double w, const std::array<double, 2>& f) {
        return std::array<double, 2>{y[0] + w * f[0], y[1] + w * f[1]};
      };
      const auto k1 = neural_state_rate(p, at(i), x);
      const auto k2 = neural_state_rate(p, at(i + 0.5), go(x, h / 2, k1));
      const auto k3 = neural_state_rate(p, at(i + 0.5), go(x, h / 2, k2));
      const auto k4 = neural_state_rate(p, at(i + 1), go(x, h, k3));
      x = go(go(go(go(x, h / 6, k1), h / 3, k2), h / 3, k3), h / 6, k4);
    }
    ASSERT_NEAR(x[1], u[k + 1], 1e-9);
  }
}

TEST(SecondOrderStep, IsExactForFarApartCloseAndEqualTimeConstants) {
  // Two half steps equal one whole step; unit gain; e linear.
  for (const auto& [tau1, tau2] : {std::pair{0.02, 0.02}, std::pair{0.02, 0.02 + 1e-12}, std::pair{1e-5, 0.1},
                                   std::pair{0.1, 1e-5}, std::pair{10.0, 1e-4}}) {
    const SecondOrderStep whole = second_order_step(tau1, tau2, 0.005),
                          half = second_order_step(tau1, tau2, 0.0025);
    const std::array<double, 4> x{0.3, 0.1, 0.2, 0.25};
    const auto once = whole(x, 0.4, 0.2);
    const auto twice = half(half(x, 0.4, 0.1), 0.5, 0.1);
    for (std::size_t i = 0; i < 4; ++i) EXPECT_NEAR(once[i], twice[i], 1e-13);
    for (const double y : whole({0.6, 0.6, 0.6, 0.6}, 0.6, 0.0)) EXPECT_NEAR(y, 0.6, 1e-13);
  }
}

// ------------------------------------------------------------------ CEINMS

std::vector<std::vector<double>> sto_columns(const std::filesystem::path& file,
                                             std::vector<std::string>& names) {
  std::ifstream in(file);
  std::string line;
  while (std::getline(in, line) && line.rfind("endheader", 0) != 0) {
  }
  std::getline(in, line);
  std::istringstream header(line);
  for (std::string name; header >> name;) names.push_back(name);
  std::vector<std::vector<double>> columns(names.size());
  while (std::getline(in, line)) {
    std::istringstream row(line);
    double value = 0.0;
    for (std::size_t c = 0; row >> value; ++c) columns.at(c).push_back(value);
  }
  return columns;
}

TEST(Recursive, WithCeinmsStartUpEqualsCeinmsActivationsToRounding) {
  BRACHIUM_NEEDS_REFERENCE();
  std::vector<std::string> muscles, channels;
  const auto dir = tests::reference_dir() / "ceinms_elbow";
  const auto activations = sto_columns(dir / "outputs/stiff_offline/Activations.sto", muscles);
  const auto emg = sto_columns(dir / "trial/emg.sto", channels);
  const ActivationModel model =
      model_of(ActivationForm::recursive, Nonlinearity::exponential, StartUp::ceinms);
  std::size_t compared = 0;
  for (std::size_t m = 1; m < muscles.size(); ++m) {
    // The excitation generator's map is one channel per muscle: find the channel that fits at the first sample.
    double best = 1.0;
    for (std::size_t c = 1; c < channels.size(); ++c) {
      std::vector<double> a(emg[c].size());
      activate(model, RecursionParameters{-0.5, -0.5, 0.0, -1.5, 200.0}, emg[c], 200.0, a);
      double worst = 0.0;
      for (std::size_t k = 0; k < a.size(); ++k)
        worst = std::max(worst, std::abs(a[k] - activations[m].at(k)));
      best = std::min(best, worst);
    }
    EXPECT_LT(best, 1e-14) << muscles[m];
    ++compared;
  }
  EXPECT_EQ(compared, 7u);
}

TEST(Recursive, AcceptsNegativePolesAndRefusesUnstableOnes) {
  const ActivationModel model = model_of(ActivationForm::recursive);
  const std::vector<double> e(400, 0.7);
  std::vector<double> u(e.size());
  activate(model_of(ActivationForm::recursive, Nonlinearity::none, StartUp::rest),
           RecursionParameters{0.5, -0.9, 0.0, 0.0, 200.0}, e, 200.0, u);
  EXPECT_NEAR(u.back(), 0.7, 1e-12);
  EXPECT_EQ(input_error([&] {
              activate(model, RecursionParameters{1.0, -1.2, 0.0, 0.0, 200.0}, e, 200.0, u);
            }),
            "out-of-range: `g1` = 1 must lie in (-1, 1): the recursion would not be stable\n"
            "out-of-range: `g2` = -1.2 must lie in (-1, 1): the recursion would not be stable");
  EXPECT_EQ(input_error([&] {
              activate(model, RecursionParameters{-0.5, -0.5, 0.0, 0.0, 1000.0}, e, 200.0, u);
            }),
            "rate-mismatch: `g1`, `g2` were given for 1000 Hz, the excitation has 200 Hz");
  EXPECT_EQ(input_error([] { (void)time_constant(0.3, 200.0); }),
            "no-time-constant: g = `0.3` has no time constant: it must lie in (-1, 0)");
}

TEST(Recursive, CoefficientsOfTheFieldMeanOtherTimeConstantsAtOtherRates) {
  EXPECT_NEAR(time_constant(-0.05, 1000.0), 0.33e-3, 0.01e-3);
  EXPECT_NEAR(time_constant(-0.95, 1000.0), 19.5e-3, 0.05e-3);
  EXPECT_NEAR(time_constant(-0.05, 200.0), 1.7e-3, 0.05e-3);
  EXPECT_NEAR(time_constant(-0.95, 200.0), 97e-3, 0.6e-3);
  EXPECT_NEAR(recursion_coefficient(time_constant(-0.7, 333.0), 333.0), -0.7, 1e-15);
}

// ------------------------------------------------------------------ derivatives

struct Tangents {
  explicit Tangents(std::size_t n) : u(n), gain(n), delay(n), one(n), two(n), shape(n) {}
  ActivationTangents view() { return {u, gain, delay, one, two, shape}; }
  std::vector<double> u, gain, delay, one, two, shape;
};

// Largest difference between the tangents and central finite differences, each relative to the tangent's largest value.
double worst_tangent(const ActivationModel& model, ActivationParameters p, const std::vector<double>& e,
                     double rate, double wrong = 1.0, double step = 1.0) {
  Tangents t(e.size());
  std::vector<double> a(e.size());
  const double gain = 0.9;
  activate_with_tangents(model, p, e, rate, a, t.view(), gain);
  EXPECT_EQ(a.size(), e.size());
  const std::vector<double> plain = run(model, p, e, rate, gain);
  EXPECT_LT(tests::relative_difference(a, plain), 1e-14);

  double worst = 0.0;
  const auto compare = [&](const std::vector<double>& tangent, double h,
                           const std::function<std::vector<double>(double)>& at) {
    const auto p1 = at(h), m1 = at(-h), p2 = at(2 * h), m2 = at(-2 * h);
    const double size = tests::largest(tangent);
    for (std::size_t k = 0; k < e.size(); ++k) {
      const double fd = (8 * (p1[k] - m1[k]) - (p2[k] - m2[k])) / (12 * h);
      worst = std::max(worst, std::abs(tangent[k] * wrong - fd) / size);
    }
  };
  compare(t.gain, 1e-4 * step, [&](double h) { return run(model, p, e, rate, gain + h); });
  compare(t.delay, 2e-5 * step, [&](double h) {
    auto q = p;
    q.delay_s += h;
    return run(model, q, e, rate, gain);
  });
  compare(t.one, 2e-5 * step, [&](double h) {
    auto q = p;
    q.time_constant_1_s += h;
    return run(model, q, e, rate, gain);
  });
  compare(t.two, 2e-5 * step, [&](double h) {
    auto q = p;
    q.time_constant_2_s += h;
    return run(model, q, e, rate, gain);
  });
  if (model.nonlinearity != Nonlinearity::none) {
    compare(t.shape, 1e-5 * step, [&](double h) {
      auto q = p;
      q.shape += h;
      return run(model, q, e, rate, gain);
    });
  }
  return worst;
}

TEST(Activation, TangentsEqualFiniteDifferencesForEveryFormAndAWrongTwinIsCaught) {
  const double rate = 200.0;
  const std::vector<double> e = excitation(300, rate);
  for (const StartUp start : {StartUp::steady_state, StartUp::rest}) {
    const ActivationModel exponential =
        model_of(ActivationForm::continuous, Nonlinearity::exponential, start);
    EXPECT_LT(worst_tangent(exponential, {0.0371, 0.012, 0.041, -1.5}, e, rate), 1e-8);
    EXPECT_LT(worst_tangent(exponential, {0.0371, 0.025, 0.025, -1.5}, e, rate), 1e-8) << "confluent";
    // Short steps where a second derivative jumps: at the start from rest, at the node, at the turn from rise to fall.
    EXPECT_LT(worst_tangent(exponential, {0.0350, 0.012, 0.041, -1.5}, e, rate, 1.0, 0.01), 1e-5)
        << "whole samples";
    EXPECT_LT(worst_tangent(model_of(ActivationForm::continuous, Nonlinearity::piecewise, start),
                            {0.0371, 0.012, 0.041, 0.07}, e, rate, 1.0, 0.01),
              1e-6);
    EXPECT_LT(worst_tangent(model_of(ActivationForm::recursive, Nonlinearity::exponential, start),
                            {0.0371, 0.012, 0.041, -1.5}, e, rate),
              1e-8);
    EXPECT_LT(worst_tangent(model_of(ActivationForm::first_order, Nonlinearity::none, start),
                            {0.0371, 0.0124, 0.0413, -1.5}, e, rate, 1.0, 0.01),
              1e-3);
  }
  EXPECT_GT(worst_tangent(model_of(ActivationForm::continuous, Nonlinearity::exponential),
                          {0.0371, 0.012, 0.041, -1.5}, e, rate, 1.001),
            1e-4);
}

TEST(Recursive, TangentsInItsOwnCoefficientsEqualFiniteDifferences) {
  const double rate = 200.0;
  const std::vector<double> e = excitation(300, rate);
  for (const StartUp start : {StartUp::steady_state, StartUp::rest, StartUp::ceinms}) {
    const ActivationModel model = model_of(ActivationForm::recursive, Nonlinearity::exponential, start);
    const RecursionParameters p{-0.4, 0.3, 0.0121, -1.2, rate};
    Tangents t(e.size());
    std::vector<double> a(e.size());
    activate_with_tangents(model, p, e, rate, a, t.view());
    const auto at = [&](auto change, double h) {
      RecursionParameters q = p;
      change(q, h);
      std::vector<double> y(e.size());
      activate(model, q, e, rate, y);
      return y;
    };
    const auto compare = [&](const std::vector<double>& tangent, auto change) {
      const double h = 1e-5;
      const auto plus = at(change, h), minus = at(change, -h);
      for (std::size_t k = 0; k < e.size(); ++k) {
        ASSERT_NEAR(tangent[k], (plus[k] - minus[k]) / (2 * h),
                    1e-7 * std::max(1.0, tests::largest(tangent)));
      }
    };
    compare(t.one, [](RecursionParameters& q, double h) { q.g1 += h; });
    compare(t.two, [](RecursionParameters& q, double h) { q.g2 += h; });
    compare(t.delay, [](RecursionParameters& q, double h) { q.delay_s += h; });
    compare(t.shape, [](RecursionParameters& q, double h) { q.shape += h; });
  }
}

TEST(Activation, NeuralResponseIsLinearSoThatChannelsMixFirst) {
  const double rate = 500.0;
  const ActivationParameters p{0.0317, 0.012, 0.041, -1.5};
  const std::vector<double> e1 = excitation(600, rate, 2.0), e2 = excitation(600, rate, 5.0);
  std::vector<double> mixed(600), u(600), u1(600), u2(600);
  for (std::size_t k = 0; k < 600; ++k) mixed[k] = 0.6 * e1[k] + 0.3 * e2[k];
  for (const auto form : {ActivationForm::continuous, ActivationForm::recursive}) {
    neural_response(model_of(form), p, mixed, rate, u);
    neural_response(model_of(form), p, e1, rate, u1);
    neural_response(model_of(form), p, e2, rate, u2);
    for (std::size_t k = 0; k < 600; ++k) ASSERT_NEAR(u[k], 0.6 * u1[k] + 0.3 * u2[k], 1e-14);
  }
  EXPECT_EQ(input_error([&] { neural_response(model_of(ActivationForm::first_order), p, e1, rate, u); }),
            "not-linear: the `first_order` form is not linear in the excitation");
}

TEST(FirstOrder, EqualsThelensEquationIntegratedFinely) {
  const double rate = 200.0;
  const ActivationParameters p{0.0, 0.015, 0.050, 0.0};
  std::vector<double> e(200, 0.05);
  for (std::size_t k = 60; k < 120; ++k) e[k] = 0.9;
  const std::vector<double> a = run(model_of(ActivationForm::first_order), p, e, rate);
  double x = e[0];
  const int steps = 20000;  // Heun
  const double h = 1.0 / rate / steps;
  for (std::size_t k = 0; k + 1 < e.size(); ++k) {
    for (int i = 0; i < steps; ++i) {
      const double e0 = e[k] + (e[k + 1] - e[k]) * i / steps, e1 = e[k] + (e[k + 1] - e[k]) * (i + 1) / steps;
      const double f = first_order_rate(p, e0, x);
      x += 0.5 * h * (f + first_order_rate(p, e1, x + h * f));
    }
    ASSERT_NEAR(x, a[k + 1], 2e-6);
  }
}

TEST(Activation, ExcitationAboveOneIsNotClamped) {
  const std::vector<double> e(300, 1.4);
  const ActivationModel model = model_of(ActivationForm::continuous, Nonlinearity::exponential);
  EXPECT_GT(run(model, {}, e, 200.0).back(), 1.0);
}

TEST(Activation, DelayLongerThanTheTrialGivesTheStartingValue) {
  const std::vector<double> e = excitation(50, 200.0);
  for (const auto form :
       {ActivationForm::continuous, ActivationForm::recursive, ActivationForm::first_order}) {
    for (const double a : run(model_of(form), {10.0, 0.012, 0.041, 0.0}, e, 200.0))
      ASSERT_NEAR(a, e[0], 1e-12);
  }
  EXPECT_TRUE(run(continuous, {}, {}, 200.0).empty());
}

TEST(Activation, MistakesAreReportedAtOnceAndByName) {
  const std::vector<double> e(10, 0.5);
  EXPECT_EQ(input_error([&] {
              (void)run(model_of(ActivationForm::continuous, Nonlinearity::exponential),
                        {-1.0, 0.0, std::nan(""), 2.0}, e, 200.0);
            }),
            "out-of-range: `delay_s` = -1 s must be >= 0\n"
            "out-of-range: `shape` = 2 is outside [-3, 0], the range of the exponential nonlinearity\n"
            "out-of-range: `time_constant_1_s` = 0 s must be > 0\n"
            "out-of-range: `time_constant_2_s` = nan s must be > 0");
  EXPECT_EQ(input_error([] {
              check_parameters({}, data::ActivationParameters{0.04, -0.01, 0.035, -1.5}, "BIClong");
            }),
            "out-of-range: `time_constant_1_s` of muscle `BIClong` = -0.01 s must be > 0");
  std::vector<double> bad = e;
  bad[3] = std::nan("");
  EXPECT_EQ(input_error([&] { (void)run(continuous, {}, bad, 200.0); }),
            "not-finite: the excitation is `nan` at sample 3 (0.015 s)");
  EXPECT_EQ(input_error([&] {
              (void)run(model_of(ActivationForm::continuous, Nonlinearity::none, StartUp::ceinms), {}, e,
                        200.0);
            }),
            "out-of-range: start-up `ceinms` belongs to the `recursive` form only");
}

}  // namespace
}  // namespace brachium::emg
