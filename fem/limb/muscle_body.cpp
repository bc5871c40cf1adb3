#include "fem/limb/muscle_body.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace brachium::fem {
namespace {

constexpr double knot_spacing = std::numbers::pi / 90.0;  // 2 deg

Eigen::Vector3d spatial(const Eigen::Vector2d& v) {
  return {v.x(), v.y(), 0.0};
}

data::Mesh spindle_mesh(const MuscleBody& body) {
  SpindleOptions o;
  o.type = cell_type(body.formulation);
  o.origin_tendon = {body.tendon_origin_m, body.tendon_cells};
  o.belly = {body.belly_length_m, body.belly_cells};
  o.insertion_tendon = {body.tendon_insertion_m, body.tendon_cells};
  o.profile_m = body.profile_m;
  o.flatness = body.flatness;
  o.section = body.section;
  o.transition_m = body.transition_m;
  o.aponeurosis_thickness_norm = body.aponeurosis.thickness_norm;
  o.aponeurosis_cells = body.aponeurosis.cells;
  o.aponeurosis_origin_norm = body.aponeurosis.origin_norm;
  o.aponeurosis_insertion_norm = body.aponeurosis.insertion_norm;
  return spindle(o);
}

/// What the body's own coordinates are scaled by.
Eigen::Vector3d shape_scale(const MuscleBody& body) {
  const double across =
      *std::max_element(body.profile_m.begin(), body.profile_m.end()) / body.shape->greatest_radius_m;
  return {across, across, body.belly_length_m / body.shape->length_m};
}

data::Mesh stress_free_mesh(const MuscleBody& body) {
  data::Mesh mesh = body.shape ? *body.shape->mesh : spindle_mesh(body);
  if (body.shape) move(mesh, shape_scale(body).asDiagonal(), Eigen::Vector3d::Zero());
  const StressFreeAxis axis = stress_free_axis(body);
  move(mesh, axis.frame, axis.from_m);
  return mesh;
}

/// Of the distal end's centre of rotation, which stays on the path.
Eigen::Vector3d stress_free_end(const MuscleBody& body) {
  const StressFreeAxis axis = stress_free_axis(body);
  if (!body.shape) return axis.from_m + body.stress_free_length_m() * axis.along;
  const Eigen::Vector3d end = shape_scale(body).cwiseProduct(body.shape->insertion_m);
  return axis.from_m + axis.frame * end - body.shape->beside_path_m;
}

Eigen::Vector3d in_situ_origin(const MuscleBody& body) {
  return spatial(body.cable.origin_m) +
         (body.shape ? body.shape->origin_across_m : 0.0) * Eigen::Vector3d::UnitZ();
}

/// The range's first angle has a knot this far before it, in parts of the knots' spacing.
constexpr double close_by = 1e-3;

/// Amplitudes of the places of the distal end: the way in situ, then the range of angles. One knot close
/// before and one behind the range keep the motion's slope that of the path at both ends.
std::vector<double> knots(double reach) {
  const int n = std::max(2, static_cast<int>(std::ceil(reach / knot_spacing)));
  std::vector<double> a{0.0, 0.25, 0.5, 0.75, 1.0 - close_by * reach / n};
  for (int i = 0; i <= n + 1; ++i) a.push_back(1.0 + reach * i / n);
  return a;
}

/// Column k by the parabola through three columns that follow it towards `step`; they are evenly spaced, and
/// column k is `way` of their spacing before the first.
void extrapolate(GuidedMotion& m, Eigen::Index k, Eigen::Index step, double way) {
  const Eigen::Index a = k + step, b = a + step, c = b + step;
  const double wa = 0.5 * (way + 1.0) * (way + 2.0), wb = -way * (way + 2.0), wc = 0.5 * way * (way + 1.0);
  m.place_m.col(k) = wa * m.place_m.col(a) + wb * m.place_m.col(b) + wc * m.place_m.col(c);
  m.angle_rad[k] = wa * m.angle_rad[a] + wb * m.angle_rad[b] + wc * m.angle_rad[c];
}

GuidedMotion distal_motion(const MuscleBody& body, const AngleRange& range) {
  const bool upwards = range.upper_rad > body.reference_rad;
  const std::vector<double> a =
      knots(upwards ? range.upper_rad - body.reference_rad : body.reference_rad - range.lower_rad);
  const auto n = static_cast<Eigen::Index>(a.size());
  GuidedMotion motion;
  motion.centre_m = stress_free_end(body);
  motion.amplitude = Eigen::VectorXd::Map(a.data(), n);
  motion.place_m.resize(3, n);
  motion.angle_rad = Eigen::VectorXd::Zero(n);
  constexpr Eigen::Index before = 4;  // the knot before the range
  const Eigen::Index behind = n - 1;
  for (Eigen::Index i = before + 1; i < behind; ++i) {
    const double turn = motion.amplitude[i] - 1.0;
    const double q = body.reference_rad + (upwards ? turn : -turn);
    const EndPlace place = end_place(body, std::clamp(q, range.lower_rad, range.upper_rad));
    motion.place_m.col(i) = place.centre_m;
    motion.angle_rad[i] = place.turn_rad;
  }
  extrapolate(motion, before, 1, close_by);
  extrapolate(motion, behind, -1, 1.0);
  for (Eigen::Index i = 0; i < before; ++i) {
    const double way = motion.amplitude[i] / motion.amplitude[before];
    motion.place_m.col(i) = motion.centre_m + way * (motion.place_m.col(before) - motion.centre_m);
    motion.angle_rad[i] = way * motion.angle_rad[before];
  }
  return motion;
}

GuidedMotion proximal_motion(const MuscleBody& body) {
  GuidedMotion motion;
  motion.centre_m = stress_free_axis(body).from_m;
  motion.amplitude = Eigen::Vector2d(0.0, 1.0);
  motion.place_m.resize(3, 2);
  motion.place_m << motion.centre_m, in_situ_origin(body);
  motion.angle_rad = Eigen::Vector2d::Zero();
  return motion;
}

}  // namespace

