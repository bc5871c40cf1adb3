// gamma_M and gamma_ST at quadrature points.

#include "fibre_cases.hpp"

namespace brachium::fem::test {
namespace {

TEST(Fractions, ComeFromRegionsAndAreTheDefaultElsewhere) {
  const data::Mesh mesh = two_regions();
  TissueRules rules;
  rules.muscle = {{{"left"}, 0.0}};
  rules.soft_tissue = {{{"right"}, 0.25}};
  const Tissue t = build(mesh, rules);
  EXPECT_EQ(t.field.fibre.cols(), 0);
  EXPECT_EQ(t.directions.rows(), 0u);
  for (int c = 0; c < mesh.cell_count(); ++c) {
    const bool left = mesh.region_of_cell[static_cast<std::size_t>(c)] == mesh.region("left");
    EXPECT_EQ(t.field.muscle[27 * c + 5], left ? 0.0 : 1.0);
    EXPECT_EQ(t.field.soft_tissue[27 * c + 5], left ? 0.0 : 0.25);
  }
  EXPECT_EQ(t.fractions.texts("tissue"), (std::vector<std::string>{"muscle", "soft tissue"}));
  EXPECT_NEAR(t.fractions.numbers("mean")[0], 0.5, 1e-14);
  EXPECT_NEAR(t.fractions.numbers("mean")[1], 0.125, 1e-14);
}

TEST(Fractions, OfPointsAreInterpolatedByTheCells) {
  for (data::CellType type : {data::CellType::hex8, data::CellType::hex27, data::CellType::tet10}) {
    data::Mesh mesh = as_type(block({1, 1, 1}, 2, 2, 2), type);
    mesh.point_fields["gamma"] = mesh.points.row(0) * 0.5 + mesh.points.row(2) * 0.3;
    TissueRules rules;
    rules.muscle = {{{}, std::string("gamma")}};
    const Tissue t = build(mesh, rules);
    const int n_q = static_cast<int>(t.field.muscle.size()) / mesh.cell_count();
    for (int k = 0; k < t.field.muscle.size(); ++k) {
      const Vector3d x = position(mesh, k / n_q, k % n_q);
      EXPECT_NEAR(t.field.muscle[k], 0.5 * x[0] + 0.3 * x[2], 1e-14);
    }
    EXPECT_EQ(t.fractions.numbers("points_brought_back")[0], 0.0);
    EXPECT_NEAR(t.fractions.numbers("mean")[0], 0.4, 1e-14);
  }
}

TEST(Fractions, OfCellsAreTheCellsOwn) {
  data::Mesh mesh = block({1, 1, 1}, 2, 1, 1);
  mesh.cell_fields["fat"] = (Eigen::RowVectorXd(2) << 0.2, 1.0).finished();
  TissueRules rules;
  rules.soft_tissue = {{{}, std::string("fat")}};
  const Tissue t = build(mesh, rules);
  EXPECT_EQ(t.field.soft_tissue[26], 0.2);
  EXPECT_EQ(t.field.soft_tissue[27], 1.0);
}

// A step from 0 to 1 within a quadratic cell overshoots between its points.
TEST(Fractions, ThatOvershootAreBroughtBackAndCounted) {
  data::Mesh mesh = block({1, 1, 1}, 1, 1, 1);
  mesh.point_fields["gamma"] = (mesh.points.row(0).array() > 0.4).cast<double>().matrix();
  TissueRules rules;
  rules.muscle = {{{}, std::string("gamma")}};
  const Tissue t = build(mesh, rules);
  EXPECT_EQ(t.field.muscle.maxCoeff(), 1.0);
  EXPECT_EQ(t.fractions.numbers("points_brought_back")[0], 9.0);  // those at xi = .77
}

TEST(Fractions, OutsideZeroToOneAreRefusedByPlace) {
  data::Mesh mesh = two_regions();
  TissueRules rules;
  rules.muscle = {{{}, 1.5}};
  EXPECT_EQ(complaint(mesh, rules).message, "the fraction of muscle is given as 1.5");
  mesh.cell_fields["g"] = Eigen::RowVectorXd::Constant(mesh.cell_count(), 1.0);
  mesh.cell_fields["g"](0, 3) = -0.1;
  rules.muscle = {{{}, std::string("g")}};
  const data::Diagnostic d = complaint(mesh, rules);
  EXPECT_EQ(d.code, "bad-fraction");
  EXPECT_EQ(d.message, "`g` at cell 3 is -0.1");
  rules.muscle = {{{}, std::string("gg")}};
  EXPECT_EQ(complaint(mesh, rules).code, "missing-mesh-field");
}

}  // namespace
}  // namespace brachium::fem::test
