// A block of side 50 (quarter model) under a dead load on a quarter of its top, nearly incompressible
// neo-Hooke; numbers of Ikarus (trilinear and Taylor-Hood cells) and of dolfinx (Q2/P1):
// tests/fem/reference/compressed_block.py. Top u_x = u_y = 0, symmetry at x = 0 and y = 0, bottom u_z = 0.

#include <cmath>

#include "fem/quantities/cell_state.hpp"
#include "tests/fem/verification/study.hpp"

namespace brachium::fem::verification {
namespace {

constexpr double mm = 1e-3, MPa = 1e6;

struct Compressed {
  double greatest_mm = 0.0;   ///< component of a displacement
  double checkerboard = 0.0;  ///< share of the pressure's variance that alternates from cell to cell
};

/// Share of the alternating mode (-1)^(i+j+k) in the cells' mean pressures, against their spread.
double checkerboard(const std::vector<double>& p, int n) {
  double mean = 0.0, alternating = 0.0, spread = 0.0;
  for (const double value : p) mean += value / static_cast<double>(p.size());
  for (std::size_t c = 0; c < p.size(); ++c) {
    const int i = static_cast<int>(c) % n, j = static_cast<int>(c) / n % n, k = static_cast<int>(c) / (n * n);
    alternating += ((i + j + k) % 2 == 0 ? 1.0 : -1.0) * (p[c] - mean);
    spread += (p[c] - mean) * (p[c] - mean);
  }
  return alternating * alternating / static_cast<double>(p.size()) / spread;
}

Compressed compress(Formulation formulation, int n) {
  const double mu = 1.61148 * MPa, lambda = 499.92568 * MPa;
  auto mesh = box_mesh(
      {.type = cell_type(formulation), .cells = {n, n, n}, .size_m = Eigen::Vector3d::Constant(50.0 * mm)});
  data::NamedSurface patch{"patch", {}};
  for (const data::CellFace& face : mesh->surface("z1").faces) {
    Eigen::Vector3d centre = Eigen::Vector3d::Zero();
    const auto nodes = data::face_nodes(mesh->type, face.face);
    for (const int a : nodes)
      centre += mesh->points.col(mesh->cells(a, face.cell)) / static_cast<double>(nodes.size());
    if (centre[0] < 25.0 * mm && centre[1] < 25.0 * mm) patch.faces.push_back(face);
  }
  mesh->surfaces.push_back(patch);
  Problem problem;
  problem.mesh = mesh;
  problem.formulation = formulation;
  problem.materials = {{NeoHooke{mu, true}, {VolumetricLaw::quadratic, lambda + 2.0 / 3.0 * mu}}};
  problem.conditions = {condition("top", "z1", Fixed{{true, true, false}}),
                        condition("x", "x0", SymmetryPlane{}), condition("y", "y0", SymmetryPlane{}),
                        condition("bottom", "z0", SymmetryPlane{}),
                        condition("load", "patch", DeadTraction{Eigen::Vector3d(0.0, 0.0, -9.0 * MPa)})};
  problem.programme = {phase("load", {{"load", 1.0}}, {}, 3)};
  SolveOptions options = tight(problem);
  options.relative_residual = 1e-9;
  options.stability = "off";
  const Solved solved = run(problem, options);
  Compressed result;
  if (!solved.summary.completed) return result;
  for (int i = 0; i < mesh->point_count(); ++i)
    result.greatest_mm =
        std::max(result.greatest_mm, solved.configuration.dofs.segment<3>(3 * i).cwiseAbs().maxCoeff() / mm);
  const CellStates states(problem, *solved.discretisation, solved.configuration);
  std::vector<double> pressures;
  for (int c = 0; c < mesh->cell_count(); ++c)
    pressures.push_back(states.at(c, Eigen::Vector3d::Zero()).pressure_pa);
  result.checkerboard = checkerboard(pressures, n);
  return result;
}

TEST(CompressedBlock, ConstantPressureCellsGiveThePublishedDisplacement) {
  EXPECT_NEAR(compress(Formulation::q1_p0, 2).greatest_mm, 45.08467250, 1e-6);
  EXPECT_NEAR(compress(Formulation::q1_p0, 4).greatest_mm, 41.32367771, 1e-6);
  EXPECT_NEAR(compress(Formulation::q1_p0, 8).greatest_mm, 40.56242425, 1e-6);
}

TEST(CompressedBlock, TaylorHoodCellsGiveThePublishedDisplacement) {
  EXPECT_NEAR(compress(Formulation::q2_q1_taylor_hood, 2).greatest_mm, 39.97523916, 1e-6);
  EXPECT_NEAR(compress(Formulation::q2_q1_taylor_hood, 4).greatest_mm, 39.92020798, 1e-6);
}

TEST(CompressedBlock, LinearPressureCellsAgreeWithAnIndependentCode) {
  EXPECT_NEAR(compress(Formulation::q2_p1_discontinuous, 2).greatest_mm, 37.70682567, 1e-6);
  EXPECT_NEAR(compress(Formulation::q2_p1_discontinuous, 4).greatest_mm, 40.13872277, 1e-6);
}

TEST(CompressedBlock, QuadraticCellsShowNoAlternatingPressure) {
  EXPECT_LT(compress(Formulation::q2_q1_taylor_hood, 4).checkerboard, 0.01);
  EXPECT_LT(compress(Formulation::q2_p1_discontinuous, 4).checkerboard, 0.01);
}

TEST(CompressedBlock, TheMeasureOfAlternationSeesAnAlternatingField) {
  std::vector<double> board, smooth;
  for (int c = 0; c < 64; ++c) {
    board.push_back((c % 4 + c / 4 % 4 + c / 16) % 2 == 0 ? 1.0 : -1.0);
    smooth.push_back(c % 4 + 0.3 * (c / 16));
  }
  EXPECT_NEAR(checkerboard(board, 4), 1.0, 1e-12);
  EXPECT_LT(checkerboard(smooth, 4), 1e-3);
}

}  // namespace
}  // namespace brachium::fem::verification