Eigen::Vector3d outward(const MuscleBody& body) {
  return Eigen::Vector3d::UnitX() * (body.cable.anterior ? 1.0 : -1.0);
}

StressFreeAxis stress_free_axis(const MuscleBody& body) {
  const Eigen::Vector3d along = -end_place(body, body.reference_rad).pull;
  StressFreeAxis axis{in_situ_origin(body) + body.standoff_m * outward(body), along, {}};
  axis.frame << Eigen::Vector3d::UnitZ(), along.cross(Eigen::Vector3d::UnitZ()), along;
  return axis;
}

double MuscleBody::cable_length_m() const {
  return CablePath(cable, reference_rad).length_m() - pre_stretch * stress_free_length_m();
}

EndPlace end_place(const MuscleBody& body, double q) {
  const double cable = body.cable_length_m();
  const CablePath::Place place = CablePath(body.cable, q).place(cable);
  const Eigen::Vector2d at_reference = CablePath(body.cable, body.reference_rad).place(cable).towards_origin;
  const Eigen::Vector2d now = place.towards_origin;
  return {spatial(place.point_m), spatial(now),
          std::atan2(at_reference.x() * now.y() - at_reference.y() * now.x(), at_reference.dot(now))};
}

MuscleBody with_tendons(MuscleBody body, double origin_m, double insertion_m) {
  const double in_situ_m = body.pre_stretch * body.stress_free_length_m();
  body.tendon_origin_m += origin_m;
  body.tendon_insertion_m += insertion_m;
  body.pre_stretch = (in_situ_m + origin_m + insertion_m) / body.stress_free_length_m();
  return body;
}

Phase in_situ_phase(int steps) {
  Phase phase;
  phase.name = "in situ";
  phase.amplitude = {{"origin", 1.0}, {"insertion", 1.0}};
  phase.steps = steps;
  return phase;
}

double amplitude(const MuscleBody& body, double q) {
  return 1.0 + std::abs(q - body.reference_rad);
}

