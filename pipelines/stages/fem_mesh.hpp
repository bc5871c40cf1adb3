#pragma once
/// The body of fem.solve: a mesh file, or a generator.

#include <string>

#include "data/model/mesh.hpp"
#include "fem/formulation.hpp"
#include "pipelines/stage.hpp"

namespace brachium::pipelines {

struct FemMesh {
  data::Mesh mesh;
  std::string source;  ///< "spindle generator", "biceps.msh (coordinates in mm)"
  std::vector<data::Diagnostic> notes;
};

/// `options`: the table `mesh`. Cells are those of the formulation; a file's are elevated if asked for.
/// Throws InputError.
FemMesh fem_mesh(const Options& options, fem::Formulation formulation);

}  // namespace brachium::pipelines
