#include "fem/mesh/cylinder.hpp"

#include <limits>

#include "fem/mesh/convert.hpp"
#include "fem/mesh/round_section.hpp"
#include "fem/mesh/section.hpp"

namespace brachium::fem {
namespace {

constexpr double infinite = std::numeric_limits<double>::infinity();
using Names = std::vector<std::string>;

}  // namespace

std::vector<double> round_section_radii(const RoundSection& section, double core_radius, double outer) {
  std::vector<double> radii =
      positions({outer - core_radius, section.ring_cells, section.ring_grading}, "rings");
  radii.erase(radii.begin());
  for (double& r : radii) r += core_radius;
  radii.back() = outer;
  return radii;
}

data::Mesh cylinder(const CylinderOptions& options) {
  check_option("cylinder: radius_m", options.radius_m, 0.0, infinite, true);
  check_option("cylinder: radius_y_m", options.radius_y_m, 0.0, infinite, false);
  const double rx = options.radius_m, ry = options.radius_y_m > 0.0 ? options.radius_y_m : rx;
  constexpr double core = 0.55;
  const Section section =
      disk_section(options.section.core_cells, round_section_radii(options.section, core, 1.0), core);
  SweepNames names;
  names.regions = {options.region};
  names.region = [](auto, int) { return 0; };
  names.first = [](auto, int) { return Names{"z0"}; };
  names.last = [](auto, int) { return Names{"z1"}; };
  names.side = [](auto, int, int) { return Names{"side"}; };
  data::Mesh mesh = sweep(
      section, positions(options.z, "cylinder: z"),
      [&](double u, double v, double w) -> Eigen::Vector3d {
        return {rx * u, ry * v, w};
      },
      names);
  mesh.cell_fields["fibre"] = Eigen::Vector3d::UnitZ().replicate(1, mesh.cell_count());
  return as_type(std::move(mesh), options.type);
}

}  // namespace brachium::fem
