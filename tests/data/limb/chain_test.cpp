#include "data/limb/chain.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "data/model/error.hpp"

namespace {
using namespace brachium;
using Eigen::VectorXd;

constexpr double g = limb::standard_gravity_m_per_s2;
constexpr double pi = std::numbers::pi;

limb::Link link(double mass, double distance, double inertia, double length = 0.0) {
  limb::Link l;
  l.bodies.bodies = {{"b", mass, distance, inertia, 0.0, 0.0, 0.0, false}};
  l.length_m = length;
  return l;
}

VectorXd vec(std::initializer_list<double> values) {
  VectorXd v(static_cast<Eigen::Index>(values.size()));
  Eigen::Index i = 0;
  for (const double x : values) v(i++) = x;
  return v;
}

TEST(PlanarChain, OneHingeIsTheCompoundPendulum) {
  const limb::PlanarChain chain({link(1.5, 0.12, 0.007)});
  const double inertia = 0.007 + 1.5 * 0.12 * 0.12, s = 1.5 * 0.12;
  for (const double q : {-0.4, 0.0, 0.7, 1.9}) {
    const double wanted = inertia * 3.0 + s * g * std::sin(q);
    EXPECT_NEAR(chain.inverse_dynamics(vec({q}), vec({2.0}), vec({3.0}))(0), wanted, 1e-14);
    EXPECT_NEAR(chain.gravity_moment(vec({q}))(0), -s * g * std::sin(q), 1e-14);
    EXPECT_NEAR(chain.forward_dynamics(vec({q}), vec({2.0}), vec({wanted}))(0), 3.0, 1e-12);
  }
  // An upper arm raised forward to the horizontal, elbow straight: the forearm lies horizontally.
  limb::BaseMotion raised;
  raised.inclination_rad = pi / 2;
  EXPECT_NEAR(chain.gravity_moment(vec({0.0}), raised)(0), -s * g, 1e-14);
  // A hinge in free fall carries no weight.
  limb::BaseMotion falling;
  falling.hinge_acceleration_m_per_s2 = {0.0, -g};
  EXPECT_NEAR(chain.inverse_dynamics(vec({1.0}), vec({0.0}), vec({0.0}), falling)(0), 0.0, 1e-14);
}

// Two point masses at the links' ends; angles from the horizontal (Craig, Introduction to Robotics, 3rd ed.,
// eq. 6.58).
VectorXd craig(double m1, double m2, double l1, double l2, const VectorXd& t, const VectorXd& td,
               const VectorXd& tdd) {
  const double c2 = std::cos(t(1)), s2 = std::sin(t(1)), c1 = std::cos(t(0)), c12 = std::cos(t(0) + t(1));
  const double tau1 = m2 * l2 * l2 * (tdd(0) + tdd(1)) + m2 * l1 * l2 * c2 * (2 * tdd(0) + tdd(1)) +
                      (m1 + m2) * l1 * l1 * tdd(0) - m2 * l1 * l2 * s2 * td(1) * td(1) -
                      2 * m2 * l1 * l2 * s2 * td(0) * td(1) + m2 * l2 * g * c12 + (m1 + m2) * l1 * g * c1;
  const double tau2 = m2 * l1 * l2 * c2 * tdd(0) + m2 * l1 * l2 * s2 * td(0) * td(0) + m2 * l2 * g * c12 +
                      m2 * l2 * l2 * (tdd(0) + tdd(1));
  return vec({tau1, tau2});
}

TEST(PlanarChain, TwoHingesAreTheTextbookManipulator) {
  const double m1 = 2.1, m2 = 1.3, l1 = 0.31, l2 = 0.27;
  const limb::PlanarChain chain({link(m1, l1, 0.0, l1), link(m2, l2, 0.0)});
  for (int i = 0; i < 20; ++i) {
    const VectorXd q = VectorXd::Random(2) * 2.0, qdot = VectorXd::Random(2) * 5.0,
                   qddot = VectorXd::Random(2) * 20.0;
    const VectorXd moment = chain.inverse_dynamics(q, qdot, qddot);
    EXPECT_LT((moment - craig(m1, m2, l1, l2, vec({q(0) - pi / 2, q(1)}), qdot, qddot)).norm(), 1e-12);
    EXPECT_LT((chain.forward_dynamics(q, qdot, moment) - qddot).norm(), 1e-10);
    const VectorXd wrong = vec({qdot(0), -qdot(1)});
    EXPECT_GT((chain.inverse_dynamics(q, wrong, qddot) - moment).norm(), 1e-6)
        << "a wrong sign of a rate must show";
  }
}

TEST(PlanarChain, PassiveTripleChainKeepsItsEnergy) {
  const limb::PlanarChain chain(
      {link(1.9, 0.14, 0.012, 0.30), link(1.2, 0.11, 0.006, 0.25), link(0.45, 0.07, 0.001)});
  VectorXd q = vec({1.2, 0.8, -0.5}), v = vec({0.5, -1.0, 2.0});
  const VectorXd none = VectorXd::Zero(3);
  const auto energy = [&] { return chain.kinetic_energy_J(q, v) + chain.potential_energy_J(q); };
  const double start = energy();
  const double h = 1e-3;
  for (int step = 0; step < 2000; ++step) {  // classical Runge-Kutta
    const VectorXd a1 = chain.forward_dynamics(q, v, none), v2 = v + 0.5 * h * a1;
    const VectorXd a2 = chain.forward_dynamics(q + 0.5 * h * v, v2, none), v3 = v + 0.5 * h * a2;
    const VectorXd a3 = chain.forward_dynamics(q + 0.5 * h * v2, v3, none), v4 = v + h * a3;
    const VectorXd a4 = chain.forward_dynamics(q + h * v3, v4, none);
    q += h / 6.0 * (v + 2.0 * v2 + 2.0 * v3 + v4);
    v += h / 6.0 * (a1 + 2.0 * a2 + 2.0 * a3 + a4);
  }
  EXPECT_NEAR(energy(), start, 1e-7 * std::abs(start));
}

TEST(PlanarChain, GravityAndForcesAreDerivativesOfTheirPotentials) {
  const limb::PlanarChain chain({link(1.9, 0.14, 0.012, 0.30), link(1.2, 0.11, 0.006)});
  limb::BaseMotion base;
  base.inclination_rad = 0.3;
  const VectorXd q = vec({0.4, 1.1});
  const std::vector<limb::PointForce> forces{{1, 0.2, {3.0, -7.0}}, {0, 0.15, {-2.0, 1.0}}};
  // Work of a constant force is force times displacement of its point.
  const auto work = [&](const VectorXd& at) {
    const auto u = [](double phi) { return Eigen::Vector2d(std::sin(phi), -std::cos(phi)); };
    const double p1 = 0.3 + at(0), p2 = p1 + at(1);
    return forces[0].force_N.dot(0.30 * u(p1) + 0.2 * u(p2)) + forces[1].force_N.dot(0.15 * u(p1));
  };
  const double h = 1e-6;
  const Eigen::MatrixXd stiffness = chain.gravity_stiffness(q, base);
  for (Eigen::Index j = 0; j < 2; ++j) {
    VectorXd up = q, down = q;
    up(j) += h;
    down(j) -= h;
    EXPECT_NEAR(chain.gravity_moment(q, base)(j),
                -(chain.potential_energy_J(up, base) - chain.potential_energy_J(down, base)) / (2 * h), 1e-8);
    EXPECT_NEAR(chain.force_moment(q, forces, base)(j), (work(up) - work(down)) / (2 * h), 1e-8);
    EXPECT_LT(
        (stiffness.col(j) - (chain.gravity_moment(up, base) - chain.gravity_moment(down, base)) / (2 * h))
            .norm(),
        1e-8);
  }
  EXPECT_LT((chain.inverse_dynamics(q, vec({0, 0}), vec({0, 0}), base, forces) +
             chain.gravity_moment(q, base) + chain.force_moment(q, forces, base))
                .norm(),
            1e-13);
}

TEST(PlanarChain, IsBuiltFromASceneWithItsHeldLoad) {
  data::Scene scene;
  scene.body_mass_relative_sd = 0.1;
  scene.coordinates.resize(2);
  scene.coordinates[0].name = "elbow";
  scene.coordinates[1].name = "wrist";
  scene.coordinates[1].parent = "elbow";
  scene.coordinates[1].distance_from_parent_m = 0.25;
  scene.segments.resize(2);
  scene.segments[0] = {"forearm", "elbow", 1.2, 0.1, 0.11, 0.006, "s", 0.016, 0.0, 0.0};
  scene.segments[1] = {"hand", "wrist", 0.45, 0.1, 0.07, 0.001, "s", 0.006, 0.0, 0.0};
  scene.loads.resize(1);
  scene.loads[0] = {"dumbbell", "wrist", 0.0, "load_mass_kg", 0.0, 0.08, 0.0, "s"};
  const limb::PlanarChain chain = limb::chain_of(scene, {{"load_mass_kg", 2.0}});
  ASSERT_EQ(chain.size(), 2u);
  EXPECT_NEAR(chain.gravity_moment(vec({pi / 2, 0.0}))(0), -g * (1.2 * 0.11 + 0.45 * 0.32 + 2.0 * 0.33),
              1e-13);
  EXPECT_NEAR(chain.gravity_moment(vec({pi / 2, 0.0}))(1), -g * (0.45 * 0.07 + 2.0 * 0.08), 1e-13);
  const auto message = [&](const std::map<std::string, double>& conditions) {
    try {
      limb::chain_of(scene, conditions, "curl-1");
    } catch (const data::InputError& e) {
      return data::render(e.diagnostics());
    }
    return std::string();
  };
  EXPECT_EQ(message({{"load_mas_kg", 2.0}}),
            "error[missing-condition]: load `dumbbell` takes its mass from the condition `load_mass_kg`, "
            "which trial `curl-1` does "
            "not give\n  help: did you mean `load_mas_kg`?\n");
  EXPECT_EQ(message({{"load_mass_kg", -1.0}}),
            "error[out-of-range]: the mass of `dumbbell` must be 0 kg or greater, not -1\n");
}

TEST(PlanarChain, RefusesWhatDoesNotFit) {
  const limb::PlanarChain chain({link(1.0, 0.1, 0.01)});
  EXPECT_THROW(chain.gravity_moment(vec({0.0, 0.0})), data::InputError);
  EXPECT_THROW(chain.gravity_moment(vec({std::nan("")})), data::InputError);
  EXPECT_THROW(limb::PlanarChain({link(0.0, 0.1, 0.0)}), data::InputError);
  EXPECT_THROW(limb::PlanarChain({link(1.0, 0.1, 0.01, 0.0), link(1.0, 0.1, 0.01)}), data::InputError);
}

}  // namespace