void check(const MuscleBody& body, const AngleRange& range) {
  const auto require = [&](bool good, const std::string& what, double value, const std::string& allowed) {
    if (good) return;
    throw data::InputError("limb-geometry", fmt::format("{}: {} = {:.6g}", body.name, what, value),
                           "it must be " + allowed);
  };
  require(range.lower_rad < range.upper_rad, "lower end of the range of angles [rad]", range.lower_rad,
          "below the upper end");
  require(body.reference_rad == range.lower_rad || body.reference_rad == range.upper_rad, "reference_rad",
          body.reference_rad, "one end of the range of angles: the one at which the muscle is shortest");
  require(body.belly_length_m > 0.0, "belly_length_m", body.belly_length_m, "greater than 0");
  require(body.tendon_origin_m >= 0.0, "tendon_origin_m", body.tendon_origin_m, "0 (rigid) or greater");
  require(body.tendon_insertion_m >= 0.0, "tendon_insertion_m", body.tendon_insertion_m,
          "0 (rigid) or greater");
  require(body.pre_stretch > 0.5 && body.pre_stretch < 2.0, "pre_stretch", body.pre_stretch, "in (0.5, 2)");
  require(body.standoff_m >= 0.0, "standoff_m", body.standoff_m, "0 or greater");
  require(body.bulk_modulus_pa > 0.0, "bulk_modulus_pa", body.bulk_modulus_pa, "greater than 0, or infinity");
  const std::string of_mesh = body.shape ? "mesh_field" : "mesh_lines";
  if (body.fibres != "harmonic" && body.fibres != of_mesh) {
    throw data::InputError("limb-geometry", fmt::format("{}: fibres cannot be `{}`", body.name, body.fibres),
                           fmt::format("\"harmonic\" or \"{}\"", of_mesh));
  }
  require(!body.shape || body.shape->length_m > 0.0, "length of the imported mesh [m]",
          body.shape ? body.shape->length_m : 0.0, "greater than 0");
  require(body.cable_length_m() >= 0.0, "length of the rigid tendon that is left [m]", body.cable_length_m(),
          "0 or greater: shorten belly or tendons, lessen the pre-stretch, or move the origin away");
  const int n = static_cast<int>(std::ceil((range.upper_rad - range.lower_rad) / knot_spacing));
  for (int i = 0; i <= n; ++i) end_place(body, range.lower_rad + (range.upper_rad - range.lower_rad) * i / n);
}

BuiltMuscle build(const MuscleBody& body, const AngleRange& range) {
  return build(body, range, std::make_shared<const data::Mesh>(stress_free_mesh(body)));
}

BuiltMuscle build(const MuscleBody& body, const AngleRange& range, std::shared_ptr<const data::Mesh> mesh) {
  check(body, range);
  BuiltMuscle built;
  TissueRules rules;
  if (body.fibres == "harmonic") {
    rules.fibres.push_back({{}, HarmonicFibres{"origin", "insertion", std::nullopt}});
  } else {
    rules.fibres.push_back({{}, MeshFieldFibres{"fibre"}});
  }
  if (!body.shape) rules.muscle.push_back({{}, std::string("gamma_M")});
  if (body.shape && !body.shape->tendons.empty()) rules.muscle.push_back({body.shape->tendons, 0.0});
  Tissue tissue = build_tissue(*mesh, body.formulation, rules);
  built.directions = std::move(tissue.directions);
  built.harmonic = std::move(tissue.harmonic);
  Problem& p = built.problem;
  p.formulation = body.formulation;
  p.tissue = std::move(tissue.field);
  Volumetric volumetric;
  volumetric.bulk_modulus_pa = body.bulk_modulus_pa;
  p.materials.assign(mesh->regions.size(), {body.material, volumetric});
  p.conditions = {{"origin", "origin", proximal_motion(body)},
                  {"insertion", "insertion", distal_motion(body, range)}};
  p.mesh = std::move(mesh);
  return built;
}

}  // namespace brachium::fem
