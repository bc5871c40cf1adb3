#pragma once
/// Meshes with fields over load steps or time, for ParaView and Python.
///
///   NAME.vtkhdf  one HDF5 file with the mesh and all steps in VTK's own layout (VTKHDF 2.0,
///   UnstructuredGrid, `Steps`;
///                docs.vtk.org "VTKHDF File Format"); a static file (VTKHDF 1.0) where there are no steps
///   NAME.xdmf    XDMF 3 beside it, a temporal collection that points into the same datasets: ParaView
///   before 5.12 reads
///                static VTKHDF only
///
/// Every dataset of values has a `unit` attribute. Cell array `region` holds indices into the names in its
/// attribute `names` (JSON). Both files are written atomically by finish(); XDMF after the data it refers to.

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "data/model/mesh.hpp"

namespace brachium::io {

struct MeshField {
  std::string name;
  std::string unit;        ///< SI symbol, "1" for pure numbers
  Eigen::MatrixXd values;  ///< components x points, or components x cells
};

struct MeshStep {
  double time = 0.0;  ///< of the step; any rising parameter
  std::vector<MeshField> point_fields, cell_fields;
};

class MeshSeriesWriter {
 public:
  /// `file` should end in .vtkhdf. The mesh's own fields are written once, with unit "1". Throws InputError
  /// ("missing-folder", "write-failed", "bad-name", mesh-size).
  MeshSeriesWriter(const std::filesystem::path& file, const data::Mesh& mesh);
  ~MeshSeriesWriter();
  MeshSeriesWriter(MeshSeriesWriter&&) noexcept;
  MeshSeriesWriter& operator=(MeshSeriesWriter&&) noexcept;

  /// Every step must have the fields of the first, with equal units and components, finite, of the mesh's
  /// size, and a later time; throws std::logic_error otherwise (that is the program's mistake),
  /// InputError("write-failed") on a full disk.
  void add(const MeshStep& step);

  /// Puts both files in place. Without it nothing is left behind.
  void finish();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// Mesh and fields without time, static VTKHDF 1.0, which ParaView 5.11 reads.
void write_vtkhdf(const std::filesystem::path& file, const data::Mesh& mesh,
                  const std::vector<MeshField>& point_fields = {},
                  const std::vector<MeshField>& cell_fields = {});

}  // namespace brachium::io
