#pragma once
/// Surfaces of rigid bodies from files of other programs: triangles, lengths in metres.
///
/// | format | what is read                                                                            |
/// |--------|-----------------------------------------------------------------------------------------|
/// | .stl   | ASCII and binary; equal corners become one point; the stated normals are left aside      |
/// | .obj   | `v` and `f`, also with `/` and negative indices; faces of more corners are cut into a fan |
///
/// Mistakes are told with file and line (text) or byte (binary): mesh-unit-missing, mesh-truncated,
/// mesh-syntax, mesh-index, mesh-empty, mesh-unsupported. Whether the surface is closed is judged by who
/// needs it closed. Sources: StereoLithography Interface Specification, 3D Systems, 1989; Object Files
/// (.obj), Wavefront, appendix B1.

#include <Eigen/Core>
#include <filesystem>
#include <string>

namespace brachium::io {

struct TriangleFile {
  Eigen::Matrix3Xd points;  ///< 3 x n_points [m]
  Eigen::Matrix3Xi
      triangles;  ///< 3 x n_triangles, counter-clockwise seen from outside where the file has it so
};

/// By the file's extension. `length_unit`: "m", "mm", ...; such files state none.
TriangleFile read_triangles(const std::filesystem::path& file, const std::string& length_unit);

}  // namespace brachium::io
