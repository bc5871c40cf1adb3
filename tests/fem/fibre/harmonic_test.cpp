// Harmonic fibres where the harmonic function is known.

#include "fem/fibre/harmonic.hpp"

#include "fibre_cases.hpp"

namespace brachium::fem::test {
namespace {

constexpr data::CellType types[] = {data::CellType::hex8, data::CellType::hex27, data::CellType::tet10};

TEST(HarmonicFibres, AreExactInABlockWithDistortedCells) {
  for (data::CellType type : types) {
    data::Mesh mesh = block({2, 1, 1}, 3, 2, 2);
    for (int p = 0; p < mesh.point_count(); ++p) {  // inner points go astray
      const Vector3d x = mesh.points.col(p);
      const double bump = x[0] * (2 - x[0]) * x[1] * (1 - x[1]) * x[2] * (1 - x[2]);
      mesh.points.col(p) += bump * Vector3d(0.9, -1.1, 0.7);
    }
    mesh = as_type(mesh, type);
    const Tissue t = build(mesh, fibres({{}, HarmonicFibres{"x0", "x1", {}}}));
    EXPECT_LT(largest_angle(mesh, t.field.fibre, [](const Vector3d&) { return Vector3d::UnitX(); }), 1e-12);
    EXPECT_GT(t.field.fibre(0, 0), 0.0);  // from origin to insertion
    ASSERT_EQ(t.harmonic.rows(), 1u);
    EXPECT_NEAR(t.harmonic.numbers("smallest_gradient_per_m")[0], 0.5, 1e-12);
    EXPECT_NEAR(t.harmonic.numbers("largest_gradient_per_m")[0], 0.5, 1e-12);
  }
}

// phi = angle/90 degrees is harmonic between the ends of a quarter ring: fibres run around it, gradients fall
// from 1 to 1/2 over the radii, and angles converge with the order of the cells' gradients.
TEST(HarmonicFibres, RunAroundAQuarterRingToTheOrderOfTheCells) {
  const auto around = [](const Vector3d& x) { return Vector3d(-x[1], x[0], 0); };
  struct Expected {
    data::CellType type;
    double error, ratio;
  };
  for (const Expected& e :
       {Expected{data::CellType::hex8, 2e-2, 1.8}, Expected{data::CellType::hex27, 3e-4, 3.6},
        Expected{data::CellType::tet10, 5e-3, 3.3}}) {
    double before = 0.0;
    for (int n : {4, 8}) {
      const data::Mesh mesh = quarter_ring(n, 2 * n, e.type);
      const Tissue t = build(mesh, fibres({{}, HarmonicFibres{"y0", "y1", {}}}));
      const double error = largest_angle(mesh, t.field.fibre, around);
      if (n == 8) {
        EXPECT_LT(error, e.error) << to_string(e.type);
        EXPECT_GT(before / error, e.ratio) << to_string(e.type);
        const double quarter = std::numbers::pi / 2;
        EXPECT_NEAR(t.harmonic.numbers("largest_gradient_per_m")[0], 1 / quarter, 0.1);
        EXPECT_NEAR(t.harmonic.numbers("smallest_gradient_per_m")[0], 0.5 / quarter, 0.05);
      }
      before = error;
    }
  }
}

TEST(HarmonicFibres, ConvergeWithThirdOrderInTheFunctionItself) {
  double before = 0.0;
  for (int n : {2, 4}) {
    const data::Mesh mesh = quarter_ring(n, 2 * n, data::CellType::hex27);
    const CellPoints points(mesh, Formulation::q2_p1_discontinuous);
    std::vector<int> cells(static_cast<std::size_t>(mesh.cell_count()));
    for (std::size_t c = 0; c < cells.size(); ++c) cells[c] = static_cast<int>(c);
    const Eigen::VectorXd phi = harmonic_function(points, {"y0", "y1", {}}, cells);
    double error = 0.0;
    for (int p = 0; p < mesh.point_count(); ++p) {
      const double exact = std::atan2(mesh.points(1, p), mesh.points(0, p)) / (std::numbers::pi / 2);
      error = std::max(error, std::abs(phi[p] - exact));
    }
    if (before > 0.0) {
      EXPECT_GT(before / error, 7.0);
    }
    before = error;
  }
}

TEST(Pennation, TurnsFibresInItsPlane) {
  const data::Mesh mesh = block({1, 1, 1}, 1, 1, 1);
  const double angle = 20 * std::numbers::pi / 180;
  const Tissue t = build(mesh, fibres({{}, HarmonicFibres{"x0", "x1", Pennation{angle, {0, 0, 7}}}}));
  EXPECT_LT(largest_angle(mesh, t.field.fibre,
                          [&](const Vector3d&) { return Vector3d(std::cos(angle), std::sin(angle), 0); }),
            1e-13);
  EXPECT_EQ(complaint(mesh, fibres({{}, HarmonicFibres{"x0", "x1", Pennation{angle, {0, 0, 0}}}})).code,
            "bad-fibre");
}

TEST(HarmonicFibres, FillOnlyTheRegionsOfTheirRule) {
  data::Mesh mesh = two_regions();
  data::NamedSurface middle{"middle", {}};
  for (int c = 0; c < mesh.cell_count(); ++c) {  // the faces of `right` on x = 1
    const auto nodes = data::face_nodes(mesh.type, 0);
    if (std::abs(mesh.points(0, mesh.cells(nodes[8], c)) - 1.0) < 1e-12) middle.faces.push_back({c, 0});
  }
  mesh.surfaces.push_back(middle);
  const Tissue t = build(mesh, fibres({{"right"}, HarmonicFibres{"middle", "x1", {}}}));
  EXPECT_NEAR(t.harmonic.numbers("smallest_gradient_per_m")[0], 1.0, 1e-12);
  EXPECT_EQ(t.directions.texts("region"), std::vector<std::string>{"right"});
}

TEST(HarmonicFibres, RefuseEndsThatTouchAreUnknownOrAreNotOnTheBody) {
  data::Mesh mesh = two_regions();
  data::Diagnostic d = complaint(mesh, fibres({{}, HarmonicFibres{"x0", "y0", {}}}));
  EXPECT_EQ(d.code, "bad-harmonic-fibres");
  EXPECT_EQ(d.message.substr(0, 32), "surfaces `x0` and `y0` share poi");
  EXPECT_EQ(complaint(mesh, fibres({{}, HarmonicFibres{"x0", "X1", {}}})).code, "missing-surface");
  d = complaint(mesh, fibres({{"left"}, HarmonicFibres{"x0", "x1", {}}}));
  EXPECT_EQ(d.code, "bad-harmonic-fibres");
  EXPECT_EQ(d.message, "the part of the body with cell 0 does not touch `x1`");
}

// An arm that hangs on the side of a bar: without flux through its end the function is flat there.
TEST(HarmonicFibres, RefuseAPlaceWhereTheFunctionIsFlat) {
  const data::Mesh whole = block({3, 8, 1}, 3, 8, 1);
  data::Mesh mesh = whole;
  std::vector<int> kept;
  for (int c = 0; c < whole.cell_count(); ++c) {
    const Vector3d centre = whole.points.col(whole.cells(26, c));
    if (centre[1] < 1.0 || (centre[0] > 1.0 && centre[0] < 2.0)) kept.push_back(c);
  }
  mesh.cells.resize(27, static_cast<Eigen::Index>(kept.size()));
  mesh.region_of_cell.assign(kept.size(), 0);
  mesh.surfaces.clear();
  mesh.cell_fields.clear();
  for (std::size_t k = 0; k < kept.size(); ++k)
    mesh.cells.col(static_cast<Eigen::Index>(k)) = whole.cells.col(kept[k]);
  data::NamedSurface left{"left", {}}, right{"right", {}};
  for (int k = 0; k < mesh.cell_count(); ++k) {
    const Vector3d centre = mesh.points.col(mesh.cells(26, k));
    if (centre[0] < 1.0) left.faces.push_back({k, 0});
    if (centre[0] > 2.0) right.faces.push_back({k, 1});
  }
  mesh.surfaces = {left, right};
  const data::Diagnostic d = complaint(mesh, fibres({{}, HarmonicFibres{"left", "right", {}}}));
  EXPECT_EQ(d.code, "bad-fibre");
  EXPECT_NE(d.message.find("the harmonic function from `left` to `right` is flat in cell"), std::string::npos)
      << d.message;
}

}  // namespace
}  // namespace brachium::fem::test
