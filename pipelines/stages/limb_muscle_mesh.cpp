/// Muscles of a limb file that come as meshes.

#include <fmt/format.h>

#include <set>

#include "data/io/mesh_file.hpp"
#include "fem/limb/in_situ.hpp"
#include "fem/mesh/convert.hpp"
#include "pipelines/stages/limb_scene_parts.hpp"

namespace brachium::pipelines {
namespace limb_parts {
namespace {

constexpr const char* origin = "origin";
constexpr const char* insertion = "insertion";
constexpr const char* side = "side";

void rename(data::Mesh& mesh, const std::string& from, const std::string& to) {
  mesh.surface(from);  // throws where there is none
  if (from == to) return;
  std::erase_if(mesh.surfaces, [&](const data::NamedSurface& s) { return s.name == to; });
  for (data::NamedSurface& s : mesh.surfaces)
    if (s.name == from) s.name = to;
}

/// Surfaces origin and insertion under these names, and `side`: all the rest of the boundary.
void name_surfaces(data::Mesh& mesh, const std::string& at_origin, const std::string& at_insertion) {
  rename(mesh, at_origin, origin);
  rename(mesh, at_insertion, insertion);
  std::erase_if(mesh.surfaces, [](const data::NamedSurface& s) { return s.name == side; });
  std::set<data::CellFace> ends;
  for (const char* name : {origin, insertion})
    ends.insert(mesh.surface(name).faces.begin(), mesh.surface(name).faces.end());
  data::NamedSurface rest{side, {}};
  for (const data::CellFace& f : data::boundary_faces(mesh))
    if (!ends.contains(f)) rest.faces.push_back(f);
  mesh.surfaces.push_back(std::move(rest));
}

/// Quadratic cells of the same kind.
data::Mesh quadratic(const data::Mesh& mesh) {
  return fem::elevate(mesh,
                      data::faces_per_cell(mesh.type) == 4 ? data::CellType::tet10 : data::CellType::hex27);
}

}  // namespace

void read_muscle_mesh(io::TomlTable& muscle, const Draft& draft, LimbMuscle& out) {
  auto table = muscle.table("mesh");
  if (!table) return;
  io::MeshReadOptions read;
  const std::string file = table->require_text("file");
  read.length_unit = table->require_text("length_unit");
  read.region_array = table->text("region_array").value_or("region");
  if (auto numbers = table->table("region_numbers")) {
    for (const auto& [name, node] : numbers->node().members)
      if (const auto n = numbers->integer(name)) read.region_names[*n] = name;
    numbers->finish();
  }
  const std::string shape = table->require_text("shape");
  const std::vector<std::string> shapes{"stress_free", "in_situ"};
  if (!shape.empty() && shape != shapes[0] && shape != shapes[1])
    table->error("unknown-value", fmt::format("a mesh cannot show a muscle `{}`", shape), "shape",
                 data::suggest(shape, shapes));
  const std::string at_origin = table->text("origin").value_or(origin),
                    at_insertion = table->text("insertion").value_or(insertion);
  const std::vector<std::string> tendons = table->texts("tendons").value_or(std::vector<std::string>{});
  table->finish();
  if (file.empty() || read.length_unit.empty() || (shape != shapes[0] && shape != shapes[1])) return;
  try {
    data::Mesh mesh = quadratic(io::read_mesh(draft.folder / file, read).mesh);
    name_surfaces(mesh, at_origin, at_insertion);
    fem::move(mesh, draft.to_arm.linear(), draft.to_arm.translation());
    out.body.formulation = mesh.type == data::CellType::tet10 ? fem::Formulation::p2b_p1_discontinuous
                                                              : fem::Formulation::q2_p1_discontinuous;
    if (shape == "in_situ") {
      out.body = fem::with_in_situ_guess(out.body, mesh, tendons);
      out.in_situ = std::move(mesh);
    } else {
      out.body = fem::with_stress_free_shape(out.body, std::move(mesh), tendons);
    }
  } catch (const data::InputError& e) {
    for (const data::Diagnostic& d : e.diagnostics())
      muscle.error(d.code, fmt::format("muscle `{}`: {}", out.body.name, d.message), "mesh", d.help);
  }
}

}  // namespace limb_parts

std::vector<std::filesystem::path> files_of_limb(const std::filesystem::path& file) {
  std::vector<std::filesystem::path> files;
  io::TomlNode tree;
  try {
    tree = io::read_toml(file);
  } catch (const data::InputError&) {
    return files;  // told where the limb is read
  }
  for (const auto& [list, kind] : {std::pair{"bone", "triangles"}, std::pair{"muscle", "mesh"}}) {
    const io::TomlNode* entries = tree.find(list);
    if (!entries) continue;
    for (const io::TomlNode& entry : entries->items) {
      const io::TomlNode* body = entry.find(kind);
      const io::TomlNode* name = body ? body->find("file") : nullptr;
      std::error_code ignored;
      if (name && std::filesystem::is_regular_file(file.parent_path() / name->text, ignored))
        files.push_back(file.parent_path() / name->text);
    }
  }
  return files;
}

std::optional<std::string> make_stress_free(LimbMuscle& m, const LimbScene& limb,
                                            const fem::SolvedMuscleOptions& options) {
  if (!m.in_situ) return std::nullopt;
  fem::InSituReport report;
  m.body = fem::find_stress_free(m.body, *m.in_situ, m.body.shape->tendons, limb.range, limb.hinge,
                                 limb.humerus, options, &report);
  m.in_situ.reset();
  return fmt::format(
      "{}: stress-free shape found from the shape in situ by {} equilibria, points within "
      "{:.2g} um; its distal end lies {:.2g} mm beside the path",
      m.body.name, report.equilibria, 1e6 * report.greatest_error_m, 1e3 * report.beside_path_m);
}

}  // namespace brachium::pipelines
