#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

#include "data/model/curve.hpp"
#include "data/model/error.hpp"
#include "fem/mesh/convert.hpp"
#include "fem/mesh/cylinder.hpp"
#include "fem/mesh/round_section.hpp"
#include "fem/mesh/section.hpp"

namespace brachium::fem {
namespace {

constexpr double infinite = std::numeric_limits<double>::infinity();
using Names = std::vector<std::string>;

/// Radius along the whole muscle-tendon complex, and its slope.
class Profile {
 public:
  explicit Profile(const SpindleOptions& o)
      : start_(o.origin_tendon.length_m),
        length_(o.belly.length_m),
        tendon_(o.tendon_radius_m),
        belly_(o.belly_radius_m) {
    if (o.profile_m.empty()) return;
    std::vector<double> s(o.profile_m.size());
    for (std::size_t i = 0; i < s.size(); ++i)
      s[i] = static_cast<double>(i) / static_cast<double>(s.size() - 1);
    curve_ = data::PiecewiseCubic::monotone(s, o.profile_m);
  }

  data::CurveValue operator()(double z) const {
    const double s = (z - start_) / length_;
    const bool outside = s < 0.0 || s > 1.0;
    const double at = std::clamp(s, 0.0, 1.0);
    if (curve_) {
      const data::CurveValue r = (*curve_)(at);
      return {r.value, outside ? 0.0 : r.slope / length_};
    }
    // r = r_t + (r_b - r_t) sin^2(pi s)
    const double sine = std::sin(std::numbers::pi * at);
    const double slope = std::numbers::pi * std::sin(2.0 * std::numbers::pi * at) / length_;
    return {tendon_ + (belly_ - tendon_) * sine * sine, outside ? 0.0 : (belly_ - tendon_) * slope};
  }

