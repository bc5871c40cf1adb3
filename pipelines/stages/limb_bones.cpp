/// Bones of a limb file: shapes that a muscle may touch, and surfaces to look at.

#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "data/io/triangle_file.hpp"
#include "fem/contact/distance_grid.hpp"
#include "fem/contact/triangle_tree.hpp"
#include "pipelines/stages/limb_scene_parts.hpp"

namespace brachium::pipelines::limb_parts {
namespace {

using Eigen::Vector3d;

constexpr int around = 24, along = 12;  // facets of round bones in pictures

/// The unit sphere by rings of latitude about z, poles first and last.
BoneSurface unit_sphere() {
  BoneSurface s;
  s.points.resize(3, 2 + (along - 1) * around);
  s.points.col(0) = Vector3d::UnitZ();
  s.points.col(s.points.cols() - 1) = -Vector3d::UnitZ();
  std::vector<Eigen::Vector3i> t;
  const auto ring = [](int i, int j) { return 1 + (i - 1) * around + j % around; };
  for (int i = 1; i < along; ++i) {
    for (int j = 0; j < around; ++j) {
      const double polar = std::numbers::pi * i / along, turn = 2.0 * std::numbers::pi * j / around;
      s.points.col(ring(i, j)) << std::sin(polar) * std::cos(turn), std::sin(polar) * std::sin(turn),
          std::cos(polar);
      if (i == 1) t.emplace_back(0, ring(1, j), ring(1, j + 1));
      if (i == along - 1) t.emplace_back(static_cast<int>(s.points.cols()) - 1, ring(i, j + 1), ring(i, j));
      if (i == along - 1) continue;
      t.emplace_back(ring(i, j), ring(i + 1, j), ring(i + 1, j + 1));
      t.emplace_back(ring(i, j), ring(i + 1, j + 1), ring(i, j + 1));
    }
  }
  s.triangles.resize(3, static_cast<Eigen::Index>(t.size()));
  for (std::size_t k = 0; k < t.size(); ++k) s.triangles.col(static_cast<Eigen::Index>(k)) = t[k];
  return s;
}

/// Halves of the sphere drawn apart along the axis.
BoneSurface surface_of(const fem::Capsule& c) {
  BoneSurface s = unit_sphere();
  const Vector3d axis = c.to_m - c.from_m;
  const Eigen::Quaterniond turn = Eigen::Quaterniond::FromTwoVectors(Vector3d::UnitZ(), axis);
  for (Eigen::Index p = 0; p < s.points.cols(); ++p) {
    const Vector3d u = s.points.col(p);
    s.points.col(p) = (u.z() > 1e-9 ? c.to_m : c.from_m) + c.radius_m * (turn * u);
  }
  return s;
}

BoneSurface surface_of(const fem::Ellipsoid& e) {
  BoneSurface s = unit_sphere();
  s.points = ((e.axes * e.semi_axes_m.asDiagonal() * s.points).colwise() + e.centre_m).eval();
  return s;
}

BoneSurface surface_of(const fem::Sphere& b) {
  BoneSurface s = unit_sphere();
  s.points = ((b.radius_m * s.points).colwise() + b.centre_m).eval();
  return s;
}

struct Shape {
  fem::RigidShape rigid;
  BoneSurface surface;
};

Vector3d place(const Draft& draft, io::TomlTable& table, const std::string& key) {
  const auto at = places(table, key, 3);
  return at ? Vector3d(draft.to_arm * Vector3d(*at)) : Vector3d::Zero();
}

std::optional<Shape> triangles(const Draft& draft, io::TomlTable& table, const std::string& bone,
                               bool moves) {
  const std::string file = table.require_text("file"), unit = table.require_text("length_unit");
  const double spacing = millimetres(table, "spacing_mm", false, 1e-3);
  const double smoothing = millimetres(table, "smoothing_mm", true, 0.0);
  if (file.empty() || unit.empty() || !(spacing > 0.0)) return std::nullopt;
  try {
    const io::TriangleFile read = io::read_triangles(draft.folder / file, unit);
    fem::TriangleMesh mesh{draft.to_arm * read.points, read.triangles};
    Shape shape{{}, {bone, moves, mesh.points, mesh.triangles}};
    const fem::TriangleTree tree(std::move(mesh));
    // A bone that only is drawn needs no distances.
    if (!moves)
      shape.rigid = fem::TriangleBody{
          std::make_shared<const fem::DistanceGrid>(tree, spacing, 30.0 * spacing, smoothing)};
    return shape;
  } catch (const data::InputError& e) {
    const data::Diagnostic& d = e.diagnostics().front();
    table.error(d.code, fmt::format("bone `{}`: {}", bone, d.message), "file", d.help);
    return std::nullopt;
  }
}

std::optional<Shape> read_shape(Draft& draft, io::TomlTable& bone, const std::string& name, bool moves) {
  const std::vector<std::string> kinds{"sphere", "capsule", "ellipsoid", "triangles"};
  std::string kind;
  int count = 0;
  for (const std::string& k : kinds) {
    if (bone.has(k)) kind = k, ++count;
    bone.know(k);
  }
  if (count != 1) {
    bone.error(count == 0 ? "missing-key" : "contradiction",
               fmt::format("bone `{}` {} one of `sphere`, `capsule`, `ellipsoid`, `triangles`", name,
                           count == 0 ? "needs" : "takes only"));
    return std::nullopt;
  }
  auto table = bone.table(kind);
  if (!table) return std::nullopt;
  std::optional<Shape> shape;
  if (kind == "triangles") {
    shape = triangles(draft, *table, name, moves);
  } else if (kind == "sphere") {
    const fem::Sphere s{place(draft, *table, "centre_mm"), millimetres(*table, "radius_mm", false)};
    shape = Shape{s, surface_of(s)};
  } else if (kind == "capsule") {
    const fem::Capsule c{place(draft, *table, "from_mm"), place(draft, *table, "to_mm"),
                         millimetres(*table, "radius_mm", false)};
    shape = Shape{c, surface_of(c)};
  } else {
    fem::Ellipsoid e;
    e.centre_m = place(draft, *table, "centre_mm");
    if (const auto semi = places(*table, "semi_axes_mm", 3)) e.semi_axes_m = *semi;
    e.axes = draft.to_arm.linear();
    shape = Shape{e, surface_of(e)};
  }
  table->finish();
  if (!shape || kind == "triangles") return shape;
  try {
    fem::check(shape->rigid, name);
  } catch (const data::InputError& e) {
    bone.error(e.diagnostics().front().code, e.diagnostics().front().message, kind,
               e.diagnostics().front().help);
    return std::nullopt;
  }
  return shape;
}

}  // namespace

void read_bones(io::TomlTable& root, Draft& draft) {
  std::vector<std::string> seen;
  for (io::TomlTable& bone : root.tables("bone")) {
    const std::string name = bone.require_text("name");
    check_unique("bone", name, seen, bone);
    const std::string segment = bone.require_text("segment");
    const std::vector<std::string> segments{"humerus", "forearm"};
    if (!segment.empty() && segment != segments[0] && segment != segments[1])
      bone.error("unknown-value", fmt::format("bone `{}` cannot belong to `{}`", name, segment), "segment",
                 data::suggest(segment, segments));
    const bool moves = segment == "forearm";
    if (auto shape = read_shape(draft, bone, name, moves)) {
      shape->surface.bone = name;
      shape->surface.moves = moves;
      if (moves) {
        draft.scene.forearm.push_back(name);
      } else {
        draft.scene.humerus.push_back({name, shape->rigid});
      }
      draft.scene.surfaces.push_back(std::move(shape->surface));
    }
    bone.finish();
  }
}

}  // namespace brachium::pipelines::limb_parts
