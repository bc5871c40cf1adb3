/// VTK's XML unstructured grids (.vtu).

#include <fmt/format.h>

#include <charconv>
#include <pugixml.hpp>

#include "data/io/mesh_cursor.hpp"
#include "data/io/vtk_data.hpp"
#include "data/io/vtk_grid.hpp"

namespace brachium::io {
namespace {

class VtuReader {
 public:
  explicit VtuReader(const std::filesystem::path& file) : in_(file) {}

  RawMesh read(const MeshReadOptions& options) {
    cut_off_appended_data();
    const pugi::xml_parse_result parsed = document_.load_buffer(xml_.data(), xml_.size());
    if (!parsed) {
      in_.fail_at(static_cast<std::size_t>(std::max<std::ptrdiff_t>(0, parsed.offset)), "mesh-syntax",
                  fmt::format("this is no well-formed XML: {}", parsed.description()),
                  "write or fetch the file again");
    }
    const pugi::xml_node root = document_.child("VTKFile");
    if (!root || std::string_view(root.attribute("type").value()) != "UnstructuredGrid")
      in_.fail("mesh-syntax", "this is no VTK file of type UnstructuredGrid", "give a .vtu file");
    read_encoding(root);
    const pugi::xml_node grid_node = root.child("UnstructuredGrid");
    const pugi::xml_node piece = grid_node.child("Piece");
    if (!piece) fail(root, "mesh-truncated", "there is no Piece");
    if (piece.next_sibling("Piece"))
      fail(piece, "mesh-unsupported", "several Pieces are not read",
           "merge them into one, with shared points");
    const std::size_t n_points = attribute_count(piece, "NumberOfPoints"),
                      n_cells = attribute_count(piece, "NumberOfCells");

    VtkGrid grid;
    const pugi::xml_node points = piece.child("Points").child("DataArray");
    if (!points) fail(piece, "mesh-truncated", "there are no Points");
    grid.points = array(points).numbers;
    if (grid.points.size() != 3 * n_points)
      fail(points, "mesh-size", fmt::format("{} coordinates for {} points", grid.points.size(), n_points));
    for (const pugi::xml_node node : piece.child("Cells").children("DataArray")) {
      const std::string_view name = node.attribute("Name").value();
      if (name == "connectivity") grid.connectivity = array(node).numbers;
      if (name == "offsets") grid.offsets = array(node).numbers;
      if (name == "types") grid.types = array(node).numbers;
    }
    if (grid.types.size() != n_cells || grid.offsets.size() != n_cells)
      fail(piece, "mesh-size",
           fmt::format("{} cells, but {} types and {} offsets", n_cells, grid.types.size(),
                       grid.offsets.size()));
    for (const pugi::xml_node node : piece.child("PointData")) add_array(node, grid.point_arrays);
    for (const pugi::xml_node node : piece.child("CellData")) add_array(node, grid.cell_arrays);
    return raw_mesh(grid, in_, options);
  }

 private:
  [[noreturn]] void fail(const pugi::xml_node& node, const std::string& code, const std::string& message,
                         const std::string& help = {}) const {
    in_.fail_at(static_cast<std::size_t>(std::max<std::ptrdiff_t>(0, node.offset_debug())), code, message,
                help);
  }

  /// Raw appended data are not XML: what stands between the underscore and the last end tag is kept apart.
  void cut_off_appended_data() {
    const std::string& text = in_.text();
    const std::size_t tag = text.find("<AppendedData");
    if (tag == std::string::npos) {
      xml_ = text;
      return;
    }
    const std::size_t close = text.find('>', tag), start = text.find('_', tag);
    const std::size_t end = text.rfind("</AppendedData>");
    if (close == std::string::npos || start == std::string::npos || end == std::string::npos || end < start)
      in_.fail_at(text.size(), "mesh-truncated", "the appended data do not end",
                  "write or fetch the file again");
    appended_ = std::string_view(text).substr(start + 1, end - start - 1);
    xml_ = text.substr(0, close + 1) + text.substr(end);
  }

  void read_encoding(const pugi::xml_node& root) {
    encoding_.big_endian = std::string_view(root.attribute("byte_order").value()) == "BigEndian";
    encoding_.wide_header = std::string_view(root.attribute("header_type").value()) == "UInt64";
    const std::string compressor = root.attribute("compressor").value();
    encoding_.zlib = compressor == "vtkZLibDataCompressor";
    if (!compressor.empty() && !encoding_.zlib)
      fail(root, "mesh-unsupported", fmt::format("compression `{}` is not read", compressor),
           "write with zlib or without compression");
    appended_base64_ = std::string_view(root.child("AppendedData").attribute("encoding").value()) == "base64";
  }

