// Fibres that are constant, that the mesh brings along, and along mesh lines; figures about them.

#include "fem/mesh/cylinder.hpp"
#include "fibre_cases.hpp"

namespace brachium::fem::test {
namespace {

TEST(ConstantFibres, AreUnitVectorsEverywhereWhateverTheLengthGiven) {
  for (data::CellType type : {data::CellType::hex8, data::CellType::hex27, data::CellType::tet10}) {
    const data::Mesh mesh = as_type(block({1, 1, 1}, 2, 2, 2), type);
    const Tissue t = build(mesh, fibres({{}, ConstantFibres{{3, 0, 4}}}));
    EXPECT_LT(largest_angle(mesh, t.field.fibre, [](const Vector3d&) { return Vector3d(0.6, 0, 0.8); }),
              1e-15);
    EXPECT_EQ(t.field.muscle.size(), 0);
    EXPECT_EQ(t.field.soft_tissue.size(), 0);
  }
}

TEST(ConstantFibres, LeaveRegionsWithoutARuleAtZero) {
  const data::Mesh mesh = two_regions();
  const Tissue t = build(mesh, fibres({{"right"}, ConstantFibres{{0, 1, 0}}}));
  for (int c = 0; c < mesh.cell_count(); ++c) {
    const bool right = mesh.region_of_cell[static_cast<std::size_t>(c)] == mesh.region("right");
    EXPECT_EQ(t.field.fibre.col(27 * c).norm(), right ? 1.0 : 0.0);
  }
  EXPECT_EQ(t.directions.texts("region"), std::vector<std::string>{"right"});
}

TEST(FibresOfCells, AreTheCellsOwn) {
  data::Mesh mesh = block({1, 1, 1}, 2, 1, 1);
  mesh.cell_fields["fibre"] = (Eigen::Matrix3Xd(3, 2) << 1, 0, 0, 0.8, 0, 0.6).finished();
  const Tissue t = build(mesh, fibres({{}, MeshFieldFibres{"fibre"}}));
  EXPECT_EQ(t.field.fibre.col(3), Vector3d(1, 0, 0));
  EXPECT_LT((t.field.fibre.col(27 + 3) - Vector3d(0, 0.8, 0.6)).norm(), 1e-15);
}

// Fibres around the axis of a ring, given at points: interpolation is exact in angle to the order of the
// cells.
TEST(FibresOfPoints, AreInterpolatedAndNormalised) {
  const auto around = [](const Vector3d& x) { return Vector3d(-x[1], x[0], 0); };
  double before = 0.0;
  for (int n : {4, 8}) {
    data::Mesh mesh = quarter_ring(n / 2, n, data::CellType::hex27);
    Eigen::MatrixXd a(3, mesh.point_count());
    for (int p = 0; p < mesh.point_count(); ++p) a.col(p) = around(mesh.points.col(p)).normalized();
    mesh.point_fields["fibre"] = a;
    const double error =
        largest_angle(mesh, build(mesh, fibres({{}, MeshFieldFibres{"fibre"}})).field.fibre, around);
    EXPECT_LT(error, 1e-3);
    if (before > 0.0) {
      EXPECT_GT(before / error, 7.0);  // third order
    }
    before = error;
  }
}

TEST(FibresOfPoints, CountAsAxes) {
  data::Mesh mesh = block({1, 1, 1}, 2, 2, 2);
  Eigen::MatrixXd a = Vector3d(0, 0.6, 0.8).replicate(1, mesh.point_count());
  for (int p = 0; p < mesh.point_count(); p += 3) a.col(p) *= -1.0;
  mesh.point_fields["fibre"] = a;
  const Tissue t = build(mesh, fibres({{}, MeshFieldFibres{"fibre"}}));
  EXPECT_LT(largest_angle(mesh, t.field.fibre, [](const Vector3d&) { return Vector3d(0, 0.6, 0.8); }), 1e-15);
}

TEST(FibresOfPoints, AreTakenWhereCellsHaveTheSameField) {
  const data::Mesh mesh = spindle([] {
    SpindleOptions o;
    o.belly = {0.1, 4};
    o.belly_radius_m = 0.02, o.tendon_radius_m = 0.01;
    return o;
  }());
  ASSERT_TRUE(mesh.point_fields.contains("fibre") && mesh.cell_fields.contains("fibre"));
  const Tissue t = build(mesh, fibres({{}, MeshFieldFibres{"fibre"}}));
  double spread = 0.0;  // within one cell
  for (int q = 1; q < 27; ++q)
    spread = std::max(spread, (t.field.fibre.col(q) - t.field.fibre.col(0)).norm());
  EXPECT_GT(spread, 1e-3);
}

TEST(MeshLines, OfACylinderRunAlongItOrAroundIt) {
  CylinderOptions o;
  o.radius_m = 0.5;
  o.z = {2.0, 3};
  const data::Mesh mesh = cylinder(o);
  const Tissue t = build(mesh, fibres({{}, MeshLineFibres{2}}));
  EXPECT_LT(largest_angle(mesh, t.field.fibre, [](const Vector3d&) { return Vector3d::UnitZ(); }), 1e-14);
}

TEST(MeshLines, OfARingFollowItsCurvature) {
  const data::Mesh mesh = quarter_ring(2, 6, data::CellType::hex27, false);
  const auto around = [](const Vector3d& x) { return Vector3d(-x[1], x[0], 0); };
  EXPECT_LT(largest_angle(mesh, build(mesh, fibres({{}, MeshLineFibres{1}})).field.fibre, around), 4e-3);
  EXPECT_LT(largest_angle(mesh, build(mesh, fibres({{}, MeshLineFibres{0}})).field.fibre,
                          [](const Vector3d& x) { return Vector3d(x[0], x[1], 0); }),
            4e-3);
}

TEST(DirectionTable, TellsMeanAlignmentAndAngles) {
  data::Mesh mesh = block({1, 1, 1}, 2, 1, 1);  // two cells, fibres 20 degrees to either side of x
  const double s = std::sin(std::numbers::pi / 9), c = std::cos(std::numbers::pi / 9);
  mesh.cell_fields["fibre"] = (Eigen::Matrix3Xd(3, 2) << c, -c, s, s, 0, 0).finished();
  const data::Table table = build(mesh, fibres({{}, MeshFieldFibres{"fibre"}})).directions;
  ASSERT_EQ(table.rows(), 1u);
  EXPECT_EQ(table.numbers("points")[0], 54);
  EXPECT_NEAR(table.numbers("volume_m3")[0], 1.0, 1e-14);
  EXPECT_NEAR(table.numbers("mean_x")[0], 1.0, 1e-14);
  EXPECT_NEAR(table.numbers("mean_y")[0], 0.0, 1e-14);
  EXPECT_NEAR(table.numbers("alignment")[0], c * c, 1e-14);
  for (const char* angle : {"angle_rms_deg", "angle_min_deg", "angle_max_deg"}) {
    EXPECT_NEAR(table.numbers(angle)[0], 20.0, 1e-12) << angle;
  }
}

TEST(FibreRules, RefuseDirectionsThatAreNone) {
  data::Mesh mesh = block({1, 1, 1}, 1, 1, 1);
  data::Diagnostic d = complaint(mesh, fibres({{}, ConstantFibres{}}));
  EXPECT_EQ(d.code, "bad-fibre");
  EXPECT_EQ(d.message, "a constant fibre direction has length 0");

  mesh.cell_fields["fibre"] = Vector3d(0, 0.5, 0);
  EXPECT_EQ(complaint(mesh, fibres({{}, MeshFieldFibres{"fibre"}})).message,
            "`fibre` at cell 0 has length 0.5");
  Eigen::MatrixXd a = Vector3d::UnitX().replicate(1, mesh.point_count());
  a.col(13).setZero();
  mesh.point_fields["direction"] = a;
  EXPECT_EQ(complaint(mesh, fibres({{}, MeshFieldFibres{"direction"}})).message,
            "`direction` at point 13 has length 0");
  a.col(13)[1] = std::numeric_limits<double>::quiet_NaN();
  mesh.point_fields["direction"] = a;
  EXPECT_EQ(complaint(mesh, fibres({{}, MeshFieldFibres{"direction"}})).message,
            "`direction` at point 13 has length nan");
}

TEST(FibreRules, RefuseDirectionsThatCancelWithinACell) {
  data::Mesh mesh = block({1, 1, 1}, 1, 1, 1);
  Eigen::MatrixXd a(3, mesh.point_count());
  for (int p = 0; p < mesh.point_count();
       ++p) {  // 170 degrees from layer to layer, between them at the first point
    const bool middle = std::abs(mesh.points(0, p) - 0.5) < 0.1, first = p == mesh.cells(0, 0);
    const double angle = first ? 0.0 : (middle ? -85.0 : 85.0) * std::numbers::pi / 180;
    a.col(p) = Vector3d(std::cos(angle), std::sin(angle), 0);
  }
  mesh.point_fields["fibre"] = a;
  const data::Diagnostic d = complaint(mesh, fibres({{}, MeshFieldFibres{"fibre"}}));
  EXPECT_EQ(d.code, "bad-fibre");
  EXPECT_EQ(d.message,
            "directions `fibre` at the points of cell 0 differ so much that they cancel inside it");
}

TEST(FibreRules, NameTheNearestFieldOrRegion) {
  data::Mesh mesh = two_regions();
  mesh.cell_fields["fibre"] = Vector3d::UnitX().replicate(1, mesh.cell_count());
  data::Diagnostic d = complaint(mesh, fibres({{}, MeshFieldFibres{"fiber"}}));
  EXPECT_EQ(d.code, "missing-mesh-field");
  EXPECT_EQ(d.message, "the mesh has no field `fiber`");
  EXPECT_EQ(d.help, "did you mean `fibre`?");
  d = complaint(mesh, fibres({{"rigth"}, ConstantFibres{{1, 0, 0}}}));
  EXPECT_EQ(d.code, "missing-region");
  EXPECT_EQ(d.help, "did you mean `right`?");
}

TEST(FibreRules, RefuseFieldsOfTheWrongShapeTwoRulesForARegionAndOtherCells) {
  data::Mesh mesh = two_regions();
  mesh.cell_fields["fibre"] = Eigen::MatrixXd::Ones(2, mesh.cell_count());
  EXPECT_EQ(complaint(mesh, fibres({{}, MeshFieldFibres{"fibre"}})).code, "bad-mesh-field");
  TissueRules twice = fibres({{"left"}, ConstantFibres{{1, 0, 0}}});
  twice.fibres.push_back({{}, ConstantFibres{{1, 0, 0}}});
  EXPECT_EQ(complaint(mesh, twice).message, "two rules give fibres of region `left`");
  EXPECT_EQ(complaint(split_into_tetrahedra(mesh), fibres({{}, MeshLineFibres{0}})).code, "bad-fibre");
  EXPECT_EQ(complaint(mesh, fibres({{}, MeshLineFibres{3}})).message, "a cell has no axis 3");
  EXPECT_THROW(build_tissue(mesh, Formulation::q1_p0, {}), data::InputError);
}

}  // namespace
}  // namespace brachium::fem::test
