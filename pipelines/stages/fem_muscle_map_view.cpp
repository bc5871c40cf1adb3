#include "pipelines/stages/fem_muscle_map_view.hpp"

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <map>
#include <numbers>

#include "pipelines/stages/common.hpp"

namespace brachium::pipelines {
namespace {

constexpr double degree = std::numbers::pi / 180.0;

struct Field {
  const char* column;
  const char* label;
  double scale;
};
constexpr Field shown[] = {{"fibre_stretch", "fibre stretch [1]", 1.0},
                           {"contact_pressure_pa", "contact pressure [kPa]", 1e-3},
                           {"fibre_stress_pa", "fibre stress [kPa]", 1e-3}};

using Place = std::pair<double, double>;  // activation, angle

/// Rows at which the states of a muscle begin.
std::map<Place, std::size_t> begins(const data::Table& states) {
  std::map<Place, std::size_t> out;
  const std::vector<double>&number = states.numbers("state"), &angle = states.numbers("angle_deg"),
        &activation = states.numbers("activation");
  for (std::size_t k = 0; k < number.size(); ++k) {
    if (k == 0 || number[k] != number[k - 1]) out[{activation[k], angle[k]}] = k;
  }
  return out;
}

void add_surface(const data::Table& triangles, const data::Table* edges, int first,
                 report::ViewRegion& region) {
  for (std::size_t t = 0; t < triangles.rows(); ++t)
    region.triangles.push_back({first + static_cast<int>(triangles.numbers("a")[t]),
                                first + static_cast<int>(triangles.numbers("b")[t]),
                                first + static_cast<int>(triangles.numbers("c")[t])});
  for (std::size_t e = 0; edges && e < edges->rows(); ++e)
    region.edges.push_back(
        {first + static_cast<int>(edges->numbers("a")[e]), first + static_cast<int>(edges->numbers("b")[e])});
}

/// Rows of a table for one bone.
data::Table of_bone(const data::Table& table, const std::string& bone) {
  data::Table out{table.title, {}};
  const std::vector<std::string>& names = table.texts("bone");
  for (const data::Column& c : table.columns) {
    const auto* values = std::get_if<std::vector<double>>(&c.values);
    if (!values) continue;
    std::vector<double> kept;
    for (std::size_t k = 0; k < names.size(); ++k) {
      if (names[k] == bone) kept.push_back((*values)[k]);
    }
    out.columns.push_back({c.name, c.unit, std::move(kept)});
  }
  return out;
}

}  // namespace

report::View3d limb_view(const StageData& map) {
  report::View3d view;
  view.title = "The limb at each angle";
  struct Body {
    const data::Table* states;
    std::size_t points;
    std::map<Place, std::size_t> begins;
  };
  std::vector<Body> bodies;
  int points = 0;
  for (const std::string& muscle : map.tables.at("muscles").texts("muscle")) {
    const auto states = map.tables.find("surface_states_" + muscle);
    if (states == map.tables.end()) return view;
    const data::Table& of_points = map.tables.at("surface_points_" + muscle);
    view.regions.push_back({muscle, {}, {}});
    add_surface(map.tables.at("surface_triangles_" + muscle), &map.tables.at("surface_edges_" + muscle),
                points, view.regions.back());
    bodies.push_back({&states->second, of_points.rows(), begins(states->second)});
    points += static_cast<int>(of_points.rows());
  }
  const data::Table &bone_points = map.tables.at("bone_points"),
                    &bone_triangles = map.tables.at("bone_triangles");
  struct BonePart {
    data::Table points;
    bool moves;
  };
  std::vector<BonePart> bones;
  for (std::size_t k = 0; k < bone_points.rows(); ++k) {
    const std::string& bone = bone_points.texts("bone")[k];
    if (k > 0 && bone == bone_points.texts("bone")[k - 1]) continue;
    bones.push_back({of_bone(bone_points, bone), bone_points.texts("segment")[k] == "forearm"});
    view.regions.push_back({bone, {}, {}});
    add_surface(of_bone(bone_triangles, bone), nullptr, points, view.regions.back());
    points += static_cast<int>(bones.back().points.rows());
  }
  for (const Field& f : shown) view.fields.push_back({f.label, {}});
  if (bodies.empty()) return view;
  for (const auto& [place, unused] : bodies.front().begins) {
    bool everywhere = true;
    for (const Body& b : bodies) everywhere = everywhere && b.begins.contains(place);
    if (!everywhere) continue;
    const double q = place.second * degree;
    report::ViewState state{fmt::format("{:.4g} deg, activation {:.3g}", place.second, place.first), {}};
    std::vector<std::vector<double>> values(std::size(shown));
    for (const Body& b : bodies) {
      const std::size_t from = b.begins.at(place);
      for (std::size_t p = from; p < from + b.points; ++p) {
        for (const char* axis : {"x_m", "y_m", "z_m"})
          state.positions.push_back(1e3 * b.states->numbers(axis)[p]);
        for (std::size_t f = 0; f < std::size(shown); ++f)
          values[f].push_back(shown[f].scale * b.states->numbers(shown[f].column)[p]);
      }
    }
    for (const BonePart& bone : bones) {
      for (std::size_t p = 0; p < bone.points.rows(); ++p) {
        const double x = bone.points.numbers("x_m")[p], y = bone.points.numbers("y_m")[p];
        const double c = bone.moves ? std::cos(q) : 1.0, s = bone.moves ? std::sin(q) : 0.0;
        for (const double v : {c * x - s * y, s * x + c * y, bone.points.numbers("z_m")[p]})
          state.positions.push_back(1e3 * v);
        for (auto& field : values) field.push_back(std::numeric_limits<double>::quiet_NaN());
      }
    }
    for (std::size_t f = 0; f < values.size(); ++f) view.fields[f].values.push_back(std::move(values[f]));
    view.states.push_back(std::move(state));
  }
  view.note =
      "Bones are grey. Bones of the forearm turn with the joint and are not touched by the muscles' model.";
  return view;
}

}  // namespace brachium::pipelines
