#pragma once
/// The XDMF text beside a VTKHDF file. For the .cpp files of data/io only.

#include "data/io/mesh_writer.hpp"

namespace brachium::io {

/// XDMF 3: one grid a step. Values that move are slabs of the datasets in `data_file`; `first` tells their
/// names and sizes. Without steps: one grid with the mesh's own fields.
std::string xdmf_text(const std::string& data_file, const data::Mesh& mesh, const std::vector<double>& times,
                      const MeshStep& first);

}  // namespace brachium::io
