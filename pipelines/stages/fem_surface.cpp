#include "pipelines/stages/fem_surface.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>

#include "pipelines/report/text.hpp"

namespace brachium::pipelines {
namespace {

using Triangles = std::vector<std::array<int, 3>>;

/// Triangles of a face by its number of nodes (order of data::face_nodes).
const Triangles& triangles_of(std::size_t nodes) {
  static const Triangles three{{0, 1, 2}}, four{{0, 1, 2}, {0, 2, 3}},
      six{{0, 3, 5}, {3, 1, 4}, {5, 4, 2}, {3, 4, 5}},
      eight{{0, 4, 7}, {4, 1, 5}, {5, 2, 6}, {6, 3, 7}, {4, 5, 6}, {4, 6, 7}},
      nine{{0, 4, 8}, {0, 8, 7}, {4, 1, 5}, {4, 5, 8}, {8, 5, 2}, {8, 2, 6}, {7, 8, 6}, {7, 6, 3}};
  return nodes == 3 ? three : nodes == 4 ? four : nodes == 6 ? six : nodes == 8 ? eight : nine;
}

/// Its sides, cut at midside nodes.
std::vector<std::array<int, 2>> sides_of(std::size_t nodes) {
  const int corners = nodes == 3 || nodes == 6 ? 3 : 4;
  std::vector<std::array<int, 2>> out;
  for (int k = 0; k < corners; ++k) {
    const int next = (k + 1) % corners;
    if (static_cast<int>(nodes) == corners) {
      out.push_back({k, next});
    } else {
      out.push_back({k, corners + k});
      out.push_back({corners + k, next});
    }
  }
  return out;
}

data::Mesh region_mesh(const data::Mesh& mesh, int region) {
  data::Mesh part;
  part.type = mesh.type;
  part.points = mesh.points;
  std::vector<int> cells;
  for (int c = 0; c < mesh.cell_count(); ++c) {
    if (mesh.region_of_cell[static_cast<std::size_t>(c)] == region) cells.push_back(c);
  }
  part.cells = mesh.cells(Eigen::all, cells);
  part.regions = {mesh.regions[static_cast<std::size_t>(region)]};
  part.region_of_cell.assign(cells.size(), 0);
  return part;
}

data::Column numbers(const std::string& name, const std::string& unit) {
  return {name, unit, std::vector<double>{}};
}
void add(data::Table& table, std::size_t column, double value) {
  std::get<std::vector<double>>(table.columns[column].values).push_back(value);
}

std::vector<std::string> field_names(const fem::Problem& problem) {
  std::vector<std::string> names;
  if (problem.tissue.fibre.cols() > 0) names = {"fibre_stretch", "fibre_stress_pa"};
  names.insert(names.end(), {"von_mises_pa", "pressure_pa", "jacobian"});
  return names;
}

std::string label_of_field(const std::string& name) {
  if (name == "fibre_stretch") return "fibre stretch [1]";
  if (name == "fibre_stress_pa") return "fibre stress [kPa]";
  if (name == "von_mises_pa") return "von Mises stress [kPa]";
  if (name == "pressure_pa") return "pressure [kPa]";
  if (name == "displacement_m") return "displacement [mm]";
  if (name == "jacobian") return "volume ratio J [1]";
  return name;
}

}  // namespace

FemSurface::FemSurface(const data::Mesh& mesh) : mesh_(mesh) {
  triangles_ = {"Surface triangles",
                {numbers("region", "1"), numbers("a", "1"), numbers("b", "1"), numbers("c", "1")}};
  edges_ = {"Sides of cells on the surface", {numbers("region", "1"), numbers("a", "1"), numbers("b", "1")}};
  struct Face {
    int region;
    std::vector<int> nodes;
  };
  std::vector<Face> faces;
  std::set<int> used;
  for (int r = 0; r < static_cast<int>(mesh.regions.size()); ++r) {
    const data::Mesh part = region_mesh(mesh, r);
    for (const data::CellFace& f : data::boundary_faces(part)) {
      Face face{r, {}};
      for (const int local : data::face_nodes(mesh.type, f.face)) {
        face.nodes.push_back(part.cells(local, f.cell));
        used.insert(face.nodes.back());
      }
      faces.push_back(std::move(face));
    }
  }
  points_.assign(used.begin(), used.end());
  std::vector<int> place(static_cast<std::size_t>(mesh.point_count()), -1);
  for (std::size_t k = 0; k < points_.size(); ++k)
    place[static_cast<std::size_t>(points_[k])] = static_cast<int>(k);
  std::set<std::array<int, 3>> drawn;
  for (const Face& face : faces) {
    const auto at = [&](int local) {
      return place[static_cast<std::size_t>(face.nodes[static_cast<std::size_t>(local)])];
    };
    for (const auto& t : triangles_of(face.nodes.size())) {
      add(triangles_, 0, face.region);
      for (std::size_t k = 0; k < 3; ++k) add(triangles_, k + 1, at(t[k]));
    }
    for (const auto& side : sides_of(face.nodes.size())) {
      const int a = std::min(at(side[0]), at(side[1])), b = std::max(at(side[0]), at(side[1]));
      if (!drawn.insert({face.region, a, b}).second) continue;
      add(edges_, 0, face.region);
      add(edges_, 1, a);
      add(edges_, 2, b);
    }
  }
}

std::map<std::string, data::Table> FemSurface::tables() const {
  data::Table points{"Surface points, undeformed",
                     {numbers("point", "1"), numbers("x_m", "m"), numbers("y_m", "m"), numbers("z_m", "m")}};
  for (const int p : points_) {
    add(points, 0, p);
    for (int a = 0; a < 3; ++a) add(points, static_cast<std::size_t>(a) + 1, mesh_.points(a, p));
  }
  return {
      {"surface_points", std::move(points)}, {"surface_triangles", triangles_}, {"surface_edges", edges_}};
}

data::Table FemSurface::state(int state, const fem::Configuration& configuration,
                              const std::vector<std::pair<std::string, Eigen::VectorXd>>& at_points) const {
  data::Table table{"Surface by state",
                    {numbers("state", "1"), numbers("x_m", "m"), numbers("y_m", "m"), numbers("z_m", "m")}};
  for (const auto& [name, values] : at_points)
    table.columns.push_back(numbers(name, name.ends_with("_pa") ? "Pa" : name.ends_with("_m") ? "m" : "1"));
  table.columns.push_back(numbers("displacement_m", "m"));
  for (const int p : points_) {
    const Eigen::Vector3d u = configuration.dofs.segment<3>(3 * static_cast<Eigen::Index>(p));
    add(table, 0, state);
    for (int a = 0; a < 3; ++a) add(table, static_cast<std::size_t>(a) + 1, mesh_.points(a, p) + u[a]);
    for (std::size_t f = 0; f < at_points.size(); ++f) add(table, 4 + f, at_points[f].second[p]);
    add(table, 4 + at_points.size(), u.norm());
  }
  return table;
}

std::vector<std::pair<std::string, Eigen::VectorXd>> fields_at_points(
    const fem::Problem& problem, const fem::Discretisation& discretisation, const fem::PointFields& fields) {
  const std::vector<std::string> names = field_names(problem);
  const std::map<std::string, const Eigen::VectorXd*> all{{"fibre_stretch", &fields.fibre_stretch},
                                                          {"fibre_stress_pa", &fields.fibre_stress_pa},
                                                          {"von_mises_pa", &fields.von_mises_pa},
                                                          {"pressure_pa", &fields.pressure_pa},
                                                          {"jacobian", &fields.jacobian}};
  Eigen::MatrixXd values(static_cast<Eigen::Index>(names.size()), fields.jacobian.size());
  for (std::size_t k = 0; k < names.size(); ++k)
    values.row(static_cast<Eigen::Index>(k)) = all.at(names[k])->transpose();
  const Eigen::MatrixXd at_points = fem::to_points(discretisation, values);
  std::vector<std::pair<std::string, Eigen::VectorXd>> out;
  for (std::size_t k = 0; k < names.size(); ++k)
    out.emplace_back(names[k], at_points.row(static_cast<Eigen::Index>(k)).transpose());
  return out;
}

report::View3d surface_view(const std::map<std::string, data::Table>& tables,
                            const std::vector<std::string>& regions, const std::vector<std::string>& labels) {
  report::View3d view;
  const data::Table &points = tables.at("surface_points"), &triangles = tables.at("surface_triangles"),
                    &edges = tables.at("surface_edges"), &states = tables.at("surface_states");
  const std::size_t n = points.rows();
  const auto positions = [n](const data::Table& table, std::size_t first) {
    std::vector<double> x;
    x.reserve(3 * n);
    const std::vector<double>* axes[] = {&table.numbers("x_m"), &table.numbers("y_m"), &table.numbers("z_m")};
    for (std::size_t p = first; p < first + n; ++p) {
      for (const auto* axis : axes) x.push_back(1e3 * (*axis)[p]);
    }
    return x;
  };
  view.reference = positions(points, 0);
  for (const std::string& region : regions) view.regions.push_back({report::in_words(region), {}, {}});
  const auto region_of = [&](const data::Table& table, std::size_t row) -> report::ViewRegion& {
    return view.regions.at(static_cast<std::size_t>(table.numbers("region")[row]));
  };
  for (std::size_t t = 0; t < triangles.rows(); ++t)
    region_of(triangles, t)
        .triangles.push_back({static_cast<int>(triangles.numbers("a")[t]),
                              static_cast<int>(triangles.numbers("b")[t]),
                              static_cast<int>(triangles.numbers("c")[t])});
  for (std::size_t e = 0; e < edges.rows(); ++e)
    region_of(edges, e).edges.push_back(
        {static_cast<int>(edges.numbers("a")[e]), static_cast<int>(edges.numbers("b")[e])});
  std::vector<std::string> order;
  for (std::size_t c = 4; c < states.columns.size(); ++c) order.push_back(states.columns[c].name);
  for (const std::string& name : order) view.fields.push_back({label_of_field(name), {}});
  const std::size_t count = n > 0 ? states.rows() / n : 0;
  for (std::size_t s = 0; s < count; ++s) {
    view.states.push_back({s < labels.size() ? labels[s] : "", positions(states, s * n)});
    for (std::size_t f = 0; f < order.size(); ++f) {
      const std::vector<double>& column = states.numbers(order[f]);
      std::vector<double> values(column.begin() + static_cast<std::ptrdiff_t>(s * n),
                                 column.begin() + static_cast<std::ptrdiff_t>((s + 1) * n));
      const double scale = order[f].ends_with("_pa") ? 1e-3 : order[f].ends_with("_m") ? 1e3 : 1.0;
      for (double& v : values) v *= scale;
      view.fields[f].values.push_back(std::move(values));
    }
  }
  return view;
}

}  // namespace brachium::pipelines
