#pragma once
/// From the options of fem.solve to a boundary-value problem.

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "data/model/table.hpp"
#include "fem/solve/problem.hpp"
#include "pipelines/stage.hpp"
#include "pipelines/stages/fem_mistakes.hpp"

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

/// Builds and checks the problem (fem::check). Throws InputError with every mistake found, each with its
/// place: what one part depends on and cannot be built is left out, the rest is still looked at.
FemProblem build_fem_problem(const Options& options);

// ---------------------------------------------------------------- its parts

/// Materials as the options give them, one a region of the mesh; those that cannot be read are left out.
/// `notes`: one row a region.
std::vector<fem::RegionMaterial> fem_materials(const Options& options, const data::Mesh& mesh,
                                               Mistakes& mistakes, data::Table& notes);

/// Fibres and blending; `directions`: statistics. Whether they could be built.
bool fem_tissue(const Options& options, const data::Mesh& mesh, fem::Formulation formulation,
                Mistakes& mistakes, fem::TissueField& field, data::Table& directions);

/// Boundary conditions as the options give them; their surfaces are left to fem::check.
std::vector<fem::BoundaryCondition> fem_conditions(const Options& options, Mistakes& mistakes);

/// The load programme; a number instead of names of regions stands for all with an active law.
std::vector<fem::Phase> fem_programme(const Options& options, const data::Mesh& mesh,
                                      const std::vector<fem::RegionMaterial>& materials, Mistakes& mistakes);

/// Contacts with rigid bodies; triangle meshes are read from their files, and how well they are represented
/// is noted.
std::vector<fem::Contact> fem_contacts(const Options& options, Mistakes& mistakes,
                                       std::vector<data::Diagnostic>& notes);

/// Regions that an entry's `regions` names; all where it names none. Throws InputError("missing-region").
std::vector<std::string> regions_of(const Options& entry, const data::Mesh& mesh, const std::string& what);

/// The vector of that key; zero where it is absent.
Eigen::Vector3d vector_of(const Options& entry, const std::string& key);

}  // namespace brachium::pipelines
