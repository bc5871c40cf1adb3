#include "bodies.hpp"

namespace brachium::fem {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using tests::block_muscle;
using tests::body;
using tests::codes;
using tests::infinite;
using tests::messages;

Problem sound() {
  Problem p = body(Formulation::q2_p1_discontinuous, {0.02, 0.01, 0.01}, 2, 1, 1,
                   {block_muscle(), {VolumetricLaw::quadratic, 1e7}});
  p.conditions = {{"left", "x0", Fixed{}},
                  {"right", "x1", PrescribedDisplacement{{0.001, 0.0, 0.0}}},
                  {"load", "y1", DeadTraction{{0.0, 10.0, 0.0}, false}}};
  p.programme = {{"stretch", {{"right", 1.0}}, {}, {}, 1, 1.0},
                 {"activate", {}, {{p.mesh->regions.front(), 0.5}}, {}, 1, 1.0}};
  return p;
}

std::string errors_of(const Problem& p) {
  return messages(check(p));
}

TEST(Check, FindsNothingInASoundProblem) {
  EXPECT_THAT(check(sound()), IsEmpty());
}

TEST(Check, FindsAllMistakesAtOnce) {
  Problem p = sound();
  p.conditions[0].surface = "x00";
  p.programme[0].amplitude = {{"rihgt", 1.0}};
  p.programme[1].activation = {{p.mesh->regions.front(), 1.5}};
  p.tissue.fibre.resize(3, 0);
  const auto found = codes(check(p));
  EXPECT_THAT(found, AllOf(Contains("missing-surface"), Contains("unknown-condition"),
                           Contains("activation-range"), Contains("missing-fibres")));
  EXPECT_THAT(found, Not(Contains("empty-phase")))
      << "what the first phase is meant to change is only misspelt";
  EXPECT_THROW(solve(p, {}), data::InputError);
}

TEST(Check, NamesTheNearestSurface) {
  Problem p = sound();
  p.conditions[0].surface = "x00";
  const auto found = check(p);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].message, "`left`: the mesh has no surface or node set named `x00`");
  EXPECT_EQ(found[0].help, "did you mean `x0`?");
}

TEST(Check, LoadsNeedFaces) {
  Problem p = sound();
  auto mesh = std::make_shared<data::Mesh>(*p.mesh);
  mesh->node_sets["tip"] = mesh->surface_points("x1");
  p.mesh = mesh;
  p.conditions[2].surface = "tip";
  EXPECT_THAT(errors_of(p), HasSubstr("`load`: `tip` is a set of nodes, and a load needs faces"));
  p.conditions[2] = {"load", "tip", PrescribedDisplacement{{0.001, 0.0, 0.0}}};
  EXPECT_THAT(check(p), Not(Contains(::testing::Field(&data::Diagnostic::code, "missing-surface"))));
}

TEST(Check, NamesTheRigidMotionsThatNothingHolds) {
  Problem p = sound();
  p.conditions = {{"plane", "x0", Fixed{{true, false, false}}}};
  p.programme = {{"activate", {}, {{p.mesh->regions.front(), 0.5}}, {}, 1, 1.0}};
  auto found = check(p);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].code, "unsupported-motion");
  EXPECT_EQ(found[0].message,
            "nothing holds the body against translation along y, translation along z, rotation about the "
            "axis along x through (0.01, 0.005, 0.005) m");

  p.conditions.push_back({"edge", "y0", Fixed{{false, true, false}}});
  found = check(p);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].message, "nothing holds the body against translation along z");

  // Nothing at all.
  p.conditions = {{"load", "y1", DeadTraction{{0.0, 10.0, 0.0}, false}}};
  EXPECT_THAT(errors_of(p), AllOf(HasSubstr("translation along x, translation along y, translation along z"),
                                  HasSubstr("rotation about the axis along z")));
}

TEST(Check, AHingeLeavesTheRotationAboutIt) {
  Problem p = sound();
  auto mesh = std::make_shared<data::Mesh>(*p.mesh);
  std::vector<int> line;
  for (const int n : mesh->surface_points("x0")) {
    if (mesh->points(2, n) == 0.0) line.push_back(n);
  }
  mesh->node_sets["hinge"] = line;  // along y at x = z = 0
  p.mesh = mesh;
  p.conditions = {{"hinge", "hinge", Fixed{}}};
  p.programme = {{"activate", {}, {{mesh->regions.front(), 0.5}}, {}, 1, 1.0}};
  EXPECT_THAT(errors_of(p),
              HasSubstr("nothing holds the body against rotation about the axis along y through (0, "));
}

TEST(Check, FindsThatAReleaseLeavesTheBodyFree) {
  Problem p = sound();
  p.programme.push_back({"let go", {}, {}, {"left", "right"}, 1, 1.0});
  EXPECT_THAT(errors_of(p), AllOf(HasSubstr("translation along x"),
                                  HasSubstr("once phase `let go` begins to release constraints")));
}

