// One direction: B-splines, splines through values, Hermite interpolation.

#include "fem/surrogate/piecewise.hpp"

#include "data/model/curve.hpp"
#include "data/model/error.hpp"
#include "surrogate_cases.hpp"

namespace brachium::fem::test {
namespace {

const std::vector<double> uneven{0.0, 0.3, 0.5, 0.9, 1.2, 1.9, 2.0, 2.6};

// Value (order 0) or derivative of the map's function at x.
double at(const PiecewiseMap& map, const std::vector<double>& nodes, const Eigen::VectorXd& f,
          const Eigen::VectorXd& slopes, double x, int order, std::size_t cell) {
  Eigen::VectorXd c = map.from_values * f;
  if (map.from_slopes.size() > 0) c += map.from_slopes * slopes;
  const double h = nodes[cell + 1] - nodes[cell], t = (x - nodes[cell]) / h;
  double sum = 0.0;
  for (int k = order; k <= map.degree; ++k) {
    double factor = 1.0;
    for (int d = 0; d < order; ++d) factor *= (k - d) / h;
    sum += factor * c(static_cast<Eigen::Index>(cell) * (map.degree + 1) + k) * std::pow(t, k - order);
  }
  return sum;
}

Eigen::VectorXd on(const std::vector<double>& nodes, const std::function<double(double)>& f) {
  Eigen::VectorXd v(static_cast<Eigen::Index>(nodes.size()));
  for (std::size_t i = 0; i < nodes.size(); ++i) v(static_cast<Eigen::Index>(i)) = f(nodes[i]);
  return v;
}

TEST(BSplines, SumToOneAndTheirDerivativesToNothing) {
  const std::vector<double> knots{-0.5, 0.0, 0.0, 0.4, 1.0, 1.5, 2.5, 2.5, 3.0};
  for (double x : {0.41, 0.4, 0.9999, 1.0}) {
    const SplineValues b = bsplines(knots, 3, x, 3);
    EXPECT_NEAR(b.derivative.row(0).sum(), 1.0, 1e-15);
    for (int d = 1; d <= 3; ++d) EXPECT_NEAR(b.derivative.row(d).sum(), 0.0, 1e-12);
  }
}

TEST(BSplines, OfTheCardinalKnotsAreTheKnownSixths) {
  const SplineValues b = bsplines({-3, -2, -1, 0, 1, 2, 3, 4}, 3, 0.0, 2);
  EXPECT_LT((b.derivative.row(0) - Eigen::RowVector4d(1.0 / 6, 4.0 / 6, 1.0 / 6, 0)).norm(), 1e-15);
  EXPECT_LT((b.derivative.row(1) - Eigen::RowVector4d(-0.5, 0, 0.5, 0)).norm(), 1e-15);
  EXPECT_LT((b.derivative.row(2) - Eigen::RowVector4d(1, -2, 1, 0)).norm(), 1e-15);
}

TEST(SplineMap, ReproducesPolynomialsOfItsDegreeAndIsAsSmoothAsItSays) {
  for (int degree : {1, 3, 5}) {
    const PiecewiseMap map = spline_map(uneven, degree);
    ASSERT_EQ(map.degree, degree);
    const auto power = [degree](double x) { return std::pow(x - 0.7, degree); };
    const auto wave = [](double x) { return std::sin(3.0 * x); };
    for (std::size_t c = 0; c + 1 < uneven.size(); ++c) {
      const double x = 0.3 * uneven[c] + 0.7 * uneven[c + 1];
      EXPECT_NEAR(at(map, uneven, on(uneven, power), {}, x, 0, c), power(x), 1e-11);
      EXPECT_NEAR(at(map, uneven, on(uneven, wave), {}, uneven[c], 0, c), wave(uneven[c]), 1e-12);
      if (c == 0) continue;
      for (int order = 0; order < degree; ++order) {
        EXPECT_NEAR(at(map, uneven, on(uneven, wave), {}, uneven[c], order, c),
                    at(map, uneven, on(uneven, wave), {}, uneven[c], order, c - 1),
                    1e-8 * std::pow(10.0, order));
      }
    }
  }
}

TEST(SplineMap, WithFewNodesIsThePolynomialThroughThem) {
  const std::vector<double> nodes{0.0, 1.0, 3.0};
  const PiecewiseMap map = spline_map(nodes, 3);
  EXPECT_EQ(map.degree, 2);
  const auto f = [](double x) { return 2.0 - x + 0.5 * x * x; };
  EXPECT_NEAR(at(map, nodes, on(nodes, f), {}, 2.2, 0, 1), f(2.2), 1e-14);
  EXPECT_NEAR(slope_map(nodes, 5).row(2).dot(on(nodes, f)), 2.0, 1e-13);
}

TEST(HermiteMap, MeetsValuesAndSlopesAndReproducesItsDegree) {
  for (const std::vector<double>& nodes :
       {uneven, std::vector<double>{0.0, 0.7, 1.0}, std::vector<double>{0.0, 0.2, 0.7, 1.0}}) {
    for (int degree : {3, 5}) {
      const PiecewiseMap map = hermite_map(nodes, degree);
      ASSERT_EQ(map.degree, degree);
      const auto f = [degree](double x) { return std::pow(x - 0.4, degree); };
      const auto df = [degree](double x) { return degree * std::pow(x - 0.4, degree - 1); };
      const auto wave = [](double x) { return std::sin(3.0 * x); };
      const auto slope = [](double x) { return 3.0 * std::cos(3.0 * x); };
      for (std::size_t c = 0; c + 1 < nodes.size(); ++c) {
        const double x = 0.6 * nodes[c] + 0.4 * nodes[c + 1];
        EXPECT_NEAR(at(map, nodes, on(nodes, f), on(nodes, df), x, 0, c), f(x), 1e-11);
        for (double end : {nodes[c], nodes[c + 1]}) {
          EXPECT_NEAR(at(map, nodes, on(nodes, wave), on(nodes, slope), end, 0, c), wave(end), 1e-12);
          EXPECT_NEAR(at(map, nodes, on(nodes, wave), on(nodes, slope), end, 1, c), slope(end), 1e-11);
        }
        if (c == 0 || degree == 3) continue;
        for (int order : {2, 3}) {
          EXPECT_NEAR(at(map, nodes, on(nodes, wave), on(nodes, slope), nodes[c], order, c),
                      at(map, nodes, on(nodes, wave), on(nodes, slope), nodes[c], order, c - 1), 1e-8);
        }
      }
    }
  }
}

TEST(HermiteMap, OfTwoNodesIsCubic) {
  EXPECT_EQ(hermite_map({0.0, 1.0}, 5).degree, 3);
}

TEST(MonotoneCoefficients, AreThoseOfTheMonotoneCurve) {
  const Eigen::VectorXd f = on(uneven, [](double x) { return x < 1.0 ? 0.0 : std::tanh(4.0 * (x - 1.0)); });
  const Eigen::MatrixXd c = monotone_coefficients(uneven, f);
  const auto curve = data::PiecewiseCubic::monotone(uneven, {f.data(), uneven.size()});
  for (std::size_t i = 0; i + 1 < uneven.size(); ++i) {
    const double x = 0.5 * (uneven[i] + uneven[i + 1]);
    const Eigen::Vector4d k = c.block<4, 1>(static_cast<Eigen::Index>(4 * i), 0);
    EXPECT_NEAR(k(0) + 0.5 * k(1) + 0.25 * k(2) + 0.125 * k(3), curve(x).value, 1e-14);
  }
}

TEST(PiecewiseMaps, RefuseDegreesAndNodesTheyCannotUse) {
  EXPECT_THROW(spline_map({0.0, 1.0}, 2), data::InputError);
  EXPECT_THROW(spline_map({0.0}, 3), data::InputError);
  EXPECT_THROW(hermite_map({0.0, 1.0, 1.0}, 3), data::InputError);
  EXPECT_THROW(hermite_map({0.0, 1.0}, 1), data::InputError);
}

}  // namespace
}  // namespace brachium::fem::test
