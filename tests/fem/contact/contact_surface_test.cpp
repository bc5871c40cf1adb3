/// Contact forces and tangents: derivatives of the energy, balance, and a wrong twin.

#include <Eigen/Geometry>
#include <cmath>

#include "fem/contact/contact_surface.hpp"
#include "fem/mesh/block.hpp"
#include "fem/mesh/convert.hpp"

namespace brachium::fem {
namespace {

using Eigen::Vector3d;

struct Body {
  std::shared_ptr<const Discretisation> discretisation;
  Eigen::VectorXd dofs;
};

Body body(Formulation formulation) {
  data::Mesh mesh =
      as_type(block(Vector3d(1.0, 1.0, 1.0), 2, 2, 2, data::CellType::hex27), cell_type(formulation));
  Body b;
  b.discretisation = std::make_shared<const Discretisation>(
      std::make_shared<const data::Mesh>(std::move(mesh)), formulation);
  b.dofs = Eigen::VectorXd::Zero(b.discretisation->dof_count());
  for (int n = 0; n < b.discretisation->mesh().point_count(); ++n) {
    const Vector3d X = b.discretisation->mesh().points.col(n);
    b.dofs.segment<3>(3 * n) =
        0.03 * Vector3d(std::sin(3.0 * X[1]), std::cos(2.0 * X[2]), std::sin(2.0 * X[0] + X[1]));
  }
  return b;
}

const Sphere ball{Vector3d(0.4, 0.55, 1.7), 0.85};

class EveryCell : public testing::TestWithParam<Formulation> {};
INSTANTIATE_TEST_SUITE_P(Contact, EveryCell,
                         testing::Values(Formulation::q2_p1_discontinuous, Formulation::q1_p0,
                                         Formulation::p2_p1_taylor_hood),
                         [](const auto& instance) { return to_string(instance.param); });

TEST_P(EveryCell, PressureAtTheMeshesPointsHasTheContactForceOfPenaltyAndMultipliers) {
  const Body b = body(GetParam());
  // Against a plane the force is the integral of the pressure.
  const ContactSurface contact(*b.discretisation, "z1",
                               HalfSpace{Vector3d(0.0, 0.0, 1.0), Vector3d(0.0, 0.0, -1.0)}, {500.0, 0.0, 4});
  const Eigen::VectorXd lambda = Eigen::VectorXd::LinSpaced(contact.point_count(), 0.0, 40.0);
  for (const Eigen::VectorXd& multiplier : {Eigen::VectorXd(), lambda}) {
    Eigen::VectorXd force = Eigen::VectorXd::Zero(b.dofs.size());
    const double expected = contact.add_force(b.dofs, {}, multiplier, force).force_n.norm();
    ASSERT_GT(expected, 0.0);
    const NodalPressure at = contact.at_mesh_points(b.dofs, {}, multiplier);
    EXPECT_NEAR(at.area_m2.dot(at.pressure_pa), expected, 1e-12 * expected);
    EXPECT_NEAR(at.area_m2.sum(), 1.0, 1e-12) << "m2, of the face";
    EXPECT_GE(at.pressure_pa.minCoeff(), 0.0);
  }
  // An even pressure is the same at every point.
  const NodalPressure even = contact.at_mesh_points(Eigen::VectorXd::Zero(b.dofs.size()), {},
                                                    Eigen::VectorXd::Constant(contact.point_count(), 30.0));
  for (Eigen::Index p = 0; p < even.area_m2.size(); ++p)
    if (even.area_m2[p] > 0.0) {
      EXPECT_NEAR(even.pressure_pa[p], 30.0, 1e-11);
    }
}

TEST_P(EveryCell, ForceIsTheDerivativeOfTheEnergyAndTheTangentOfTheForce) {
  const Body b = body(GetParam());
  for (const bool multipliers : {false, true}) {
    const ContactSurface contact(*b.discretisation, "z1", ball, {500.0, multipliers ? 0.0 : 0.02, 3});
    Eigen::VectorXd lambda;
    if (multipliers) lambda = Eigen::VectorXd::LinSpaced(contact.point_count(), 0.0, 40.0);
    Eigen::VectorXd force = Eigen::VectorXd::Zero(b.dofs.size());
    const ContactSums sums = contact.add_force(b.dofs, {}, lambda, force);
    ASSERT_GT(sums.active_points, 5);
    ASSERT_LT(sums.active_points, sums.points);
    Eigen::MatrixXd K = Eigen::MatrixXd::Zero(b.dofs.size(), b.dofs.size());
    for (const FaceTangent& face : contact.tangent(b.dofs, {}, lambda)) {
      for (std::size_t a = 0; a < face.nodes.size(); ++a) {
        for (std::size_t c = 0; c < face.nodes.size(); ++c) {
          K.block<3, 3>(3 * face.nodes[a], 3 * face.nodes[c]) +=
              face.values.block<3, 3>(3 * static_cast<Eigen::Index>(a), 3 * static_cast<Eigen::Index>(c));
        }
      }
    }
    EXPECT_LT((K - K.transpose()).norm(), 1e-12 * K.norm());
    const double h = 1e-6;
    double worst = 0.0;
    for (Eigen::Index k = 0; k < b.dofs.size(); ++k) {
      Eigen::VectorXd x = b.dofs, plus = Eigen::VectorXd::Zero(x.size()), minus = plus;
      x[k] += h;
      const double above = contact.add_force(x, {}, lambda, plus).energy_j;
      x[k] -= 2.0 * h;
      const double below = contact.add_force(x, {}, lambda, minus).energy_j;
      EXPECT_NEAR(-(above - below) / (2.0 * h), force[k], 1e-6 * force.norm()) << "dof " << k;
      worst = std::max(worst, ((plus - minus) / (2.0 * h) - K.col(k)).norm());
    }
    // Points on the edge of contact change sides within the difference: a plain penalty's tangent jumps
    // there.
    EXPECT_LT(worst, 1e-5 * K.norm());
  }
}

TEST(Contact, TheOppositeSignOfTheCurvatureFails) {
  // The tangent's geometric part is t/r across the normal; with the wrong sign it is off by 2 t/r.
  const Body b = body(Formulation::q1_p0);
  const ContactSurface contact(*b.discretisation, "z1", ball, {500.0, 0.02, 3});
  Eigen::VectorXd force = Eigen::VectorXd::Zero(b.dofs.size()), plus = force, minus = force;
  contact.add_force(b.dofs, {}, {}, force);
  Eigen::VectorXd direction = Eigen::VectorXd::Zero(b.dofs.size());
  for (int n = 0; n < b.discretisation->mesh().point_count(); ++n)
    direction[3 * n] = 1.0;  // along the surface
  double right = 0.0, wrong = 0.0;
  for (const FaceTangent& face : contact.tangent(b.dofs, {}, {})) {
    for (Eigen::Index a = 0; a < face.values.rows(); a += 3) {
      for (Eigen::Index c = 0; c < face.values.cols(); c += 3) right += face.values(a, c);
    }
  }
  const ContactPoints points = contact.points(b.dofs, {}, {});
  for (Eigen::Index q = 0; q < points.pressure_pa.size(); ++q)
    wrong += 2.0 * points.area_m2[q] * points.pressure_pa[q] *
             distance(ball, points.position_m.col(q)).hessian(0, 0);
  const double h = 1e-6;
  contact.add_force(b.dofs + h * direction, {}, {}, plus);
  contact.add_force(b.dofs - h * direction, {}, {}, minus);
  const double difference = direction.dot(plus - minus) / (2.0 * h);
  EXPECT_NEAR(difference, right, 1e-6 * std::abs(right));
  EXPECT_GT(std::abs(difference - (right - wrong)), 1e-2 * std::abs(right));
}

TEST(Contact, ForcesOnNodesSumToTheResultantAndItsMoment) {
  const Body b = body(Formulation::q2_p1_discontinuous);
  const ContactSurface contact(*b.discretisation, "z1", ball, {500.0, 0.0, 4});
  Eigen::VectorXd force = Eigen::VectorXd::Zero(b.dofs.size());
  const ContactSums sums = contact.add_force(b.dofs, {}, {}, force);
  Vector3d total = Vector3d::Zero(), moment = total;
  for (int n = 0; n < b.discretisation->mesh().point_count(); ++n) {
    const Vector3d f = force.segment<3>(3 * n),
                   x = b.discretisation->mesh().points.col(n) + b.dofs.segment<3>(3 * n);
    total += f;
    moment += x.cross(f);
  }
  EXPECT_LT((total - sums.force_n).norm(), 1e-12 * total.norm());
  EXPECT_LT((moment - sums.moment_n_m).norm(), 1e-12 * moment.norm());
  EXPECT_LT(sums.force_n[2], 0.0);  // the ball above presses down
  EXPECT_NEAR(sums.greatest_penetration_m * 500.0, sums.greatest_pressure_pa, 1e-12);
}

TEST(Contact, UniformPenetrationGivesPressureTimesArea) {
  const Body b = body(Formulation::q2_p1_discontinuous);
  const ContactSurface contact(*b.discretisation, "z1",
                               HalfSpace{Vector3d(0.0, 0.0, 0.99), -Vector3d::UnitZ()}, {1e3, 0.0, 3});
  const Eigen::VectorXd rest = Eigen::VectorXd::Zero(b.dofs.size());
  Eigen::VectorXd force = rest;
  const ContactSums sums = contact.add_force(rest, {}, {}, force);
  EXPECT_NEAR(sums.force_n[2], -10.0, 1e-11);
  EXPECT_NEAR(sums.area_m2, 1.0, 1e-13);
  EXPECT_NEAR(contact.least_gap_m(rest, {}), -0.01, 1e-14);
}

TEST(Contact, RefusesOptionsOutsideTheirRange) {
  const Body b = body(Formulation::q1_p0);
  const auto code = [&](const std::string& surface, const ContactOptions& options) {
    try {
      const ContactSurface contact(*b.discretisation, surface, ball, options);
    } catch (const data::InputError& e) {
      return e.diagnostics()[0].code;
    }
    return std::string("accepted");
  };
  EXPECT_EQ(code("z1", {0.0, 0.0, 3}), "contact-option");
  EXPECT_EQ(code("z1", {1.0, -1.0, 3}), "contact-option");
  EXPECT_EQ(code("z1", {1.0, 0.0, 6}), "contact-option");
  EXPECT_EQ(code("top", {1.0, 0.0, 3}), "missing-surface");
}

}  // namespace
}  // namespace brachium::fem