  std::size_t attribute_count(const pugi::xml_node& node, const char* name) const {
    const std::string text = node.attribute(name).value();
    const std::size_t begin = std::min(text.find_first_not_of(' '), text.size());
    long long value = -1;
    std::from_chars(text.data() + begin, text.data() + text.size(), value);
    if (value < 0) fail(node, "mesh-syntax", fmt::format("{} is missing or no count", name));
    return static_cast<std::size_t>(value);
  }

  VtkArray array(const pugi::xml_node& node) const {
    VtkArray out;
    out.name = node.attribute("Name").value();
    const std::string type = node.attribute("type").value();
    if (vtk_type_size(type) == 0)
      fail(node, "mesh-unsupported",
           fmt::format("array `{}` is of type `{}`, which is not read", out.name, type));
    if (node.attribute("NumberOfComponents")) out.components = attribute_count(node, "NumberOfComponents");
    if (out.components < 1 || out.components > 100)
      fail(node, "mesh-syntax", fmt::format("array `{}` has {} components", out.name, out.components));
    const std::string format = node.attribute("format").value();
    if (format == "ascii" || format.empty()) {
      const std::string_view text = node.text().get();
      for (const char *at = text.data(), *end = at + text.size(); at != end;) {
        if (*at == ' ' || *at == '\n' || *at == '\t' || *at == '\r') {
          ++at;
          continue;
        }
        double value = 0.0;
        const auto [next, status] = std::from_chars(at, end, value);
        if (status != std::errc())
          fail(node, "mesh-syntax",
               fmt::format(
                   "array `{}` holds `{}`, which is no number", out.name,
                   std::string_view(at, std::min<std::size_t>(20, static_cast<std::size_t>(end - at)))));
        out.numbers.push_back(value);
        at = next;
      }
    } else if (format == "binary" || format == "appended") {
      VtkEncoding encoding = encoding_;
      std::string_view stream = node.text().get();
      if (format == "appended") {
        encoding.base64 = appended_base64_;
        const std::size_t offset = attribute_count(node, "offset");
        if (offset >= appended_.size())
          fail(node, "mesh-truncated",
               fmt::format("array `{}` begins behind the end of the appended data", out.name),
               "write or fetch the file again");
        stream = appended_.substr(offset);
      }
      std::string reason;
      const auto bytes = decode_array(stream, encoding, reason);
      if (!bytes)
        fail(node, "mesh-truncated", fmt::format("array `{}`: {}", out.name, reason),
             "write or fetch the file again");
      if (bytes->size() % vtk_type_size(type) != 0)
        fail(node, "mesh-truncated", fmt::format("array `{}` does not hold whole numbers", out.name));
      out.numbers = vtk_numbers(*bytes, type, encoding.big_endian);
    } else {
      fail(node, "mesh-unsupported", fmt::format("array `{}` has the format `{}`", out.name, format));
    }
    if (type == "String") {  // characters, each text ended by 0
      out.texts.emplace_back();
      for (const double c : out.numbers) {
        if (c == 0.0) {
          out.texts.emplace_back();
        } else {
          out.texts.back().push_back(static_cast<char>(static_cast<int>(c) & 0xFF));
        }
      }
      out.texts.pop_back();
      out.numbers.clear();
    } else if (out.numbers.size() % out.components != 0) {
      fail(node, "mesh-size",
           fmt::format("array `{}`: {} numbers do not make tuples of {}", out.name, out.numbers.size(),
                       out.components));
    }
    return out;
  }

  void add_array(const pugi::xml_node& node, std::vector<VtkArray>& list) const {
    const std::string_view kind = node.name();
    if (kind == "DataArray" || kind == "Array") list.push_back(array(node));
  }

  MeshCursor in_;
  pugi::xml_document document_;
  std::string xml_;
  std::string_view appended_;
  VtkEncoding encoding_;
  bool appended_base64_ = false;
};

}  // namespace

MeshFile read_vtu(const std::filesystem::path& file, const MeshReadOptions& options) {
  metres_per_unit(file, options);
  return assemble(VtuReader(file).read(options), options);
}

}  // namespace brachium::io
