#pragma once
/// Bytes of VTK's XML files: base64, zlib blocks and numbers of any type. For the .cpp files of data/io only.

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace brachium::io {

struct VtkEncoding {
  bool base64 = true;
  bool zlib = false;
  bool wide_header = false;  ///< 8 byte words in headers, else 4
  bool big_endian = false;
};

/// The content of one array whose data start at stream[0]; on a mistake nothing, and `reason` tells it.
/// Uncompressed: [byte count][bytes]. zlib: [blocks][block size][size of a last, partial block][compressed
/// sizes...][blocks].
std::optional<std::string> decode_array(std::string_view stream, const VtkEncoding& encoding,
                                        std::string& reason);

/// Bytes per number of a VTK type name ("Float64", "Int32", ...); 0: not known.
std::size_t vtk_type_size(std::string_view type);

/// Numbers of `type`, all of `bytes` (which must be whole numbers long).
std::vector<double> vtk_numbers(const std::string& bytes, std::string_view type, bool big_endian);

}  // namespace brachium::io
