#include "data/limb/inverse_dynamics.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <fstream>
#include <functional>
#include <numbers>
#include <sstream>

#include "data/io/scene_file.hpp"
#include "data/limb/chain.hpp"
#include "data/model/error.hpp"
#include "tests/support/paths.hpp"

namespace {
using namespace brachium;
using Eigen::Index;

constexpr double degree = std::numbers::pi / 180.0;
constexpr double g = limb::standard_gravity_m_per_s2;

limb::BodySet arm() {
  limb::BodySet set;
  set.bodies = {{"forearm", 1.2, 0.11, 0.006, 0.08, 0.01, 0.1, true},
                {"hand", 0.45, 0.32, 0.001, 0.10, 0.01, 0.2, true},
                {"dumbbell", 2.0, 0.33, 0.0, 0.02, 0.015, 0.0, false}};
  set.body_mass_relative_sd = 0.10;
  return set;
}

// A slow curl, 5 to 125 deg, ten seconds at 200 Hz, upper arm 10 deg forward.
struct Curl {
  static constexpr double rate = 200.0;
  Eigen::VectorXd q, qdot, qddot;
  Curl() : q(2000), qdot(2000), qddot(2000) {
    const double w = 2 * std::numbers::pi * 0.3, a = 60 * degree;
    for (Index i = 0; i < 2000; ++i) {
      const double t = static_cast<double>(i) / rate;
      q(i) = 65 * degree - a * std::cos(w * t);
      qdot(i) = a * w * std::sin(w * t);
      qddot(i) = a * w * w * std::cos(w * t);
    }
  }
};

TEST(InverseDynamics, EqualsThePlanarChainOnAPlanarCurl) {
  const Curl curl;
  const limb::PlanarChain chain({{arm(), 0.0}});
  limb::InverseDynamicsOptions options;
  options.cutoff_hz = 30.0;  // far above the motion
  const limb::JointMoment m =
      limb::inverse_dynamics_moment(limb::motion_from_angle(curl.q, Curl::rate, 10 * degree), arm(), options);
  limb::BaseMotion base;
  base.inclination_rad = 10 * degree;
  for (Index i = 100; i < 1900; ++i) {
    const double wanted = chain.inverse_dynamics(curl.q.segment(i, 1), curl.qdot.segment(i, 1),
                                                 curl.qddot.segment(i, 1), base)(0);
    ASSERT_NEAR(m.moment_N_m(i), wanted, 2e-5);
    ASSERT_NEAR(m.elevation_rad(i), curl.q(i) + 10 * degree, 1e-5);
  }
}

TEST(InverseDynamics, DoesNotDependOnTheWorldsAxesNorOnHowTheForearmWasRecorded) {
  const Curl curl;
  const limb::ForearmMotion planar = limb::motion_from_angle(curl.q, Curl::rate, 0.2);
  limb::InverseDynamicsOptions options;
  options.cutoff_hz = 6.0;
  const limb::JointMoment wanted = limb::inverse_dynamics_moment(planar, arm(), options);
  // The same motion in a world that is turned, as points and as quaternions of a segment with an odd long
  // axis.
  const Eigen::Quaterniond turn = Eigen::Quaterniond(0.3, -0.5, 0.7, 0.2).normalized();
  const Eigen::Vector3d up = turn * Eigen::Vector3d::UnitZ(),
                        own = Eigen::Vector3d(-0.04, -0.99, 0.13).normalized();
  Eigen::Matrix3Xd elbow(3, 2000), hand(3, 2000);
  Eigen::Matrix4Xd quaternion(4, 2000);
  for (Index i = 0; i < 2000; ++i) {
    const Eigen::Vector3d u = turn * Eigen::Vector3d(planar.direction.col(i));
    elbow.col(i) << 1.0, 2.0, 3.0;
    hand.col(i) = elbow.col(i) + 0.26 * u;
    const Eigen::Quaterniond q = Eigen::Quaterniond(Eigen::AngleAxisd(0.001 * static_cast<double>(i), u)) *
                                 Eigen::Quaterniond::FromTwoVectors(own, u);
    quaternion.col(i) = q.coeffs();  // x, y, z, w
  }
  const limb::ForearmMotion points = limb::motion_from_points(elbow, hand, Curl::rate, up);
  const limb::ForearmMotion turned = limb::motion_from_orientation(quaternion, Curl::rate, {own, up, true});
  EXPECT_LT((limb::inverse_dynamics_moment(points, arm(), options).moment_N_m - wanted.moment_N_m)
                .cwiseAbs()
                .maxCoeff(),
            1e-9);
  EXPECT_LT((limb::inverse_dynamics_moment(turned, arm(), options).moment_N_m - wanted.moment_N_m)
                .cwiseAbs()
                .maxCoeff(),
            1e-9);
  EXPECT_LT(limb::compare_directions(points.direction, turned.direction).worst_deg, 1e-6);
  const limb::LongAxisEstimate axis = limb::estimate_long_axis(quaternion, points.direction);
  EXPECT_LT((axis.long_axis - own).norm(), 1e-12);
  EXPECT_LT(axis.scatter_deg, 1e-6);
  // Read the wrong way round, the quaternion must not agree with the points.
  const limb::ForearmMotion wrong = limb::motion_from_orientation(quaternion, Curl::rate, {own, up, false});
  EXPECT_GT(limb::compare_directions(points.direction, wrong.direction).mean_deg, 10.0);
}

TEST(InverseDynamics, AnAcceleratingElbowAddsItsInertialForce) {
  // A forearm held horizontally on an elbow that is shaken vertically at 1 Hz, 20 mm: M = S (g + a).
  const Index n = 4000;
  Eigen::Matrix3Xd elbow(3, n), hand(3, n);
  const double w = 2 * std::numbers::pi;
  for (Index i = 0; i < n; ++i) {
    elbow.col(i) << 0.0, 0.0, 0.02 * std::sin(w * static_cast<double>(i) / 200.0);
    hand.col(i) = elbow.col(i) + Eigen::Vector3d(0.25, 0.0, 0.0);
  }
  limb::InverseDynamicsOptions options;
  options.cutoff_hz = 20.0;
  const limb::ForearmMotion motion = limb::motion_from_points(elbow, hand, 200.0);
  const limb::JointMoment m = limb::inverse_dynamics_moment(motion, arm(), options);
  const double s = arm().first_moment_kg_m();
  for (Index i = 400; i < n - 400; ++i) {
    const double a = -0.02 * w * w * std::sin(w * static_cast<double>(i) / 200.0);
    ASSERT_NEAR(m.moment_N_m(i), s * (g + a), 1e-4 * s);
  }
  options.use_elbow_acceleration = false;
  EXPECT_NEAR(limb::inverse_dynamics_moment(motion, arm(), options).moment_N_m(1000), s * g, 1e-12);
}

TEST(InverseDynamics, StaysContinuousWhereTheForearmHangsSidewaysOrPassesTheVertical) {
  // Mostly a forward curl; for a while the forearm swings on a cone about the vertical, 15 deg wide.
  const Curl curl;
  limb::ForearmMotion motion = limb::motion_from_angle(curl.q, Curl::rate, 0.0);
  for (Index i = 0; i < 400; ++i) {
    const double azimuth = 2 * std::numbers::pi * static_cast<double>(i) / 400.0, tilt = 15 * degree;
    motion.direction.col(1000 + i) << std::sin(tilt) * std::cos(azimuth), std::sin(tilt) * std::sin(azimuth),
        -std::cos(tilt);
  }
  limb::InverseDynamicsOptions options;
  options.cutoff_hz = 10.0;
  options.max_plane_deviation_rad = 20 * degree;
  const limb::JointMoment m = limb::inverse_dynamics_moment(motion, arm(), options);
  const double weight = arm().first_moment_kg_m() * g;
  EXPECT_EQ(m.out_of_plane_samples, 0);
  EXPECT_NEAR(m.plane_deviation_rad(1100), -15 * degree, 0.01) << "forward x up points to the other side";
  options.max_plane_deviation_rad = 10 * degree;
  const limb::JointMoment strict = limb::inverse_dynamics_moment(motion, arm(), options);
  EXPECT_GT(strict.out_of_plane_samples, 150);
  EXPECT_EQ(strict.usable(1100), 0.0);
  EXPECT_EQ(strict.usable(500), 1.0);
  EXPECT_EQ(strict.usable.sum(),
            static_cast<double>(2000 - strict.out_of_plane_samples - 2 * strict.edge_samples));
  for (Index i = 1040; i < 1360; ++i) {
    EXPECT_LT(std::abs(m.gravity_part_N_m(i) - m.gravity_part_N_m(i - 1)), 0.01 * weight);
    const double forward =
        std::sin(15 * degree) * std::cos(2 * std::numbers::pi * static_cast<double>(i - 1000) / 400.0);
    EXPECT_NEAR(m.gravity_part_N_m(i), weight * forward, 0.1 * weight);
  }
}

TEST(InverseDynamics, UncertaintyIsTheFirstOrderPropagationOfEveryAssumedNumber) {
  const Curl curl;
  const limb::ForearmMotion motion = limb::motion_from_angle(curl.q, Curl::rate, 0.0);
  const limb::InverseDynamicsOptions options;
  const limb::JointMoment m = limb::inverse_dynamics_moment(motion, arm(), options);
  // Numerical propagation: move one number by its standard uncertainty times 1e-4 and see what the moment
  // does.
  const double h = 1e-4;
  Eigen::VectorXd variance = Eigen::VectorXd::Zero(m.moment_N_m.size());
  const auto shift = [&](const auto& change) {
    limb::BodySet up = arm(), down = arm();
    change(up, h);
    change(down, -h);
    const Eigen::VectorXd d = (limb::inverse_dynamics_moment(motion, up, options).moment_N_m -
                               limb::inverse_dynamics_moment(motion, down, options).moment_N_m) /
                              (2 * h);
    variance += d.cwiseAbs2();
  };
  const auto scale_mass = [](limb::Body& b, double by) {
    b.mass_kg *= 1.0 + by;
    b.inertia_kg_m2 *= 1.0 + by;
  };
  for (std::size_t i = 0; i < 3; ++i) {
    shift([&](limb::BodySet& s, double e) { scale_mass(s.bodies[i], e * s.bodies[i].mass_relative_sd); });
    shift([&](limb::BodySet& s, double e) { s.bodies[i].distance_m += e * s.bodies[i].distance_sd_m; });
    shift([&](limb::BodySet& s, double e) {
      s.bodies[i].inertia_kg_m2 *= 1.0 + e * s.bodies[i].inertia_relative_sd;
    });
  }
  shift([&](limb::BodySet& s, double e) {
    for (limb::Body& b : s.bodies) {
      if (b.from_body_mass) scale_mass(b, e * s.body_mass_relative_sd);
    }
  });
  const Eigen::VectorXd wanted = variance.cwiseSqrt();
  EXPECT_LT((m.sd_N_m - wanted).cwiseAbs().maxCoeff(), 1e-7);
  ASSERT_FALSE(m.contributors.empty());
  double sum = 0.0;
  for (std::size_t i = 0; i < m.contributors.size(); ++i) {
    sum += m.contributors[i].rms_sd_N_m * m.contributors[i].rms_sd_N_m;
    if (i > 0) {
      EXPECT_LE(m.contributors[i].rms_sd_N_m, m.contributors[i - 1].rms_sd_N_m);
    }
  }
  EXPECT_NEAR(sum, m.sd_N_m.squaredNorm() / static_cast<double>(m.sd_N_m.size()), 1e-12);
  EXPECT_EQ(m.contributors[0].name,
            "distance of dumbbell");  // 2 kg x 15 mm; the body mass follows with 27.6 g m
  EXPECT_EQ(m.contributors[1].name, "body mass");
  EXPECT_EQ(limb::contributor_table(m).texts("assumed number").front(), "distance of dumbbell");
  const limb::ImpliedInclination upper_arm = limb::implied_inclination(motion, curl.q);
  EXPECT_NEAR(upper_arm.mean_rad, 0.0, 1e-12);
  EXPECT_LT(upper_arm.highest_rad - upper_arm.lowest_rad, 1e-12);
}

std::string message_of(const std::function<void()>& action) {
  try {
    action();
  } catch (const data::InputError& e) {
    return e.diagnostics().front().code + ": " + e.what();
  }
  return "nothing was thrown";
}

TEST(InverseDynamics, RefusesOrientationsAndPointsThatCannotBe) {
  Eigen::Matrix4Xd q = Eigen::Matrix4Xd::Zero(4, 3);
  q.row(3).setOnes();
  q(3, 1) = 0.9;
  EXPECT_EQ(message_of([&] { limb::motion_from_orientation(q, 200.0, {}); }),
            "bad-quaternion: the orientation at sample 1 has the norm 0.9, not 1");
  const Eigen::Matrix3Xd points = Eigen::Matrix3Xd::Ones(3, 3);
  EXPECT_EQ(message_of([&] { limb::motion_from_points(points, points, 200.0); }),
            "out-of-range: elbow and distal point are 0 mm apart at sample 0");
  EXPECT_EQ(message_of([&] { limb::motion_from_points(points, points.leftCols(2), 200.0); }),
            "wrong-size: 3 elbow points but 2 distal points");
}

TEST(InverseDynamics, PutsComponentsTogetherOnlyIfTheyShareAClock) {
  data::Signal x, y;
  x.info = {"elbow_x", data::Quantity::position, "m", 200.0, 0.0, 3, "", "", {}};
  x.samples = {1.0, 2.0, 3.0};
  y = x;
  y.info.name = "elbow_y";
  const std::vector<data::Signal> good{x, y};
  EXPECT_EQ(limb::stacked(good)(1, 2), 3.0);
  y.info.rate_hz = 100.0;
  const std::vector<data::Signal> bad{x, y};
  EXPECT_EQ(message_of([&] { limb::stacked(bad); }),
            "rates-disagree: signals `elbow_x` and `elbow_y` belong together, but differ in rate, start or "
            "length (200 and 100 Hz, 0 and "
            "0 s, 3 and 3 samples)");
}

// Columns after the time of one export of the recorder: two metadata rows, a blank line, a header row.
Eigen::MatrixXd read_export(const std::string& name, Index columns) {
  const std::string path = (tests::sessions_dir() /
                            "elbow_curls_noraxon/IMU/2021-06-08-13-13_CUBE elbow data collection_2.75_T_1" /
                            ("Noraxon MyoMotion-" + name + ".csv"))
                               .string();
  std::ifstream file(path);
  std::string line;
  for (int i = 0; i < 4; ++i) std::getline(file, line);
  std::vector<double> values;
  Index rows = 0;
  while (std::getline(file, line)) {
    std::istringstream cells(line);
    std::string cell;
    std::getline(cells, cell, ',');
    for (Index c = 0; c < columns; ++c) {
      std::getline(cells, cell, ',');
      values.push_back(std::stod(cell));
    }
    ++rows;
  }
  return Eigen::Map<Eigen::MatrixXd>(values.data(), columns, rows);
}

TEST(InverseDynamics, EqualsScipyOnARecordedCurl) {
  BRACHIUM_NEEDS_SESSIONS();
  const Eigen::Matrix3Xd elbow = read_export("Trajectories-Elbow RT", 3) * 1e-3;
  const Eigen::Matrix3Xd wrist = (read_export("Trajectories-Radial styloid process RT", 3) +
                                  read_export("Trajectories-Ulnar styloid process RT", 3)) *
                                 0.5e-3;
  const data::Scene scene = io::read_scene(tests::source_dir() / "pipelines/scenes/elbow.toml");
  const limb::BodySet bodies = limb::bodies_of(scene, "elbow_flexion", {{"load_mass_kg", 2.75 * 0.45359237}});
  const limb::ForearmMotion motion = limb::motion_from_points(elbow, wrist, 200.0);
  const limb::JointMoment m = limb::inverse_dynamics_moment(motion, bodies, {});
  // inverse_dynamics_reference.py, scipy 1.10
  const Index at[] = {0, 300, 1000, 2000, 4000, 5000};
  const double wanted[] = {0.5306655242091729, 0.7870677515491151, 3.195657905365131,
                           2.643101507111675,  1.7307001301327785, 2.289711384628688};
  for (int i = 0; i < 6; ++i) EXPECT_NEAR(m.moment_N_m(at[i]), wanted[i], 1e-9);
  EXPECT_NEAR(m.moment_N_m.mean(), 3.856759346382129, 1e-9);

  // The recorder's quaternion turns segment into world and agrees with its own trajectories about a long axis
  // that lies 8 deg beside the segment's -y axis.
  const Eigen::Matrix4Xd quaternion = read_export("Segments-Forearm RT-Orientation", 4);
  const limb::LongAxisEstimate axis = limb::estimate_long_axis(quaternion, motion.direction);
  EXPECT_NEAR(axis.long_axis(0), -0.045, 0.002);
  EXPECT_NEAR(axis.long_axis(1), -0.990, 0.001);
  EXPECT_NEAR(axis.long_axis(2), 0.136, 0.001);
  EXPECT_LT(axis.scatter_deg, 1.0);
  EXPECT_GT(limb::estimate_long_axis(quaternion, motion.direction, false).scatter_deg, 20.0);
  const limb::ForearmMotion turned =
      limb::motion_from_orientation(quaternion, 200.0, {axis.long_axis, {0, 0, 1}, true});
  EXPECT_LT(limb::compare_directions(turned.direction, motion.direction).worst_deg, 5.0);
}

}  // namespace
