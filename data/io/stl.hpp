#pragma once
/// Triangle surfaces from STL files, text or binary (3D Systems 1988, "StereoLithography Interface
/// Specification"). Corners that coincide are one point; the normals of the file are not read, the order of
/// the corners says which side is outside.

#include <Eigen/Core>
#include <filesystem>
#include <string>

namespace brachium::io {

struct TriangleFile {
  Eigen::Matrix3Xd points;     ///< 3 x n_points [m]
  Eigen::Matrix3Xi triangles;  ///< 3 x n_triangles, indices into points
};

/// `length_unit`: "m", "cm", "mm", ...; the format states none. Throws InputError: "missing-file",
/// "empty-file", "mesh-unit-missing", "mesh-truncated", "mesh-syntax" with line (text) or byte (binary).
TriangleFile read_stl(const std::filesystem::path& file, const std::string& length_unit);

}  // namespace brachium::io
