#include "data/limb/dynamometer.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <random>

#include "data/model/error.hpp"

namespace {
using namespace brachium;
using Eigen::Index;
using Eigen::VectorXd;

constexpr double degree = std::numbers::pi / 180.0;
constexpr double rate = 500.0;

limb::BodySet arm() {
  limb::BodySet set;
  set.bodies = {{"forearm", 1.2, 0.11, 0.006, 0.0, 0.0, 0.0, false},
                {"hand", 0.45, 0.32, 0.001, 0.0, 0.0, 0.0, false}};
  return set;
}

// A synthetic machine whose angle counts extension from a zero of its own and whose torque is positive for
// extension.
struct Machine {
  limb::DynamometerLayout layout{-1, 2.5, -1, 0.7};
  std::vector<double> angle, velocity, torque;

  void add(double q, double qdot, double limb_on_machine) {
    angle.push_back(2.5 - q);
    velocity.push_back(-qdot);
    torque.push_back(0.7 - limb_on_machine);
  }
  limb::DynamometerRecord record(bool with_velocity, double cutoff_hz = 10.0) const {
    return limb::joint_record(angle,
                              with_velocity ? std::span<const double>(velocity) : std::span<const double>(),
                              torque, rate, layout, cutoff_hz);
  }
};

constexpr double arm_moment = 0.35;  // first moment of the machine's arm [kg m]

// Moment of gravity on limb and machine arm, written out here once more.
double gravity(double q, double inclination) {
  return -9.80665 * (1.2 * 0.11 + 0.45 * 0.32 + arm_moment) * std::sin(q + inclination);
}

// A slow sweep 10 -> 130 -> 10 deg of a relaxed limb, with measurement noise of 0.05 N m and friction of 0.2
// N m.
Machine passive_sweep(double inclination, double noise, double friction) {
  Machine m;
  std::mt19937 random(7);
  std::normal_distribution<double> normal(0.0, 1.0);
  const double period = 24.0;
  for (int i = 0; i < static_cast<int>(period * rate); ++i) {
    const double t = i / rate, w = 2 * std::numbers::pi / period;
    const double q = 70 * degree - 60 * degree * std::cos(w * t), qdot = 60 * degree * w * std::sin(w * t);
    m.add(q, qdot, gravity(q, inclination) - friction * (qdot > 0 ? 1 : -1) + noise * normal(random));
  }
  return m;
}

TEST(Dynamometer, PassiveSweepGivesTheGravityOfLimbAndMachineArm) {
  const double inclination = 20 * degree;
  const limb::GravityModel of_limb = limb::gravity_from_limb(arm(), inclination),
                           of_machine = limb::gravity_from_machine_arm(arm_moment, inclination);
  const limb::GravityModel clean = limb::fit_gravity(passive_sweep(inclination, 0.0, 0.0).record(true));
  for (const double q : {10.0, 60.0, 130.0}) {
    EXPECT_NEAR(of_limb(q * degree) + of_machine(q * degree), gravity(q * degree, inclination), 1e-12);
    EXPECT_NEAR(clean(q * degree), gravity(q * degree, inclination), 1e-10);
  }
  EXPECT_LT(clean.rms_residual_N_m, 1e-10);
  const limb::GravityModel noisy = limb::fit_gravity(passive_sweep(inclination, 0.05, 0.2).record(true));
  EXPECT_NEAR(noisy.rms_residual_N_m, std::hypot(0.05, 0.2), 0.01);
  for (const double q : {10.0, 60.0, 130.0})
    EXPECT_NEAR(noisy(q * degree), gravity(q * degree, inclination), 0.02);
  EXPECT_GT(noisy.condition_number, 1.0);
  EXPECT_LT(noisy.condition_number, 50.0);
}

// Isokinetic flexion at 60 deg/s with smooth ramps of 0.2 s; the muscles give a known moment.
struct Isokinetic {
  static constexpr double speed = 60 * degree, ramp = 0.2, run = 1.5, rest = 0.5;
  Machine machine;
  VectorXd truth;
  double inertia = arm().inertia_kg_m2() + 0.08;
  explicit Isokinetic(double inclination) {
    const int n = static_cast<int>((2 * rest + 2 * ramp + run) * rate);
    truth.resize(n);
    double q = 10 * degree;
    for (int i = 0; i < n; ++i) {
      const double t = i / rate;
      const auto blend = [](double s) {
        return s <= 0 ? 0.0 : s >= 1 ? 1.0 : s * s * s * (10 - 15 * s + 6 * s * s);
      };
      const auto slope = [](double s) { return s <= 0 || s >= 1 ? 0.0 : 30 * s * s * (1 - s) * (1 - s); };
      const double up = (t - rest) / ramp, down = (t - rest - ramp - run) / ramp;
      const double qdot = speed * (blend(up) - blend(down)), qddot = speed / ramp * (slope(up) - slope(down));
      truth(i) = 25.0 + 10.0 * std::sin(2.0 * q);
      machine.add(q, qdot, truth(i) + gravity(q, inclination) - inertia * qddot);
      q += qdot / rate;  // accurate enough: the angle enters only through gravity
    }
  }
};

TEST(Dynamometer, IsokineticMomentIsRecoveredWithInertiaAndTheRampsAreExcluded) {
  const double inclination = 0.1;
  const Isokinetic test(inclination);
  const limb::GravityModel of_limb = limb::gravity_from_limb(arm(), inclination),
                           of_machine = limb::gravity_from_machine_arm(arm_moment, inclination);
  for (const bool measured : {true, false}) {
    const limb::DynamometerRecord record =
        test.machine.record(measured, 20.0);  // a ramp of 0.2 s needs more than 10 Hz
    EXPECT_EQ(record.velocity_measured, measured);
    const limb::DynamometerMoment with = limb::dynamometer_moment(
        record, {of_limb, arm().inertia_kg_m2()}, {of_machine, test.inertia - arm().inertia_kg_m2()});
    const limb::DynamometerMoment without =
        limb::dynamometer_moment(record, {of_limb, 0.0}, {of_machine, 0.0});
    const auto phases = limb::isokinetic_phases(record, {Isokinetic::speed, 0.05, 0.1});
    ASSERT_EQ(phases.size(), 1u);
    EXPECT_NEAR(phases[0].mean, Isokinetic::speed, 0.005);
    EXPECT_NEAR(static_cast<double>(phases[0].last - phases[0].first) / rate, 1.5, 0.15);
    const VectorXd mask = limb::phase_mask(phases, test.truth.size());
    double inside_with = 0.0, inside = 0.0, ramps_with = 0.0, ramps_without = 0.0;
    for (Index i = record.edge_samples; i < test.truth.size() - record.edge_samples; ++i) {
      const double off_with = std::abs(with.moment_N_m(i) - test.truth(i)),
                   off_without = std::abs(without.moment_N_m(i) - test.truth(i));
      if (mask(i) > 0.5) {
        inside = std::max(inside, off_without);
        inside_with = std::max(inside_with, off_with);
      } else {
        ramps_with = std::max(ramps_with, off_with);
        ramps_without = std::max(ramps_without, off_without);
      }
    }
    EXPECT_LT(ramps_with, 0.10 * ramps_without) << "the inertial term must explain the ramps";
    EXPECT_GT(ramps_without, 1.0);
    // Where the blend has reached 95 % of the speed its slope is 0.71, and 0.77 one sample before: so much of
    // the ramps' ends the window lets in.
    EXPECT_LT(inside, 0.77 * test.inertia * Isokinetic::speed / Isokinetic::ramp);
    EXPECT_LT(inside_with, 0.1 * inside) << "the inertial term takes it out";
  }
}

TEST(Dynamometer, FindsIsometricHoldsAndNothingElse) {
  Machine m;
  std::mt19937 random(3);
  std::normal_distribution<double> normal(0.0, 0.1);
  const auto plateau = [](double t, double start, double end, double level) {
    const double rise = std::min(1.0, std::max(0.0, (t - start) / 0.4)),
                 fall = std::min(1.0, std::max(0.0, (end - t) / 0.4));
    return level * std::min(rise, fall);
  };
  for (int i = 0; i < static_cast<int>(16 * rate); ++i) {
    const double t = i / rate;
    m.add(90 * degree, 0.0,
          plateau(t, 1, 5, 30) + plateau(t, 7, 10, -18) + plateau(t, 12, 12.9, 25) + normal(random));
  }
  const auto holds = limb::isometric_holds(m.record(false), {});
  ASSERT_EQ(holds.size(), 2u) << "the third is too short";
  EXPECT_NEAR(holds[0].mean, 30.0, 0.3);
  EXPECT_NEAR(holds[1].mean, -18.0, 0.3);
  EXPECT_NEAR(static_cast<double>(holds[0].first) / rate, 1.4, 0.1);
  EXPECT_NEAR(static_cast<double>(holds[0].last) / rate, 4.6, 0.1);
}

TEST(Dynamometer, AxisOffsetIsCorrectedToFirstOrder) {
  // A pad force F normal to the machine's arm at distance l: the moment about a joint centre that lies beside
  // the axis.
  limb::AxisOffset axis{0.010, -0.015, 0.005, 0.28};
  for (const double q : {0.0, 0.8, 2.0}) {
    const Eigen::Vector2d r(std::cos(q), std::sin(q)), t(-r(1), r(0)), e(0.010, -0.015);
    const double torque = 20.0, force = torque / 0.28;
    const Eigen::Vector2d lever = 0.28 * r - e;
    const double about_joint = lever(0) * force * t(1) - lever(1) * force * t(0);
    EXPECT_NEAR(axis.moment_factor(q) * torque, about_joint, 1e-12);
    const double joint_angle = std::atan2(lever(1), lever(0));
    const double second_order = e.squaredNorm() / (0.28 * 0.28);
    EXPECT_NEAR(axis.angle_correction_rad(q), std::remainder(joint_angle - q, 2 * std::numbers::pi),
                second_order);
    EXPECT_GT(std::abs(axis.angle_correction_rad(q)), 2.0 * second_order)
        << "the correction must exceed what it neglects";
  }
  EXPECT_DOUBLE_EQ(axis.moment_relative_sd(), 0.005 / 0.28);
  const Isokinetic test(0.0);
  const limb::DynamometerRecord record = test.machine.record(true);
  const limb::DynamometerMoment m =
      limb::dynamometer_moment(record, {limb::gravity_from_limb(arm(), 0.0)}, {}, axis);
  EXPECT_NEAR(m.sd_N_m(900), 0.005 / 0.28 * std::abs(record.torque_N_m(900)), 1e-12);
}

TEST(Dynamometer, ALimbBesideTheAxisWeighsAndTurnsAtItsOwnAngleTheMachinesArmAtTheMachines) {
  // The exact motion of a joint centre e beside the axis, with the pad on the machine's arm at l, up to second order.
  const double l = 0.30, along = 2e-4, across = -3e-4, inertia = 0.06, machine_inertia = 0.05, muscles = 17.0;
  const limb::AxisOffset axis{along, across, 0.0, l};
  const limb::GravityModel of_limb = limb::gravity_from_limb(arm(), 0.0),
                           of_machine = limb::gravity_from_machine_arm(arm_moment, 0.0);
  const Eigen::Vector2d e(along, across);
  const auto machine_angle = [](double t) { return 1.0 + 0.6 * std::sin(2.0 * t); };
  const auto joint_angle = [&](double t) {
    const double q = machine_angle(t);
    const Eigen::Vector2d lever = l * Eigen::Vector2d(std::cos(q), std::sin(q)) - e;
    return std::atan2(lever(1), lever(0));
  };
  const auto second = [](const auto& f, double t) { return (f(t + 1e-4) - 2 * f(t) + f(t - 1e-4)) / 1e-8; };
  constexpr int n = 40;
  limb::DynamometerRecord record;
  record.rate_hz = 50.0;
  for (VectorXd* v :
       {&record.angle_rad, &record.velocity_rad_per_s, &record.acceleration_rad_per_s2, &record.torque_N_m})
    v->resize(n);
  for (int i = 0; i < n; ++i) {
    const double t = i / record.rate_hz, q = machine_angle(t), joint = joint_angle(t);
    const Eigen::Vector2d r(std::cos(q), std::sin(q)), tangent(-r(1), r(0)), lever = l * r - e;
    // Of the limb: I q'' = M + G(q) - (pad force's moment about the joint); the pad force is normal to the machine's arm.
    const double about_joint = muscles + of_limb(joint) - inertia * second(joint_angle, t);
    const double force = about_joint / (lever(0) * tangent(1) - lever(1) * tangent(0));
    record.angle_rad(i) = q;
    record.velocity_rad_per_s(i) = 1.2 * std::cos(2.0 * t);
    record.acceleration_rad_per_s2(i) = -2.4 * std::sin(2.0 * t);
    record.torque_N_m(i) = l * force + of_machine(q) - machine_inertia * record.acceleration_rad_per_s2(i);
  }
  const auto worst = [&](const limb::DynamometerMoment& m) {
    return (m.moment_N_m.array() - muscles).abs().maxCoeff();
  };
  const double offset = std::hypot(along, across) / l;
  const double right =
      worst(limb::dynamometer_moment(record, {of_limb, inertia}, {of_machine, machine_inertia}, axis));
  EXPECT_LT(right, 40.0 * offset * offset);
  // The whole weight and inertia on the machine's side: wrong to first order.
  limb::GravityModel both = of_machine;
  both.cos_N_m += of_limb.cos_N_m;
  both.sin_N_m += of_limb.sin_N_m;
  EXPECT_GT(worst(limb::dynamometer_moment(record, {}, {both, machine_inertia + inertia}, axis)),
            10.0 * right);
}

std::string message_of(const std::function<void()>& action) {
  try {
    action();
  } catch (const data::InputError& e) {
    return e.diagnostics().front().code + ": " + e.what();
  }
  return "nothing was thrown";
}

TEST(Dynamometer, RefusesRecordsItCannotUse) {
  Machine m = passive_sweep(0.0, 0.0, 0.0);
  m.torque[77] = std::nan("");
  EXPECT_EQ(message_of([&] { m.record(true); }),
            "not-finite: the dynamometer's torque is not a finite number at sample 77");
  m.torque.pop_back();
  EXPECT_EQ(message_of([&] { m.record(true); }),
            "wrong-size: the dynamometer's record has 12000 angles, 12000 velocities and 11999 torques");
  Machine bad = passive_sweep(0.0, 0.0, 0.0);
  bad.layout.angle_sign = 0;
  EXPECT_EQ(message_of([&] { bad.record(true); }),
            "bad-layout: the dynamometer's angle sign must be 1 or -1, not 0");
  Machine still;
  for (int i = 0; i < 1000; ++i) still.add(1.0 + 1e-4 * i, 0.05, 5.0);
  EXPECT_EQ(
      message_of([&] { limb::fit_gravity(still.record(true)); }),
      "short-sweep: the passive sweep covers 5.15 deg (57.58 to 62.73); the gravity fit needs 40.1 deg");
  limb::PassiveSweepOptions slow;
  slow.max_speed_rad_per_s = 0.01;
  EXPECT_EQ(
      message_of([&] { limb::fit_gravity(still.record(true), slow); }),
      "too-few-samples: the passive sweep has 0 samples slower than 0.573 deg/s; the gravity fit needs 10");
  const limb::DynamometerRecord record = still.record(true);
  EXPECT_EQ(message_of([&] {
              limb::dynamometer_moment(record, {{}, -1.0}, {});
            }),
            "out-of-range: the inertia must be 0 kg m^2 or greater, not -1");
  EXPECT_EQ(message_of([&] {
              limb::dynamometer_moment(record, {}, {}, {0.01, 0.0, 0.0, 0.0});
            }),
            "missing-key: an axis offset needs the distance from the machine's axis to the pad");
  EXPECT_EQ(message_of([&] {
              limb::dynamometer_moment(record, {}, {}, {0.1, 0.0, 0.0, 0.2});
            }),
            "out-of-range: the joint lies 100 mm beside the machine's axis, too far for a first-order "
            "correction at a pad distance of 200 mm");
  EXPECT_EQ(message_of([&] { limb::isokinetic_phases(record, {}); }),
            "out-of-range: the isokinetic speed must be greater than 0, not 0");
}

}  // namespace
