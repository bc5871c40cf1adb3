#pragma once
/// From the options of fem.solve to a boundary-value problem.

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "data/model/table.hpp"
#include "fem/solve/problem.hpp"
#include "pipelines/stage.hpp"

namespace brachium::pipelines {

/// A problem, and what the report says of where its parts come from.
struct FemProblem {
  fem::Problem problem;
  std::string mesh_source;  ///< "spindle generator", "biceps.msh (mm)"
  data::Table quality;      ///< fem/mesh/quality.hpp
  data::Table materials;    ///< region, law, parameters, source, volume
  data::Table directions;   ///< fibre statistics; may have no rows
  std::vector<data::Diagnostic> notes;
};

/// Builds and checks the problem (fem::check). Throws InputError with every mistake found: what one part
/// depends on and cannot be built is left out, the rest is still looked at.
FemProblem build_fem_problem(const Options& options);

/// Materials as the options give them, one a region of the mesh; mistakes go to `mistakes`. `notes`: one row
/// a region.
std::vector<fem::RegionMaterial> fem_materials(const Options& options, const data::Mesh& mesh,
                                               std::vector<data::Diagnostic>& mistakes, data::Table& notes);

/// Regions that an entry's `regions` names; all where it names none.
std::vector<std::string> regions_of(const Options& entry, const data::Mesh& mesh, const std::string& what);

/// Keys of `entry` beside `allowed` are mistakes: unused-option.
void only_keys(const Options& entry, const std::vector<std::string>& allowed, const std::string& owner,
               std::vector<data::Diagnostic>& mistakes);

}  // namespace brachium::pipelines
