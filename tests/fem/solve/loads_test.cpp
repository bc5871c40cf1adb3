#include "bodies.hpp"
#include "fem/solve/equations.hpp"

namespace brachium::fem {
namespace {

using tests::body;
using tests::quick_options;
using tests::reaction;
using tests::soft;

/// A beam clamped at one end under pressure on one long side.
Problem beam(bool edge_held) {
  Problem p = body(Formulation::q2_p1_discontinuous, {0.04, 0.01, 0.01}, 4, 1, 1, soft(1e6));
  p.conditions = {{"foot", "x0", Fixed{}}, {"press", "z0", FollowerPressure{150.0}}};
  if (edge_held) {
    // All that touches the edge of z0 is held.
    p.conditions.push_back({"end", "x1", Fixed{}});
    p.conditions.push_back({"side0", "y0", Fixed{}});
    p.conditions.push_back({"side1", "y1", Fixed{}});
  }
  p.programme = {{"press", {{"press", 1.0}}, {}, {}, 1, 1.0}};
  return p;
}

TEST(FollowerPressure, AFreeEdgeMakesTheTangentUnsymmetricAndAHeldOneDoesNot) {
  for (const bool held : {false, true}) {
    const Problem p = beam(held);
    Equations equations(p, quick_options());
    equations.constrain({});
    EXPECT_EQ(equations.unsymmetric(), !held);
  }
}

TEST(FollowerPressure, OnTheWholeSkinOfAHeldBodyIsSymmetric) {
  Problem p = body(Formulation::q1_p0, {0.01, 0.01, 0.01}, 2, 2, 2, soft());
  auto mesh = std::make_shared<data::Mesh>(*p.mesh);
  mesh->surfaces.push_back({"skin", data::boundary_faces(*mesh)});
  p.mesh = mesh;
  p.conditions = {{"foot", "x0", Fixed{}}, {"squeeze", "skin", FollowerPressure{1e4}}};
  Equations equations(p, quick_options());
  equations.constrain({});
  EXPECT_FALSE(equations.unsymmetric());
}

/// The whole tangent, loads included: Newton converges quadratically on a large bend, and reactions balance
/// the pressure.
TEST(FollowerPressure, ConvergesQuadraticallyWithItsUnsymmetricTangent) {
  const Problem p = beam(false);
  SolveOptions o = quick_options();
  o.chord = false;
  o.relative_residual = 1e-12;
  Eigen::Vector3d support = Eigen::Vector3d::Zero(), load = support;
  const Summary s = solve(p, o, [&](const AcceptedState& state) {
    support = reaction(p, state, "x0");
    load.setZero();
    for (int n = 0; n < p.mesh->point_count(); ++n) load += state.external_force.segment<3>(3 * n);
  });
  ASSERT_TRUE(s.completed) << s.reason << log_text(s);
  EXPECT_LT((support + load).norm(), 1e-9 * load.norm());
  EXPECT_THAT(tests::codes(s.diagnostics), ::testing::Contains("unsymmetric-tangent"));
}

TEST(BodyForce, StretchesAHangingColumnByItsWeight) {
  Problem p = body(Formulation::q2_p1_discontinuous, {0.01, 0.01, 0.02}, 1, 1, 3, soft(1e6));
  p.conditions = {{"top", "z1", Fixed{{false, false, true}}},
                  {"x", "x0", SymmetryPlane{}},
                  {"y", "y0", SymmetryPlane{}},
                  {"weight", "", BodyForce{Eigen::Vector3d(0.0, 0.0, -9810.0)}}};
  p.programme = {{"hang", {{"weight", 1.0}}, {}, {}, 1, 1.0}};
  Eigen::Vector3d top;
  const Summary s =
      solve(p, quick_options(), [&](const AcceptedState& state) { top = reaction(p, state, "z1"); });
  ASSERT_TRUE(s.completed) << s.reason;
  EXPECT_NEAR(top[2], 9810.0 * 2e-6, 1e-9);
}

}  // namespace
}  // namespace brachium::fem
