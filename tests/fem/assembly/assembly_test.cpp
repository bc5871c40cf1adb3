/// Internal forces and tangents of every formulation, on distorted meshes: forces are derivatives of the
/// energy, tangents of the forces; neither knows rigid motions; no thread count or instruction set changes
/// them.

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <cmath>
#include <limits>
#include <random>

#include "fem/assembly/assembly.hpp"
#include "fem/assembly/batch.hpp"
#include "fem/mesh/block.hpp"
#include "fem/mesh/convert.hpp"

namespace brachium::fem {
namespace {

constexpr Formulation all_formulations[] = {
    Formulation::q2_p1_discontinuous, Formulation::q2_q1_taylor_hood,    Formulation::q1_p0,
    Formulation::p2_p1_taylor_hood,   Formulation::p2b_p1_discontinuous, Formulation::q1_displacement,
    Formulation::q2_displacement};

/// Muscle with numbers of order one, so that all parts matter alike.
MuscleTendon muscle() {
  MuscleTendon m;
  m.muscle = {1.0, 0.4, 0.2, 6.0};
  m.tendon = {3.0, 0.1, 2.0, 4.0};
  m.max_stress_pa = 2.0;
  m.force_length = {1.2, 0.3, 3.0, 0.25, 4.0};
  return m;
}

std::shared_ptr<const data::Mesh> distorted_mesh(Formulation formulation, int n) {
  const data::CellType type = cell_type(formulation);
  data::Mesh mesh = block(Eigen::Vector3d(1.0, 0.8, 0.9), n, n, n, data::CellType::hex27);
  // A smooth map keeps the mesh conforming and makes edges curved.
  for (Eigen::Index p = 0; p < mesh.points.cols(); ++p) {
    const Eigen::Vector3d x = mesh.points.col(p);
    mesh.points.col(p) +=
        0.05 * Eigen::Vector3d(std::sin(2.0 * x[1] + x[2]), x[0] * x[2], std::cos(1.5 * x[0]) * x[1]);
  }
  return std::make_shared<const data::Mesh>(as_type(std::move(mesh), type));
}

TissueField tissue(const Discretisation& d) {
  TissueField field;
  const Eigen::Index n = static_cast<Eigen::Index>(d.cell_count()) * d.quadrature().size();
  field.fibre.resize(3, n);
  field.muscle.resize(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const Eigen::Vector3d x =
        d.position(static_cast<int>(i / d.quadrature().size()), static_cast<int>(i % d.quadrature().size()));
    field.fibre.col(i) = Eigen::Vector3d(1.0, 0.3 * x[1], 0.2 - x[0] * 0.1).normalized();
    field.muscle[i] = 0.2 + 0.6 * x[0];
  }
  return field;
}

struct Body {
  std::shared_ptr<const Discretisation> discretisation;
  std::unique_ptr<Assembly> assembly;
  Configuration state;
};

Body make(Formulation formulation, double bulk = 20.0, std::size_t threads = 1, int n = 2,
          const Material& material = muscle()) {
  Body b;
  b.discretisation = std::make_shared<const Discretisation>(distorted_mesh(formulation, n), formulation);
  const Discretisation& d = *b.discretisation;
  b.assembly = std::make_unique<Assembly>(
      b.discretisation, std::vector<RegionMaterial>{{material, {VolumetricLaw::quadratic, bulk}}}, tissue(d),
      15.0, threads);
  std::mt19937 random(7);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  b.state.dofs.resize(d.dof_count());
  for (int node = 0; node < d.node_count(); ++node) {
    const Eigen::Vector3d x =
        node < d.mesh().point_count() ? Eigen::Vector3d(d.mesh().points.col(node)) : Eigen::Vector3d::Zero();
    for (int i = 0; i < 3; ++i)
      b.state.dofs[3 * node + i] =
          (node < d.mesh().point_count() ? 0.1 * std::sin(x[(i + 1) % 3] + 0.3 * i) + 0.08 * x[i] : 0.0) +
          0.004 * uniform(random);
  }
  for (int k = 3 * d.node_count(); k < d.dof_count(); ++k) b.state.dofs[k] = 2.0 * uniform(random);
  if (d.pressures_per_cell() > 0 && d.pressure_node_count() == 0) {
    b.state.multiplier.resize(d.pressures_per_cell(), d.cell_count());
    for (double& m : b.state.multiplier.reshaped()) m = uniform(random);
  }
  b.state.activation = Eigen::VectorXd::Constant(1, 0.7);
  return b;
}

Eigen::MatrixXd dense(const Unknowns& u, const std::vector<double>& values) {
  Eigen::MatrixXd K = Eigen::MatrixXd::Zero(u.count(), u.count());
  for (int j = 0; j < u.count(); ++j) {
    for (int e = u.pattern.column_start[static_cast<std::size_t>(j)];
         e < u.pattern.column_start[static_cast<std::size_t>(j) + 1]; ++e) {
      K(u.pattern.row[static_cast<std::size_t>(e)], j) = values[static_cast<std::size_t>(e)];
      K(j, u.pattern.row[static_cast<std::size_t>(e)]) = values[static_cast<std::size_t>(e)];
    }
  }
  return K;
}

class EveryFormulation : public testing::TestWithParam<Formulation> {};
INSTANTIATE_TEST_SUITE_P(Assembly, EveryFormulation, testing::ValuesIn(all_formulations),
                         [](const auto& instance) { return to_string(instance.param); });

TEST_P(EveryFormulation, ForcesAreTheDerivativeOfTheEnergy) {
  const Body b = make(GetParam());
  Eigen::VectorXd force, other;
  ASSERT_FALSE(b.assembly->residual(b.state, force).failure);
  const double h = 1e-5;
  for (Eigen::Index k = 0; k < b.state.dofs.size(); k += 7) {
    Configuration c = b.state;
    c.dofs[k] += h;
    const double above = *b.assembly->residual(c, other, true).energy;
    c.dofs[k] -= 2.0 * h;
    const double below = *b.assembly->residual(c, other, true).energy;
    EXPECT_NEAR((above - below) / (2.0 * h), force[k], 2e-9) << "dof " << k;
  }
}

TEST_P(EveryFormulation, TangentIsTheDerivativeOfTheForces) {
  const Body b = make(GetParam());
  const Discretisation& d = *b.discretisation;
  const Unknowns u = number_unknowns(d, std::vector<char>(static_cast<std::size_t>(d.dof_count()), 0), {});
  Eigen::VectorXd force, plus, minus;
  std::vector<double> values;
  ASSERT_FALSE(b.assembly->tangent(b.state, u, force, values).failure);
  const Eigen::MatrixXd K = dense(u, values);
  const double h = 1e-5;
  double worst = 0.0, wrong = std::numeric_limits<double>::infinity();
  for (Eigen::Index k = 0; k < b.state.dofs.size(); k += 5) {
    Configuration c = b.state;
    c.dofs[k] += h;
    b.assembly->residual(c, plus);
    c.dofs[k] -= 2.0 * h;
    b.assembly->residual(c, minus);
    const Eigen::VectorXd difference = (plus - minus) / (2.0 * h);
    worst = std::max(worst, (difference - K.col(k)).norm());
    // The wrong twin: without the initial stress that a tangent owes to the pressure and the fibres.
    Configuration unstressed = b.state;
    unstressed.activation.setZero();
    std::vector<double> twin;
    if (k == 0) {
      b.assembly->tangent(unstressed, u, plus, twin);
      wrong = (difference - dense(u, twin).col(k)).norm();
    }
  }
  EXPECT_LT(worst, 1e-8 * K.norm());
  EXPECT_GT(wrong, 1e-5 * K.norm());
}

TEST_P(EveryFormulation, TangentAndResidualAgreeOnTheForces) {
  const Body b = make(GetParam());
  const Unknowns u = number_unknowns(
      *b.discretisation, std::vector<char>(static_cast<std::size_t>(b.discretisation->dof_count()), 0), {});
  Eigen::VectorXd one, two, three;
  std::vector<double> values;
  b.assembly->residual(b.state, one);
  b.assembly->tangent(b.state, u, two, values);
  b.assembly->residual(b.state, three, true);
  EXPECT_LT((one - two).norm(), 1e-13 * one.norm());
  EXPECT_LT((one - three).norm(), 1e-13 * one.norm());
}

TEST_P(EveryFormulation, RigidMotionFromRestIsFreeOfForce) {
  Body b = make(GetParam());
  const Discretisation& d = *b.discretisation;
  b.state.activation.setZero();
  b.state.multiplier.setZero();
  b.state.dofs.setZero();
  const Eigen::Matrix3d R =
      Eigen::AngleAxisd(1.1, Eigen::Vector3d(1.0, -2.0, 0.5).normalized()).toRotationMatrix();
  for (int n = 0; n < d.mesh().point_count(); ++n)
    b.state.dofs.segment<3>(3 * n) =
        (R - Eigen::Matrix3d::Identity()) * d.mesh().points.col(n) + Eigen::Vector3d(0.1, 2.0, -1.0);
  Eigen::VectorXd force;
  const Assembled sums = b.assembly->residual(b.state, force, true);
  ASSERT_FALSE(sums.failure);
  EXPECT_LT(force.norm(), 1e-12);
  EXPECT_NEAR(*sums.energy, 0.0, 1e-12);
  EXPECT_NEAR(sums.volume, d.volume(), 1e-12);
}

TEST_P(EveryFormulation, ForcesTurnWithTheBody) {
  const Body b = make(GetParam());
  const Discretisation& d = *b.discretisation;
  Configuration turned = b.state;
  const Eigen::Matrix3d R =
      Eigen::AngleAxisd(0.8, Eigen::Vector3d(1.0, 1.0, 0.2).normalized()).toRotationMatrix();
  const int points = d.mesh().point_count();
  for (int n = 0; n < d.node_count(); ++n) {  // a bubble's dofs are a vector without a place of its own
    const Eigen::Vector3d X = n < points ? Eigen::Vector3d(d.mesh().points.col(n)) : Eigen::Vector3d::Zero();
    turned.dofs.segment<3>(3 * n) = R * (X + b.state.dofs.segment<3>(3 * n)) - X;
  }
  Eigen::VectorXd force, other;
  b.assembly->residual(b.state, force);
  b.assembly->residual(turned, other);
  for (int n = 0; n < d.node_count(); ++n)
    EXPECT_LT((other.segment<3>(3 * n) - R * force.segment<3>(3 * n)).norm(), 1e-11) << "node " << n;
}

TEST_P(EveryFormulation, ThreadsDoNotChangeOneBit) {
  const Body one = make(GetParam(), 20.0, 1, 4), three = make(GetParam(), 20.0, 3, 4);
  const Unknowns u =
      number_unknowns(*one.discretisation,
                      std::vector<char>(static_cast<std::size_t>(one.discretisation->dof_count()), 0), {});
  Eigen::VectorXd a, b;
  std::vector<double> va, vb;
  const Assembled sa = one.assembly->tangent(one.state, u, a, va),
                  sb = three.assembly->tangent(three.state, u, b, vb);
  EXPECT_EQ(va, vb);
  EXPECT_TRUE(a == b);
  EXPECT_EQ(sa.volume, sb.volume);
  EXPECT_EQ(sa.cell_force_norm, sb.cell_force_norm);
}

TEST_P(EveryFormulation, InvertedCellIsNamedAndNothingIsHandedOn) {
  Body b = make(GetParam());
  const int node = b.discretisation->nodes_of_cell()(6, 3);
  b.state.dofs.segment<3>(3 * node).array() -= 2.0;
  Eigen::VectorXd force;
  const Assembled sums = b.assembly->residual(b.state, force);
  ASSERT_TRUE(sums.failure);
  EXPECT_LE(sums.failure->jacobian, 0.0);
  bool touches = false;
  for (int a = 0; a < b.discretisation->nodes_per_cell(); ++a)
    touches = touches || b.discretisation->nodes_of_cell()(a, sums.failure->cell) == node;
  EXPECT_TRUE(touches) << "cell " << sums.failure->cell;
}

TEST(Assembly, ViscousStressIsTheDerivativeOfItsPotentialAndVanishesAtRest) {
  // S = eta (C - C_n)/dt: its tangent by differences; at the state before, no force beyond the elastic.
  Body b = make(Formulation::q2_p1_discontinuous);
  const Discretisation& d = *b.discretisation;
  Configuration c = b.state;
  Eigen::VectorXd elastic, force, plus, minus;
  b.assembly->residual(c, elastic);
  c.viscosity_pa_s = 3.0;
  c.inverse_dt = 2.0;
  c.dofs_before = c.dofs;
  b.assembly->residual(c, force);
  EXPECT_LT((force - elastic).norm(), 1e-13 * elastic.norm());
  for (Eigen::Index k = 0; k < c.dofs.size(); ++k) c.dofs_before[k] *= 0.9;
  const Unknowns u = number_unknowns(d, std::vector<char>(static_cast<std::size_t>(d.dof_count()), 0), {});
  std::vector<double> values;
  b.assembly->tangent(c, u, force, values);
  EXPECT_GT((force - elastic).norm(), 1e-3 * elastic.norm());
  const Eigen::MatrixXd K = dense(u, values);
  const double h = 1e-5;
  for (Eigen::Index k = 0; k < c.dofs.size(); k += 41) {
    Configuration e = c;
    e.dofs[k] += h;
    b.assembly->residual(e, plus);
    e.dofs[k] -= 2.0 * h;
    b.assembly->residual(e, minus);
    EXPECT_LT(((plus - minus) / (2.0 * h) - K.col(k)).norm(), 1e-8 * K.norm()) << k;
  }
}

TEST(Assembly, FramesTurnTheTangent) {
  const Body b = make(Formulation::q2_q1_taylor_hood);
  const Discretisation& d = *b.discretisation;
  const std::vector<char> held(static_cast<std::size_t>(d.dof_count()), 0);
  Eigen::Matrix3Xd frames(3, 3 * d.node_count());
  for (int n = 0; n < d.node_count(); ++n) {
    frames.middleCols<3>(3 * n) =
        n % 3 == 0
            ? Eigen::AngleAxisd(0.1 * n, Eigen::Vector3d(1.0, 0.5, n % 2).normalized()).toRotationMatrix()
            : Eigen::Matrix3d::Identity();
  }
  const Unknowns plain = number_unknowns(d, held, {}), framed = number_unknowns(d, held, frames);
  Eigen::VectorXd force;
  std::vector<double> values, turned;
  b.assembly->tangent(b.state, plain, force, values);
  b.assembly->tangent(b.state, framed, force, turned);
  Eigen::MatrixXd Q = Eigen::MatrixXd::Identity(d.dof_count(), d.dof_count());
  for (int n = 0; n < d.node_count(); ++n) Q.block<3, 3>(3 * n, 3 * n) = frames.middleCols<3>(3 * n);
  const Eigen::MatrixXd expected = Q.transpose() * dense(plain, values) * Q;
  EXPECT_LT((dense(framed, turned) - expected).norm(), 1e-12 * expected.norm());
  EXPECT_LT((framed.restrict(force) - Q.transpose() * force).norm(), 1e-12 * force.norm());
  EXPECT_LT((framed.extend(Q.transpose() * force) - force).norm(), 1e-12 * force.norm());
}

TEST(Assembly, PressureOfACondensedCellIsItsBulkModulusTimesItsDilation) {
  Body b = make(Formulation::q2_p1_discontinuous, 7.0);
  const Discretisation& d = *b.discretisation;
  b.state.multiplier.setZero();
  for (int n = 0; n < d.mesh().point_count(); ++n)
    b.state.dofs.segment<3>(3 * n) = 0.1 * d.mesh().points.col(n);
  const Eigen::MatrixXd p = b.assembly->pressures(b.state);
  EXPECT_LT((p.row(0).array() - 7.0 * (1.1 * 1.1 * 1.1 - 1.0)).abs().maxCoeff(), 1e-12);
  EXPECT_LT(p.bottomRows(3).cwiseAbs().maxCoeff(), 1e-11);
}

TEST(Kernel, PortableAndVectorVersionsAgree) {
  if (choose_kernel() == choose_kernel(true)) GTEST_SKIP() << "this processor has the portable kernel only";
  constexpr int points = 27, nodes = 27, padded = 28, pressures = 4;
  std::mt19937 random(3);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  const auto fill = [&](std::size_t n, double base, double spread) {
    std::vector<LaneBlock> v(n);
    for (LaneBlock& block : v) {
      for (double& x : block.lane) x = base + spread * uniform(random);
    }
    return v;
  };
  std::vector<LaneBlock> gradient = fill(points * padded * 3, 0.0, 0.5), weight = fill(points, 0.02, 0.01),
                         u = fill(padded * 3, 0.0, 0.01);
  std::vector<LaneBlock> fibre(points * 3), muscle_share = fill(points, 0.5, 0.3),
                                            soft = fill(points, 0.1, 0.1),
                                            phi = fill(points * pressures, 0.0, 1.0);
  for (std::size_t q = 0; q < points; ++q) {
    for (int l = 0; l < lanes; ++l) {
      const Eigen::Vector3d a = Eigen::Vector3d(uniform(random), uniform(random), 1.0).normalized();
      for (int i = 0; i < 3; ++i) fibre[3 * q + static_cast<std::size_t>(i)].lane[l] = a[i];
    }
  }
  std::vector<LaneBlock> mass_inverse = fill(pressures * pressures, 0.0, 0.1),
                         pressure = fill(pressures, 0.0, 1.0);
  const Material material = muscle();
  KernelInput in;
  in.nodes = nodes, in.padded_nodes = padded, in.points = points, in.pressures = pressures;
  in.gradient = gradient.data(), in.weight = weight.data(), in.displacement = u.data(),
  in.fibre = fibre.data();
  in.muscle = muscle_share.data(), in.soft_tissue = soft.data(), in.pressure_shape = phi.data(),
  in.mass_inverse = mass_inverse.data();
  in.pressure = pressure.data(), in.activation = 0.6, in.material = &material;
  in.volume.pressure = KernelVolume::Pressure::discontinuous, in.volume.modulus = 10.0;
  const auto run = [&](Kernel kernel) {
    std::vector<LaneBlock> force(padded * 3), cell(pressures), K(9 * nodes * (nodes + 1) / 2),
        B(3 * pressures * nodes), scratch(kernel_scratch_size(in));
    KernelOutput out;
    out.force = force.data(), out.cell_pressure = cell.data(), out.tangent = K.data(),
    out.coupling = B.data(), out.scratch = scratch.data();
    kernel(in, out);
    std::vector<double> all;
    for (const std::vector<LaneBlock>* list : {&force, &cell, &K}) {
      for (const LaneBlock& block : *list) all.insert(all.end(), block.lane, block.lane + lanes);
    }
    return all;
  };
  const std::vector<double> a = run(choose_kernel()), b = run(choose_kernel(true));
  double scale = 0.0;
  for (const double x : b) scale = std::max(scale, std::abs(x));
  for (std::size_t i = 0; i < a.size(); ++i) ASSERT_NEAR(a[i], b[i], 1e-12 * scale) << i;
}

}  // namespace
}  // namespace brachium::fem
