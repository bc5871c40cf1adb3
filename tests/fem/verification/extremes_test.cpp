// Problems at the edge: a small part of the table that tests/bench/fem_extremes prints.

#include "tests/fem/verification/extremes.hpp"

#include <cmath>
#include <tuple>

#include "tests/fem/verification/study.hpp"

namespace brachium::fem::verification {
namespace {

TEST(Extremes, TheDistortedBoxHasTheRatioThatWasAskedFor) {
  EXPECT_NEAR(jacobian_ratio(*distorted_box(data::CellType::hex27, 0.05)), 0.05, 1e-6);
  EXPECT_NEAR(jacobian_ratio(*distorted_box(data::CellType::hex8, 1.0)), 1.0, 1e-6);
}

class ExtremeRow : public testing::TestWithParam<std::tuple<const char*, Formulation>> {};

TEST_P(ExtremeRow, IsSolvedToAStableState) {
  const auto& [name, formulation] = GetParam();
  const Outcome outcome = outcome_of(extreme(name, formulation));
  EXPECT_TRUE(outcome.solved) << outcome.reason;
  EXPECT_EQ(outcome.stability, "stable");
  EXPECT_TRUE(std::isfinite(outcome.force_n));
}

INSTANTIATE_TEST_SUITE_P(
    Table, ExtremeRow,
    testing::Combine(testing::Values("aspect ratio 50, stretch 1.1, alpha 0.5",
                                     "Jacobian ratio 0.05, stretch 1.2, alpha 0.5",
                                     "stretch 0.5, passive, free sides", "stretch 2, passive, free sides",
                                     "stretch 1.1 then alpha 0 to 1 at once",
                                     "sigma_max x 10, stretch 1.1, alpha 1",
                                     "tendon 1e4 times as stiff, stretch 1.05, alpha 0.5"),
                     testing::Values(Formulation::q2_p1_discontinuous, Formulation::q2_q1_taylor_hood)),
    [](const testing::TestParamInfo<std::tuple<const char*, Formulation>>& row) {
      std::string name = std::string(std::get<0>(row.param)) + to_string(std::get<1>(row.param));
      std::erase_if(name, [](char c) { return std::isalnum(static_cast<unsigned char>(c)) == 0; });
      return name;
    });

// Fibres that carry meganewtons at stretch 2 invert cells at the clamps before it.
TEST(Extremes, WhatCannotBeSolvedEndsWithPlaceAndReason) {
  const Outcome outcome = outcome_of(extreme("stretch 2, passive, clamped", Formulation::q2_q1_taylor_hood));
  EXPECT_FALSE(outcome.solved);
  EXPECT_NE(outcome.reason.find("phase `stretch`, step "), std::string::npos) << outcome.reason;
  EXPECT_NE(outcome.reason.find("smallest J "), std::string::npos) << outcome.reason;
  EXPECT_NE(outcome.reason.find("in cell "), std::string::npos) << outcome.reason;
  EXPECT_LT(outcome.cut_backs, 50) << "no endless bisection";
  EXPECT_TRUE(std::isfinite(outcome.force_n)) << "of the last converged state";
  EXPECT_EQ(outcome.stability, "stable");
}

}  // namespace
}  // namespace brachium::fem::verification
