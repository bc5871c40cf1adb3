#include "pipelines/stages/fem_mesh.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
#include <numbers>

#include "data/io/mesh_file.hpp"
#include "fem/mesh/block.hpp"
#include "fem/mesh/convert.hpp"
#include "fem/mesh/cylinder.hpp"
#include "fem/mesh/pennate.hpp"

namespace brachium::pipelines {
namespace {

using data::InputError;

int whole(const Options& options, const std::string& key) {
  return static_cast<int>(options.integer(key));
}

Eigen::Vector3d vector_or(const Options& options, const std::string& key, const Eigen::Vector3d& fallback) {
  if (!options.has(key)) return fallback;
  const std::vector<double>& v = options.numbers(key);
  return {v[0], v[1], v[2]};
}

data::Mesh block(const Options& o, data::CellType type) {
  fem::BlockOptions b;
  b.type = type;
  const std::vector<double>&size = o.numbers("size_m"), &cells = o.numbers("cells");
  for (const double n : cells) {
    if (n != std::floor(n) || n > 10000.0)
      throw InputError("out-of-range", fmt::format("`cells` = {:g} of the block is no number of cells", n),
                       "whole numbers from 1 to 10000");
  }
  const Eigen::Vector3d grading = vector_or(o, "grading", Eigen::Vector3d::Ones());
  b.x = {size[0], static_cast<int>(cells[0]), grading[0]};
  b.y = {size[1], static_cast<int>(cells[1]), grading[1]};
  b.z = {size[2], static_cast<int>(cells[2]), grading[2]};
  b.corner_m = vector_or(o, "corner_m", Eigen::Vector3d::Zero());
  b.region = o.text("region");
  return fem::block(b);
}

fem::RoundSection round_section(const Options& o) {
  return {whole(o, "core_cells"), whole(o, "ring_cells"), o.number("ring_grading")};
}

data::Mesh cylinder(const Options& o, data::CellType type) {
  fem::CylinderOptions c;
  c.type = type;
  c.radius_m = o.number("radius_m");
  c.radius_y_m = o.maybe_number("radius_y_m").value_or(0.0);
  c.z = {o.number("length_m"), whole(o, "cells"), o.number("grading")};
  c.section = round_section(o);
  c.region = o.text("region");
  return fem::cylinder(c);
}

data::Mesh spindle(const Options& o, data::CellType type) {
  fem::SpindleOptions s;
  s.type = type;
  s.origin_tendon = {o.number("origin_tendon_m"), whole(o, "origin_tendon_cells")};
  s.belly = {o.number("belly_m"), whole(o, "belly_cells"), o.number("belly_grading"), true};
  s.insertion_tendon = {o.number("insertion_tendon_m"), whole(o, "insertion_tendon_cells")};
  s.belly_radius_m = o.number("belly_radius_m");
  s.tendon_radius_m = o.number("tendon_radius_m");
  s.flatness = o.number("flatness");
  s.section = round_section(o);
  s.aponeurosis_thickness_norm = o.number("aponeurosis_thickness_norm");
  s.aponeurosis_cells = whole(o, "aponeurosis_cells");
  s.aponeurosis_origin_norm = o.number("aponeurosis_origin_norm");
  s.aponeurosis_insertion_norm = o.number("aponeurosis_insertion_norm");
  s.transition_m = o.number("transition_m");
  return fem::spindle(s);
}

data::Mesh pennate(const Options& o, data::CellType type) {
  fem::PennateOptions p;
  p.type = type;
  p.length = {o.number("length_m"), whole(o, "length_cells"), o.number("length_grading"), true};
  p.width = {o.number("width_m"), whole(o, "width_cells")};
  p.thickness = {o.number("thickness_m"), whole(o, "thickness_cells"), o.number("thickness_grading"), true};
  p.pennation_rad = o.number("pennation_deg") * std::numbers::pi / 180.0;
  p.aponeurosis = {o.number("aponeurosis_m"), whole(o, "aponeurosis_cells")};
  p.tendon = {o.number("tendon_m"), whole(o, "tendon_cells")};
  return fem::pennate_belly(p);
}

FemMesh from_file(const Options& options, data::CellType type) {
  io::MeshReadOptions read;
  const std::filesystem::path file = options.text("file");
  if (!options.has("length_unit"))
    throw InputError(
        "mesh-unit-missing",
        fmt::format("`mesh` names the file `{}` without `length_unit`", file.filename().string()),
        "mesh files do not state their unit: give length_unit = \"mm\", or whatever it is");
  read.length_unit = options.text("length_unit");
  read.region_array = options.text("region_array");
  for (const auto& [name, number] : options.number_map("region_numbers"))
    read.region_names[std::llround(number)] = name;
  io::MeshFile content = io::read_mesh(file, read);
  FemMesh out{std::move(content.mesh),
              fmt::format("`{}`, coordinates in {}", file.filename().string(), read.length_unit),
              std::move(content.notes)};
  if (out.mesh.type != type && options.boolean("elevate")) {
    out.source += fmt::format(", {} elevated to {}", data::to_string(out.mesh.type), data::to_string(type));
    out.mesh = fem::elevate(out.mesh, type);
  }
  return out;
}

}  // namespace

FemMesh fem_mesh(const Options& options, fem::Formulation formulation) {
  const data::CellType type = fem::cell_type(formulation);
  std::vector<std::string> given;
  for (const std::string key : {"file", "block", "cylinder", "spindle", "pennate"}) {
    if (options.has(key)) given.push_back(key);
  }
  if (given.size() != 1) {
    throw InputError("mesh-choice",
                     given.empty()
                         ? std::string("`mesh` names no body")
                         : fmt::format("`mesh` names {} bodies: {}", given.size(), fmt::join(given, ", ")),
                     "give one of file, block, cylinder, spindle, pennate");
  }
  FemMesh out;
  if (given.front() == "file") {
    out = from_file(options, type);
  } else {
    const Options& o = options.table(given.front());
    out.mesh = given.front() == "block"      ? block(o, type)
               : given.front() == "cylinder" ? cylinder(o, type)
               : given.front() == "spindle"  ? spindle(o, type)
                                             : pennate(o, type);
    out.source = given.front() + " generator";
  }
  for (int k = 0; k < whole(options, "refine"); ++k) out.mesh = fem::refine(out.mesh);
  if (whole(options, "refine") > 0) out.source += fmt::format(", refined {} times", whole(options, "refine"));
  return out;
}

}  // namespace brachium::pipelines
