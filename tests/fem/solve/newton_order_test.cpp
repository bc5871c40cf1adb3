// Order of Newton's method where it is well defined: one whole step from a solution (u*, p*) that was
// disturbed by ε leaves an error of ε^2. Displacements and pressures are counted together, since they
// converge together.

#include <cmath>

#include "bodies.hpp"
#include "fem/solve/newton.hpp"

namespace brachium::fem {
namespace {

using tests::block_muscle;
using tests::body;
using tests::infinite;
using tests::quick_options;

Problem clamped(Formulation formulation) {
  const bool exact = pressure_space(formulation) == PressureSpace::continuous;
  Problem p = body(formulation, {0.04, 0.01, 0.01}, 4, 2, 2,
                   {block_muscle(), {VolumetricLaw::quadratic, exact ? infinite : 1e6}});
  p.conditions = {{"left", "x0", Fixed{}}, {"right", "x1", PrescribedDisplacement{{0.004, 0.0, 0.0}}}};
  p.programme = {{"stretch", {{"right", 1.0}}, {}, {}, 1, 1.0},
                 {"activate", {}, {{p.mesh->regions.front(), 0.5}}, {}, 2, 1.0}};
  return p;
}

/// A cantilever under a pressure that follows its surface: the tangent is unsymmetric.
Problem pressed(Formulation formulation) {
  const bool exact = pressure_space(formulation) == PressureSpace::continuous;
  Problem p = body(formulation, {0.04, 0.01, 0.01}, 4, 1, 1,
                   {NeoHooke{1e4, false}, {VolumetricLaw::quadratic, exact ? infinite : 1e6}});
  p.conditions = {{"left", "x0", Fixed{}}, {"press", "z0", FollowerPressure{100.0}}};
  p.programme = {{"press", {{"press", 1.0}}, {}, {}, 2, 1.0}};
  return p;
}

class OneStep {
 public:
  explicit OneStep(const Problem& problem)
      : problem_(problem),
        options_(quick_options()),
        programme_(problem_),
        equations_(problem_, options_),
        factor_(options_) {
    SolveOptions o = options_;
    o.relative_residual = 1e-14;
    o.relative_step = 1e-12;
    o.stability = "off";
    const Summary s = solve(problem_, o);
    EXPECT_TRUE(s.completed) << s.reason << log_text(s);
    solution_ = s.last.configuration;
    load_ = programme_.at(s.last, 1.0);
    equations_.constrain({});
    factor_.analyse(equations_);
    if (equations_.condensed()) pressure_ = equations_.assembly().pressures(solution_);
  }

  /// Error after the step, over the size of cells and the stiffness. `other_load`: the factor is that of a
  /// body half as active or loaded, the twin whose tangent is wrong.
  double error(double disturbance, bool other_load = false) {
    Configuration c = solution_;
    Eigen::VectorXd away(equations_.unknowns().count());
    const Eigen::Index moving = equations_.displacement_unknowns();
    const double pascal = equations_.stiffness_pa();
    for (Eigen::Index i = 0; i < away.size(); ++i)
      away[i] =
          std::sin(0.3 + 0.7 * static_cast<double>(i)) * (i < moving ? equations_.cell_size_m() : pascal);
    equations_.add(away, disturbance, c.dofs);
    NewtonSettings one = options_;
    one.chord = other_load;
    one.max_chord_iterations = 1;
    one.max_iterations = other_load ? 0 : 1;
    one.relative_residual = 1e-16;
    factor_.forget();
    if (other_load) {
      LoadPoint less = load_;
      less.activation *= 0.5;
      less.amplitude *= 0.5;
      EXPECT_EQ(factor_.make(equations_, c, less), "");
    }
    std::vector<IterationRecord> records;
    const NewtonOutcome outcome = Newton(equations_, factor_, one).run(c, load_, 1, records, pressure_);
    EXPECT_EQ(outcome.newton + outcome.chord, 1) << outcome.reason;
    EXPECT_EQ(records.front().line_search, 1.0) << "a damped step says nothing";
    Eigen::VectorXd off = equations_.unknowns().restrict(c.dofs - solution_.dofs);
    double pressures = off.tail(off.size() - moving).norm() / pascal;
    if (equations_.condensed()) pressures = (equations_.assembly().pressures(c) - pressure_).norm() / pascal;
    return off.head(moving).norm() / equations_.cell_size_m() + pressures;
  }

  /// Of halved disturbances, where rounding does not count yet.
  double order(bool other_load = false) {
    const double far = 1e-4;
    return std::log2(error(far, other_load) / error(0.5 * far, other_load));
  }

 private:
  Problem problem_;
  SolveOptions options_;
  Programme programme_;
  Equations equations_;
  TangentFactor factor_;
  Configuration solution_;
  LoadPoint load_;
  Eigen::MatrixXd pressure_;
};

class NewtonOrder : public ::testing::TestWithParam<Formulation> {};

TEST_P(NewtonOrder, IsTwoForAnActiveBody) {
  OneStep step(clamped(GetParam()));
  EXPECT_GT(step.order(), 1.9);
  EXPECT_LT(step.order(), 2.2);
}

TEST_P(NewtonOrder, IsTwoUnderAPressureThatFollows) {
  OneStep step(pressed(GetParam()));
  EXPECT_GT(step.order(), 1.9);
  EXPECT_LT(step.order(), 2.2);
}

TEST_P(NewtonOrder, IsOneWithTheTangentOfAnotherState) {
  OneStep step(clamped(GetParam()));
  EXPECT_LT(step.order(true), 1.2);
}

INSTANTIATE_TEST_SUITE_P(Elements, NewtonOrder,
                         ::testing::Values(Formulation::q2_q1_taylor_hood, Formulation::q2_p1_discontinuous,
                                           Formulation::q1_p0, Formulation::p2b_p1_discontinuous,
                                           Formulation::p2_p1_taylor_hood, Formulation::q2_displacement),
                         [](const auto& which) { return to_string(which.param); });

}  // namespace
}  // namespace brachium::fem
