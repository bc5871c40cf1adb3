#include "fem/mesh/pennate.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "data/model/error.hpp"
#include "fem/mesh/convert.hpp"
#include "fem/mesh/section.hpp"

namespace brachium::fem {
namespace {

enum Part { muscle, deep, superficial, origin, insertion };  // in the order of the regions' names below
using Names = std::vector<std::string>;

/// Appends an axis to knots that start anywhere.
void append(std::vector<double>& knots, const Axis& axis, const std::string& what, bool reversed = false) {
  const auto part = positions(axis, what);
  const double start = knots.back();
  for (std::size_t i = 1; i < part.size(); ++i)
    knots.push_back(start + (reversed ? axis.length_m - part[part.size() - 1 - i] : part[i]));
}

}  // namespace

data::Mesh pennate_belly(const PennateOptions& o) {
  check_option("pennate belly: pennation_rad", o.pennation_rad, 0.05, 0.5 * std::numbers::pi, false);
  check_option("pennate belly: aponeurosis length_m", o.aponeurosis.length_m, 0.0, 1e6, false);
  check_option("pennate belly: tendon length_m", o.tendon.length_m, 0.0, 1e6, false);
  const bool sheets = o.aponeurosis.length_m > 0.0, tendons = o.tendon.length_m > 0.0;
  if (tendons && !sheets) {
    throw data::InputError("bad-mesh-option", "pennate belly: tendons need aponeuroses to hang on",
                           "give the aponeurosis a thickness, or the tendon length 0");
  }
  // Columns along xi, rows along zeta; graded parts mirror each other about the muscle.
  std::vector<double> xi{tendons ? -o.tendon.length_m : 0.0}, zeta{sheets ? -o.aponeurosis.length_m : 0.0};
  if (tendons) append(xi, o.tendon, "pennate belly: tendon", true);
  const int first_column = static_cast<int>(xi.size()) - 1;
  append(xi, o.length, "pennate belly: length");
  const int last_column = static_cast<int>(xi.size()) - 1;
  if (tendons) append(xi, o.tendon, "pennate belly: tendon");
  if (sheets) append(zeta, o.aponeurosis, "pennate belly: aponeurosis", true);
  const int first_row = static_cast<int>(zeta.size()) - 1;
  append(zeta, o.thickness, "pennate belly: thickness");
  const int last_row = static_cast<int>(zeta.size()) - 1;
  if (sheets) append(zeta, o.aponeurosis, "pennate belly: aponeurosis");
  xi[static_cast<std::size_t>(first_column)] = 0.0;
  zeta[static_cast<std::size_t>(first_row)] = 0.0;

  const auto part_of = [=](std::array<int, 2> cell) -> int {
    const auto [i, j] = cell;
    const bool middle = i >= first_column && i < last_column;
    if (j < first_row) return middle ? deep : (i < first_column ? origin : -1);
    if (j >= last_row) return middle ? superficial : (i >= last_column ? insertion : -1);
    return middle ? muscle : -1;
  };
  const Section section = grid_section(xi, zeta, [&](int i, int j) { return part_of({i, j}) >= 0; });

  SweepNames names;
  names.regions = {"muscle", "aponeurosis_deep", "aponeurosis_superficial", "tendon_origin",
                   "tendon_insertion"};
  names.region = [&](std::array<int, 2> tag, int) { return part_of(tag); };
  // The sweep runs against y, so that (x, z, -y) is right-handed.
  names.first = [](auto, int) { return Names{"y1"}; };
  names.last = [](auto, int) { return Names{"y0"}; };
  const int columns = static_cast<int>(xi.size()) - 1, rows = static_cast<int>(zeta.size()) - 1;
  names.side = [&](std::array<int, 2> tag, int edge, int) -> Names {
    const int part = part_of(tag);
    Names list;
    // Edges: 0 below, 1 right, 2 above, 3 left.
    if (edge == 0 && tag[1] == 0) list.emplace_back("deep");
    if (edge == 2 && tag[1] == rows - 1) list.emplace_back("superficial");
    if (part == muscle && edge == 3) list.emplace_back("proximal");
    if (part == muscle && edge == 1) list.emplace_back("distal");
    if (sheets ? (edge == 3 && tag[0] == 0 && part == (tendons ? origin : deep)) : (edge == 0 && tag[1] == 0))
      list.emplace_back("origin");
    if (sheets ? (edge == 1 && tag[0] == columns - 1 && part == (tendons ? insertion : superficial))
               : (edge == 2 && tag[1] == rows - 1))
      list.emplace_back("insertion");
    return list;
  };
  // Mesh lines follow the fibres through the muscle and stand upright in the sheets: x = xi + zeta
  // cot(pennation).
  const double cotangent = std::cos(o.pennation_rad) / std::sin(o.pennation_rad);
  const double width = o.width.length_m, thickness = o.thickness.length_m;
  std::vector<double> y = {0.0};
  append(y, o.width, "pennate belly: width", true);
  data::Mesh mesh = sweep(
      section, y,
      [&](double u, double v, double w) -> Eigen::Vector3d {
        return {u + cotangent * std::clamp(v, 0.0, thickness), width - w, v};
      },
      names);

  Eigen::MatrixXd fibre(3, mesh.cell_count()), gamma(1, mesh.cell_count());
  const Eigen::Vector3d oblique(std::cos(o.pennation_rad), 0.0, std::sin(o.pennation_rad));
  for (int c = 0; c < mesh.cell_count(); ++c) {
    const bool is_muscle =
        mesh.regions[static_cast<std::size_t>(mesh.region_of_cell[static_cast<std::size_t>(c)])] == "muscle";
    fibre.col(c) = is_muscle ? oblique : Eigen::Vector3d(Eigen::Vector3d::UnitX());
    gamma(0, c) = is_muscle ? 1.0 : 0.0;
  }
  mesh.cell_fields["fibre"] = std::move(fibre);
  mesh.cell_fields["gamma_M"] = std::move(gamma);
  return as_type(std::move(mesh), o.type);
}

}  // namespace brachium::fem
