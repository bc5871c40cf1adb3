// Hierarchical splines and sparse grids.

#include "fem/surrogate/sparse_spline.hpp"

#include "data/model/error.hpp"
#include "fem/surrogate/tensor.hpp"
#include "surrogate_cases.hpp"

namespace brachium::fem::test {
namespace {

constexpr SparseBoundary both[] = {SparseBoundary::modified, SparseBoundary::included};

std::vector<StatePoint> states(const SparseGrid& grid, const StateBounds& bounds) {
  std::vector<StatePoint> out;
  for (const SparseIndex& p : grid.points()) out.push_back(state_of(p, bounds));
  return out;
}

Surrogate sparse(SparseBoundary boundary, int level, const Truth& truth) {
  return sparse_surrogate(sample(states(SparseGrid::regular(boundary, level), elbow()), {truth}, false),
                          elbow(), boundary);
}

TEST(HierarchicalBasis, DerivativesAreThoseOfItsValues) {
  for (const SparseBoundary boundary : both) {
    for (int level = lowest_level(boundary); level <= 4; ++level) {
      for (const HierarchicalIndex& i : level_indices(level)) {
        for (double x = 0.013; x < 1.0; x += 0.0711) {
          const double h = 1e-5;
          const Eigen::Vector4d at = hierarchical_basis(boundary, i, x),
                                low = hierarchical_basis(boundary, i, x - h),
                                high = hierarchical_basis(boundary, i, x + h);
          for (int d = 0; d < 2; ++d)
            EXPECT_NEAR(at(d + 1), (high(d) - low(d)) / (2.0 * h), 1e-4 * (1.0 + std::abs(at(d + 1))));
        }
      }
    }
  }
}

TEST(HierarchicalBasis, ModifiedGoesOnLinearlyToTheBoundary) {
  for (int level = 2; level <= 5; ++level) {
    for (const HierarchicalIndex& i : level_indices(level)) {
      EXPECT_NEAR(hierarchical_basis(SparseBoundary::modified, i, 0.0)(2), 0.0, 1e-9)
          << level << " " << i.index;
      EXPECT_NEAR(hierarchical_basis(SparseBoundary::modified, i, 1.0)(2), 0.0, 1e-9)
          << level << " " << i.index;
    }
  }
}

TEST(HierarchicalBasis, IsSymmetric) {
  for (const SparseBoundary boundary : both) {
    for (const HierarchicalIndex& i : level_indices(3)) {
      for (double x : {0.05, 0.3, 0.61}) {
        EXPECT_NEAR(hierarchical_basis(boundary, i, x)(0),
                    hierarchical_basis(boundary, {3, 8 - i.index}, 1.0 - x)(0), 1e-14);
      }
    }
  }
}

TEST(SparseGrid, HasTheNumbersOfPointsOfTheLiterature) {
  const std::size_t modified[] = {1, 5, 17, 49, 129}, included[] = {4, 8, 17, 37, 81};
  for (int n = 0; n < 5; ++n) {
    EXPECT_EQ(SparseGrid::regular(SparseBoundary::modified, n + 1).size(), modified[n]);
    EXPECT_EQ(SparseGrid::regular(SparseBoundary::included, n).size(), included[n]);
  }
}

TEST(SparseGrid, InsertsAncestorsAndKnowsItsLeaves) {
  for (const SparseBoundary boundary : both) {
    SparseGrid grid(boundary);
    grid.insert({{4, 5}, {2, 3}});
    for (const SparseIndex& p : grid.points()) {
      for (const HierarchicalIndex& t : parents(p.theta, boundary)) EXPECT_TRUE(grid.contains({t, p.alpha}));
      for (const HierarchicalIndex& a : parents(p.alpha, boundary)) EXPECT_TRUE(grid.contains({p.theta, a}));
    }
    EXPECT_TRUE(grid.contains({{3, 3}, {2, 3}}));
    EXPECT_TRUE(grid.contains({{2, 1}, {1, 1}}));
    EXPECT_TRUE(grid.is_leaf({{4, 5}, {2, 3}}));
    EXPECT_FALSE(grid.is_leaf({{3, 3}, {2, 3}}));
    EXPECT_TRUE(grid.insert({{1, 1}, {1, 1}}).empty());
  }
}

TEST(SparseGrid, FindsTheIndexOfAState) {
  const SparseIndex p{{4, 3}, {3, 5}};
  EXPECT_EQ(index_of(state_of(p, elbow()), elbow(), SparseBoundary::modified, 8), p);
  EXPECT_THROW(index_of({20.0 * deg, 0.3}, elbow(), SparseBoundary::modified, 4), data::InputError);
  EXPECT_THROW(index_of({10.0 * deg, 0.5}, elbow(), SparseBoundary::modified, 4), data::InputError);
  EXPECT_EQ(index_of({10.0 * deg, 0.5}, elbow(), SparseBoundary::included, 4), (SparseIndex{{0, 0}, {1, 1}}));
}

TEST(SparseSpline, WithBoundaryReproducesCubicPolynomials) {
  const Polynomial truth(3, 3);
  const Differences d = differences(sparse(SparseBoundary::included, 4, truth), truth);
  EXPECT_LT(d.value, 1e-10);
  EXPECT_LT(d.dtheta, 1e-9);
  EXPECT_LT(d.dalpha, 1e-9);
}

TEST(SparseSpline, ModifiedReproducesBilinearFunctions) {
  const Polynomial truth(1, 1);
  EXPECT_LT(differences(sparse(SparseBoundary::modified, 3, truth), truth).value, 1e-12);
}

TEST(SparseSpline, InterpolatesAndEqualsTheSumOverItsPoints) {
  for (const SparseBoundary boundary : both) {
    const SampleSet set =
        sample(states(SparseGrid::regular(boundary, 4), elbow()), {muscle, Polynomial(2, 2)}, false);
    SparseValues values;
    for (const Sample& s : set.samples) values[index_of(s.at, elbow(), boundary, 8)] = s.value;
    const SparseSpline spline = interpolate(boundary, values);
    const Surrogate surrogate = make_surrogate(spline, elbow(), set.outputs);
    std::vector<OutputValue> out(2);
    for (const Sample& s : set.samples) {
      surrogate.evaluate(s.at.theta_rad, s.at.activation, out);
      EXPECT_NEAR(out[0].value, s.value(0), 1e-9);
      EXPECT_NEAR(out[1].value, s.value(1), 1e-11);
    }
    for (double x : {0.0, 0.03, 0.5, 0.77, 1.0}) {
      for (double y : {0.0, 0.21, 0.6, 1.0}) {
        const auto slow = spline.evaluate(x, y);
        surrogate.evaluate(elbow().theta_lower_rad + x * elbow().theta_span(), y, out);
        EXPECT_NEAR(out[0].value, slow(0, 0), 1e-9);
        EXPECT_NEAR(out[0].dtheta * elbow().theta_span(), slow(0, 1), 1e-7);
        EXPECT_NEAR(out[0].dalpha, slow(0, 2), 1e-7);
      }
    }
  }
}

TEST(SparseSpline, DerivativesAreThoseOfItsValuesAndAWrongOneIsFound) {
  for (const SparseBoundary boundary : both) {
    const Surrogate s = sparse(boundary, 4, muscle);
    EXPECT_LT(derivative_mismatch(s), 2e-6);
    EXPECT_GT(derivative_mismatch(s, 1.001), 5e-4);
  }
}

// The order of a regular sparse grid is that of the full one but for a logarithm: h^4 |log h|.
TEST(SparseSpline, WithBoundaryConvergesWithTheFourthOrder) {
  const double coarse = differences(sparse(SparseBoundary::included, 6, muscle), muscle).value,
               fine = differences(sparse(SparseBoundary::included, 7, muscle), muscle).value;
  EXPECT_GT(std::log2(coarse / fine), 3.3);
}

TEST(SparseSpline, ModifiedConvergesToo) {
  const auto inside = [](int level) {
    const Surrogate s = sparse(SparseBoundary::modified, level, muscle);
    std::vector<OutputValue> out(1);
    double most = 0.0;
    for (const StatePoint& p :
         grid_states(equidistant(30.0 * deg, 130.0 * deg, 31), equidistant(0.15, 0.85, 31))) {
      s.evaluate(p.theta_rad, p.activation, out);
      most = std::max(most, std::abs(out[0].value - muscle(p.theta_rad, p.activation).value));
    }
    return most;
  };
  EXPECT_GT(std::log2(inside(5) / inside(7)), 4.0);  // two levels
}

TEST(SparseSpline, LeftOutErrorIsThatOfTheInterpolantOfAllOthers) {
  const SparseGrid grid = SparseGrid::regular(SparseBoundary::included, 3);
  SparseValues values;
  for (const SparseIndex& p : grid.points()) {
    const StatePoint s = state_of(p, elbow());
    values[p] = Eigen::VectorXd::Constant(1, muscle(s.theta_rad, s.activation).value);
  }
  const SparseSpline all = interpolate(SparseBoundary::included, values);
  for (std::size_t i = 0; i < all.points.size(); ++i) {
    if (!grid.is_leaf(all.points[i])) continue;
    SparseValues rest = values;
    rest.erase(all.points[i]);
    const double predicted =
        interpolate(SparseBoundary::included, rest)
            .evaluate(all.points[i].theta.position(), all.points[i].alpha.position())(0, 0);
    EXPECT_NEAR(all.left_out(static_cast<Eigen::Index>(i), 0), values.at(all.points[i])(0) - predicted, 1e-8);
  }
}

TEST(SparseSpline, RefusesWhatItCannotInterpolate) {
  SampleSet set = sample({{10.0 * deg, 0.5}, {30.0 * deg, 0.5}}, {muscle}, false);
  EXPECT_THROW(sparse_surrogate(set, elbow(), SparseBoundary::included), data::InputError);
  SparseValues deep;
  deep[{{9, 1}, {0, 0}}] = deep[{{0, 0}, {9, 1}}] = deep[{{0, 0}, {0, 0}}] = Eigen::VectorXd::Ones(1);
  EXPECT_THROW(make_surrogate(interpolate(SparseBoundary::included, deep), elbow(), {"F"}), data::InputError);
}

}  // namespace
}  // namespace brachium::fem::test
