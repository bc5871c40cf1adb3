#pragma once
/// Length and moment arm of a muscle-tendon unit along its path, as functions of one joint coordinate.
///
/// | symbol | identifier       | unit  | meaning                                             |
/// |--------|------------------|-------|-----------------------------------------------------|
/// | q      | q_rad            | rad   | joint coordinate, flexion positive                  |
/// | L(q)   | length_m         | m     | muscle-tendon length                                |
/// | r(q)   | moment_arm_m     | m     | r = -dL/dq: positive for a flexor                   |
/// | r'(q)  | dmoment_arm_dq_m | m/rad | slope of the moment arm                             |
/// | v      | velocity_m_per_s | m/s   | dL/dt = -r q', lengthening positive                 |
///
/// The moment arm as the negative slope of the length: An, Takahashi, Harrigan & Chao 1984,
/// doi:10.1115/1.3138494.

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "data/model/curve.hpp"
#include "data/model/muscle.hpp"
#include "data/model/scene.hpp"

namespace brachium::limb {

/// How well a given length and a given moment arm agree: the worst of |r + dL/dq| over the coordinate's
/// range.
struct PathConsistency {
  bool both_given = false;            ///< false: one was derived from the other, nothing to compare
  double worst_disagreement_m = 0.0;  ///< largest |r + dL/dq|
  double worst_angle_rad = 0.0;       ///< where
  double tolerance_m = 0.0;           ///< PathGeometry::consistency_tolerance_m
};

/// A muscle's path over one coordinate. Const, and safe to call from several threads.
///
/// Polynomials are taken as given; the one that is missing is derived exactly (the moment arm as -dL/dq, or
/// the length by integration from the reference length). Tables:
///   length and moment arm   cubic Hermite through the lengths with knot slopes -r; r(q) = -dL/dq of that
///   curve length only             twice continuously differentiable spline, so that the moment arm is smooth
///   moment arm only         monotone cubic through the moment arms; length by exact integration
/// In every case but two given polynomials, r(q) = -dL/dq to rounding error.
class MusclePath {
 public:
  struct Value {
    double length_m = 0.0;
    double moment_arm_m = 0.0;
    double dmoment_arm_dq_m = 0.0;
  };

  /// Throws InputError: "missing-geometry", "bad-geometry" (sizes, order or range of the knots, not finite, a
  /// length that is not positive) or "inconsistent-geometry" (length and moment arm disagree by more than the
  /// geometry's tolerance), each naming the muscle, the last also angle and size of the worst disagreement.
  MusclePath(std::string muscle, const data::PathGeometry& geometry, const data::Coordinate& coordinate);

  /// Throws InputError("angle-out-of-range") naming muscle, angle and range in deg (also for NaN).
  Value operator()(double q_rad) const;

  /// Batch: out spans have the size of q_rad; qdot and velocity may both be empty. v = -r q'.
  void evaluate(std::span<const double> q_rad, std::span<const double> qdot_rad_per_s,
                std::span<double> length_m, std::span<double> moment_arm_m,
                std::span<double> velocity_m_per_s) const;

  const std::string& muscle() const { return muscle_; }
  const std::string& coordinate() const { return coordinate_; }
  double lower_rad() const { return lower_; }
  double upper_rad() const { return upper_; }
  const PathConsistency& consistency() const { return consistency_; }

 private:
  Value unchecked(double q) const;
  void build_polynomial(const data::PathGeometry& geometry);
  void build_table(const data::PathGeometry& geometry);
  void check_consistency(double tolerance_m);
  void check_lengths() const;

  std::string muscle_, coordinate_;
  double lower_, upper_;
  PathConsistency consistency_;
  std::vector<double> length_, arm_;           // polynomial coefficients
  std::optional<data::PiecewiseCubic> curve_;  // table: length, or moment arm where only that is known
  std::vector<double> knot_length_;            // table of moment arms: length at each knot
};

}  // namespace brachium::limb
