#pragma once
/// The one place where signs change between this program and the thesis' tables of the Upper Limb Model,
/// which count extension positive: M = F_T l_T + F_B l_B + F_L l_L with F_T >= 0, F_B <= 0, lever arms
/// positive, F_L >= 0 extends. Here flexion is positive, muscle forces are tensions >= 0, and r = -dL/dq.

#include "data/model/curve.hpp"

namespace brachium::optimise::thesis {

enum class Action { flexor, extensor };

/// Signed force of the tables from a tension, and back.
constexpr double force_from_tension(Action action, double tension_N) {
  return action == Action::flexor ? -tension_N : tension_N;
}
constexpr double tension_from_force(Action action, double force_N) {
  return action == Action::flexor ? -force_N : force_N;
}

/// Moment arm r (flexor positive) from a lever arm of the tables (positive), with its slope.
constexpr data::CurveValue moment_arm(Action action, data::CurveValue lever) {
  return action == Action::flexor ? lever : data::CurveValue{-lever.value, -lever.slope};
}

/// Moment for each newton of F_L, flexion positive, from l_L.
constexpr data::CurveValue load_arm(data::CurveValue lever) {
  return {-lever.value, -lever.slope};
}

/// Moment, and dM/dtheta, extension positive, from flexion positive. Its own inverse.
constexpr double moment(double moment_N_m) {
  return -moment_N_m;
}

}  // namespace brachium::optimise::thesis