TEST(Check, FindsContradictoryConditions) {
  Problem p = sound();
  p.conditions.push_back({"other", "z0", Fixed{}});
  const auto found = check(p);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].code, "contradictory-conditions");
  EXPECT_THAT(found[0].message, AllOf(HasSubstr("`right` and `other` hold 3 nodes"),
                                      HasSubstr("phase `stretch` by up to 0.001 m")));
}

TEST(Check, DeadLoadsOnAHeldSurfaceAreFine) {
  Problem p = sound();
  p.conditions[2].surface = "x1";
  EXPECT_THAT(check(p), IsEmpty());
}

TEST(Check, FindsDoubledNamesAndThingsThatCannotMove) {
  Problem p = sound();
  p.conditions[2].name = "left";
  EXPECT_THAT(codes(check(p)), Contains("duplicate-condition"));
  p = sound();
  p.programme[0].amplitude["left"] = 1.0;
  EXPECT_THAT(errors_of(p), HasSubstr("moves `left`, which only holds and has no amplitude"));
  p = sound();
  p.programme[0].release = {"load"};
  EXPECT_THAT(errors_of(p), HasSubstr("releases `load`, which is a load"));
  p = sound();
  p.programme[1].amplitude["right"] = 1.0;  // where it stands already
  p.programme[1].activation.clear();
  EXPECT_THAT(errors_of(p), HasSubstr("phase `activate` changes nothing"));
}

TEST(Check, FindsFibresThatAreMissingOrNotUnit) {
  Problem p = sound();
  p.tissue.fibre.col(30).setZero();
  EXPECT_THAT(errors_of(p),
              HasSubstr("the fibres at 1 quadrature points are no unit vectors, first in cell 1 (length 0)"));
  p.tissue.fibre.resize(3, 5);
  EXPECT_THAT(errors_of(p), HasSubstr("`fibre` has 5 values, the cells have 54 quadrature points"));
}

TEST(Check, FindsElementsThatDoNotFit) {
  Problem p = sound();
  p.formulation = Formulation::q1_p0;
  EXPECT_THAT(codes(check(p)), Contains("cell-type-mismatch"));
  p = sound();
  p.formulation = Formulation::q2_displacement;
  p.materials[0].volumetric.bulk_modulus_pa = infinite;
  EXPECT_THAT(codes(check(p)), Contains("incompressible-displacement"));
}

TEST(Check, FindsAMeshThatFallsApart) {
  Problem p = sound();
  auto mesh = std::make_shared<data::Mesh>(*p.mesh);
  const Eigen::Index n = mesh->points.cols(), cells = mesh->cells.cols();
  mesh->points.conservativeResize(3, 2 * n);
  mesh->points.rightCols(n) = mesh->points.leftCols(n).colwise() + Eigen::Vector3d(0.1, 0.0, 0.0);
  mesh->cells.conservativeResize(mesh->cells.rows(), 2 * cells);
  mesh->cells.rightCols(cells) = mesh->cells.leftCols(cells).array() + static_cast<int>(n);
  mesh->region_of_cell.resize(static_cast<std::size_t>(2 * cells), 0);
  p.mesh = mesh;
  p.tissue.fibre = Eigen::Vector3d::UnitX().replicate(1, 27 * 2 * cells);
  EXPECT_THAT(errors_of(p),
              AllOf(HasSubstr("the mesh falls into 2 parts that share no points: 2 cells from cell 0"),
                    HasSubstr("the body's part 2")));
}

TEST(Check, FindsAnIncompressibleBodyWithoutAFreeSurface) {
  Problem p = body(Formulation::q2_q1_taylor_hood, {0.01, 0.01, 0.01}, 2, 2, 2,
                   {NeoHooke{1e4, false}, {VolumetricLaw::quadratic, infinite}});
  auto mesh = std::make_shared<data::Mesh>(*p.mesh);
  mesh->surfaces.push_back({"skin", data::boundary_faces(*mesh)});
  p.mesh = mesh;
  p.conditions = {{"skin", "skin", RigidMotion{{0.001, 0.0, 0.0}}}};
  p.programme = {{"move", {{"skin", 1.0}}, {}, {}, 1, 1.0}};
  EXPECT_THAT(codes(check(p)), Contains("pressure-undetermined"));
}

TEST(Check, OptionsOutOfRangeAreNamed) {
  SolveOptions o;
  o.linear_solver = "ldll";
  o.relative_residual = 0.0;
  try {
    solve(sound(), o);
    FAIL();
  } catch (const data::InputError& e) {
    EXPECT_EQ(e.diagnostics().size(), 2u);
    EXPECT_THAT(messages(e.diagnostics()), AllOf(HasSubstr("`relative_residual` must be in (0, 1)"),
                                                 HasSubstr("`linear_solver` cannot be `ldll`")));
  }
}

}  // namespace
}  // namespace brachium::fem
