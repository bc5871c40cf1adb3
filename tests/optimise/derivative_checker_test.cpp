#include "optimise/derivative_checker.hpp"

#include <gtest/gtest.h>

#include "toy_problems.hpp"

namespace brachium::optimise {
namespace {

TEST(DerivativeChecker, PassesExactDerivatives) {
  const auto problem = tests::decay();
  const DerivativeCheck check = check_derivatives(problem, start_of(problem.parameters()));
  EXPECT_TRUE(check.passed) << check.text();
  EXPECT_LT(check.worst_relative_error, 1e-9);
}

TEST(DerivativeChecker, NamesParameterAndResidualOfAWrongDerivative) {
  const auto problem = tests::decay(1e-3);  // one entry, wrong by a thousandth
  const DerivativeCheck check = check_derivatives(problem, start_of(problem.parameters()));
  ASSERT_FALSE(check.passed);
  ASSERT_EQ(check.worst.size(), 1u);
  EXPECT_EQ(check.worst[0].parameter, "toy b");
  EXPECT_EQ(check.worst[0].residual, "sample 7");
  EXPECT_NEAR(check.worst[0].relative_error, 1e-3, 1e-5);
  EXPECT_EQ(check.text().substr(0, 46), "wrong derivative: `toy b` at sample 7: analyti");
}

TEST(DerivativeChecker, RefusesAPointOnABound) {
  const auto problem = tests::decay();
  try {
    check_derivatives(problem, lower_of(problem.parameters()));
    FAIL();
  } catch (const data::InputError& error) {
    EXPECT_EQ(error.diagnostics()[0].message,
              "parameter `toy a` lies on its bound: no two-sided difference can be taken");
  }
}

}  // namespace
}  // namespace brachium::optimise