 private:
  double start_, length_, tendon_, belly_;
  std::optional<data::PiecewiseCubic> curve_;
};

void check_options(const SpindleOptions& o) {
  if (o.profile_m.empty()) {
    check_option("spindle: belly_radius_m", o.belly_radius_m, 0.0, infinite, true);
    check_option("spindle: tendon_radius_m", o.tendon_radius_m, 0.0, infinite, true);
  } else {
    check_option("spindle: number of profile_m", static_cast<double>(o.profile_m.size()), 3, 1e6, false);
    for (const double r : o.profile_m) check_option("spindle: profile_m", r, 0.0, infinite, true);
  }
  check_option("spindle: flatness", o.flatness, 0.01, 100.0, false);
  check_option("spindle: aponeurosis_thickness_norm", o.aponeurosis_thickness_norm, 0.0, 0.4, false);
  check_option("spindle: aponeurosis_cells", o.aponeurosis_cells, 1, 1000, false);
  check_option("spindle: aponeurosis_origin_norm", o.aponeurosis_origin_norm, 0.0, 1.0, false);
  check_option("spindle: aponeurosis_insertion_norm", o.aponeurosis_insertion_norm, 0.0, 1.0, false);
  check_option("spindle: transition_m", o.transition_m, 0.0, 0.5 * o.belly.length_m, false);
  if (!(o.aponeurosis_thickness_norm > 0.0)) return;
  if (o.aponeurosis_origin_norm + o.aponeurosis_insertion_norm > 1.0) {
    throw data::InputError("bad-mesh-option", "spindle: the two aponeuroses overlap",
                           "aponeurosis_origin_norm + aponeurosis_insertion_norm must be at most 1");
  }
  if (o.transition_m > 0.0) {
    throw data::InputError("bad-mesh-option", "spindle: a transition cannot stand beside aponeuroses",
                           "leave out transition_m or aponeurosis_thickness_norm");
  }
}

}  // namespace

data::Mesh spindle(const SpindleOptions& o) {
  check_options(o);
  // Layers along z and the part that each belongs to.
  std::vector<double> z{0.0};
  std::vector<int> part;  // 0 origin tendon, 1 belly, 2 insertion tendon
  const std::pair<const Axis*, const char*> axes[] = {{&o.origin_tendon, "spindle: origin_tendon"},
                                                      {&o.belly, "spindle: belly"},
                                                      {&o.insertion_tendon, "spindle: insertion_tendon"}};
  for (int a = 0; a < 3; ++a) {
    const auto& [axis, what] = axes[a];
    if (a != 1 && axis->length_m == 0.0) continue;
    const double start = z.back();
    const auto along = positions(*axis, what);
    for (std::size_t i = 1; i < along.size(); ++i) z.push_back(start + along[i]);
    part.insert(part.end(), along.size() - 1, a);
  }
  const Profile radius(o);
  const double belly_start = o.origin_tendon.length_m, belly_end = belly_start + o.belly.length_m;

  // Cross-section: core, rings, and the rings of the aponeurosis.
  const double core = 0.55 * (1.0 - o.aponeurosis_thickness_norm);
  std::vector<double> radii = round_section_radii(o.section, core, 1.0 - o.aponeurosis_thickness_norm);
  const int sheet_ring = static_cast<int>(radii.size());
  for (int i = 1; o.aponeurosis_thickness_norm > 0.0 && i <= o.aponeurosis_cells; ++i)
    radii.push_back(i == o.aponeurosis_cells ? 1.0
                                             : radii[static_cast<std::size_t>(sheet_ring) - 1] +
                                                   o.aponeurosis_thickness_norm * i / o.aponeurosis_cells);
  const Section section = disk_section(o.section.core_cells, radii, core);

  SweepNames names;
  names.regions = {"tendon_origin", "muscle", "tendon_insertion", "aponeurosis_origin",
                   "aponeurosis_insertion"};
  names.region = [&](std::array<int, 2> tag, int layer) {
    const auto k = static_cast<std::size_t>(layer);
    if (part[k] != 1 || tag[0] < sheet_ring) return part[k];
    const double s = (0.5 * (z[k] + z[k + 1]) - belly_start) / o.belly.length_m;
    if (s < o.aponeurosis_origin_norm) return 3;
    return s > 1.0 - o.aponeurosis_insertion_norm ? 4 : 1;
  };
  names.first = [](auto, int) { return Names{"origin"}; };
  names.last = [](auto, int) { return Names{"insertion"}; };
  names.side = [&](auto, int, int layer) {
    return part[static_cast<std::size_t>(layer)] == 1 ? Names{"side", "belly"} : Names{"side"};
  };
  data::Mesh mesh = sweep(
      section, z,
      [&](double u, double v, double w) -> Eigen::Vector3d {
        const double r = radius(w).value;
        return {r * u, o.flatness * r * v, w};
      },
      names);

  // Fibres: x = r(z) u with u fixed, so dx/dz = r'/r x.
  const auto fibre = [&](const Eigen::Vector3d& x) -> Eigen::Vector3d {
    const data::CurveValue r = radius(x.z());
    return Eigen::Vector3d(r.slope / r.value * x.x(), r.slope / r.value * x.y(), 1.0).normalized();
  };
  const auto gamma = [&](double at) {
    if (at < belly_start || at > belly_end) return 0.0;
    double value = 1.0;
    const auto rise = [&](double distance) {
      const double t = std::clamp(distance / o.transition_m, 0.0, 1.0);
      value *= t * t * (3.0 - 2.0 * t);
    };
    if (o.origin_tendon.length_m > 0.0) rise(at - belly_start);
    if (o.insertion_tendon.length_m > 0.0) rise(belly_end - at);
    return value;
  };
  Eigen::MatrixXd point_fibre(3, mesh.point_count()), cell_fibre(3, mesh.cell_count());
  for (int p = 0; p < mesh.point_count(); ++p) point_fibre.col(p) = fibre(mesh.points.col(p));
  const bool smooth = o.transition_m > 0.0;
  Eigen::MatrixXd cell_gamma(1, mesh.cell_count());
  for (int c = 0; c < mesh.cell_count(); ++c) {
    const Eigen::Vector3d centre = mesh.points.col(mesh.cells(26, c));
    cell_fibre.col(c) = fibre(centre);
    const bool muscle =
        mesh.regions[static_cast<std::size_t>(mesh.region_of_cell[static_cast<std::size_t>(c)])] == "muscle";
    cell_gamma(0, c) = smooth ? gamma(centre.z()) : (muscle ? 1.0 : 0.0);
  }
  if (smooth) mesh.point_fields["gamma_M"] = mesh.points.row(2).unaryExpr(gamma);
  mesh.point_fields["fibre"] = std::move(point_fibre);
  mesh.cell_fields["fibre"] = std::move(cell_fibre);
  mesh.cell_fields["gamma_M"] = std::move(cell_gamma);
  return as_type(std::move(mesh), o.type);
}

}  // namespace brachium::fem
