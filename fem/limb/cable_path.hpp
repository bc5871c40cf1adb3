#pragma once
/// An inextensible tendon as a cable in the plane of motion: the shortest path from a point of the humerus to
/// a point of the forearm around a round obstacle that rests on the humerus.
///
/// The arm's frame: the hinge's axis is z through the origin of coordinates, x anterior, y proximal along the
/// humerus. The forearm hangs along -y at q = 0; flexion turns it about +z.
///
///   P(q) = d (sin(q + phi), -cos(q + phi)),   L(q) = |O T_O| + rho * arc + |T_P P|,   r(q) = -dL/dq = e . (P
///   x t)
///
/// | symbol | identifier | unit | meaning                                                                 |
/// |--------|------------|------|-------------------------------------------------------------------------|
/// | O      | origin_m   | m    | where the path begins, on the humerus                                   |
/// | d      | distance_m | m    | of the insertion from the axis                                          |
/// | phi    | offset_rad | rad  | of the insertion ahead of the forearm's long axis                       |
/// | rho    | radius_m   | m    | of the obstacle: bone, and what lies between it and the tendon's centre |
/// | t      | pull       | 1    | unit direction in which the tendon pulls at P                           |
///
/// (Obstacles in closed form: Garner & Pandy 2000, doi:10.1080/10255840008915251.)

#include <Eigen/Core>

namespace brachium::fem {

struct CableGeometry {
  Eigen::Vector2d origin_m = Eigen::Vector2d::Zero();
  double distance_m = 0.0;
  double offset_rad = 0.0;
  Eigen::Vector2d obstacle_m = Eigen::Vector2d::Zero();  ///< centre
  double radius_m = 0.0;
  bool anterior = true;  ///< the path passes the obstacle on its anterior side, else on its posterior one
};

/// The path at one angle.
class CablePath {
 public:
  /// Throws InputError("limb-geometry") where an end lies inside the obstacle, or the path would turn by more
  /// than half a circle.
  CablePath(const CableGeometry& geometry, double q_rad);

  double length_m() const { return first_ + arc_ + last_; }
  double arc_m() const { return arc_; }  ///< 0: the path is straight
  /// From the insertion to where the path has left the obstacle; 0: the path is straight.
  double past_obstacle_m() const { return arc_ > 0.0 ? last_ + arc_ : 0.0; }
  const Eigen::Vector2d& insertion_m() const { return insertion_; }
  Eigen::Vector2d pull() const;  ///< t, at the insertion
  double lever_arm_m() const;    ///< r

  struct Place {
    Eigen::Vector2d point_m;
    Eigen::Vector2d towards_origin;  ///< unit tangent
  };
  /// The point at a distance from the insertion along the path. Throws InputError("limb-geometry") beyond the
  /// origin.
  Place place(double from_insertion_m) const;

 private:
  Eigen::Vector2d origin_, insertion_, centre_, leaves_, arrives_;  ///< leaves_: T_O, arrives_: T_P
  double radius_, side_, first_ = 0.0, arc_ = 0.0, last_ = 0.0;
};

}  // namespace brachium::fem
