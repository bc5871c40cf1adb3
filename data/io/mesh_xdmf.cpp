#include "data/io/mesh_xdmf.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace brachium::io {
namespace {

const char* topology(data::CellType type) {
  switch (type) {
    case data::CellType::tet4:
      return "Tetrahedron";
    case data::CellType::tet10:
      return "Tetrahedron_10";
    case data::CellType::hex8:
      return "Hexahedron";
    case data::CellType::hex20:
      return "Hexahedron_20";
    case data::CellType::hex27:
      return "Hexahedron_27";
  }
  return "";
}

std::string escaped(const std::string& text) {
  std::string out;
  for (const char c : text) {
    switch (c) {
      case '&':
        out += "&amp;";
        break;
      case '<':
        out += "&lt;";
        break;
      case '>':
        out += "&gt;";
        break;
      case '"':
        out += "&quot;";
        break;
      default:
        out += c;
    }
  }
  return out;
}

const char* attribute_type(Eigen::Index components) {
  switch (components) {
    case 1:
      return "Scalar";
    case 3:
      return "Vector";
    case 6:
      return "Tensor6";
    case 9:
      return "Tensor";
    default:
      return "Matrix";
  }
}

std::string extent(Eigen::Index rows, Eigen::Index components) {
  return components == 1 ? fmt::format("{}", rows) : fmt::format("{} {}", rows, components);
}

struct Text {
  std::string file;
  std::string out;

  void attribute(const std::string& name, bool of_points, Eigen::Index components, const std::string& item) {
    out += fmt::format(
        "        <Attribute Name=\"{}\" AttributeType=\"{}\" Center=\"{}\">\n{}        </Attribute>\n",
        escaped(name), attribute_type(components), of_points ? "Node" : "Cell", item);
  }
  std::string path(const std::string& name, bool of_points) const {
    return escaped(fmt::format("{}:/VTKHDF/{}/{}", file, of_points ? "PointData" : "CellData", name));
  }
  void whole(const std::string& name, bool of_points, Eigen::Index rows, Eigen::Index components,
             const char* number) {
    attribute(name, of_points, components,
              fmt::format("          <DataItem Dimensions=\"{}\" {} Format=\"HDF\">{}</DataItem>\n",
                          extent(rows, components), number, path(name, of_points)));
  }
  /// One step of a field that moves.
  void view(const MeshField& field, bool of_points, std::size_t step) {
    const std::string path = escaped(
        fmt::format("{}:/XDMF/{}/{}/{}", file, step, of_points ? "PointData" : "CellData", field.name));
    attribute(field.name, of_points, field.values.rows(),
              fmt::format("          <DataItem Dimensions=\"{}\" NumberType=\"Float\" Precision=\"8\" "
                          "Format=\"HDF\">{}</DataItem>\n",
                          extent(field.values.cols(), field.values.rows()), path));
  }
};

}  // namespace

std::string xdmf_text(const std::string& data_file, const data::Mesh& mesh, const std::vector<double>& times,
                      const MeshStep& first) {
  constexpr const char* real = "NumberType=\"Float\" Precision=\"8\"";
  const auto points = mesh.points.cols(), cells = mesh.cells.cols();
  Text text{data_file, "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<Xdmf Version=\"3.0\">\n  <Domain>\n"};
  text.out += "    <Grid Name=\"steps\" GridType=\"Collection\" CollectionType=\"Temporal\">\n";
  const std::size_t grids = std::max<std::size_t>(1, times.size());
  for (std::size_t k = 0; k < grids; ++k) {
    text.out +=
        fmt::format("      <Grid Name=\"step {}\" GridType=\"Uniform\">\n        <Time Value=\"{}\"/>\n", k,
                    k < times.size() ? times[k] : 0.0);
    text.out += fmt::format(
        "        <Topology TopologyType=\"{}\" NumberOfElements=\"{}\">\n"
        "          <DataItem Dimensions=\"{}\" NumberType=\"Int\" Precision=\"8\" "
        "Format=\"HDF\">{}:/VTKHDF/Connectivity</DataItem>\n"
        "        </Topology>\n",
        topology(mesh.type), cells, cells * mesh.cells.rows(), escaped(data_file));
    text.out += fmt::format(
        "        <Geometry GeometryType=\"XYZ\">\n"
        "          <DataItem Dimensions=\"{} 3\" {} Format=\"HDF\">{}:/VTKHDF/Points</DataItem>\n"
        "        </Geometry>\n",
        points, real, escaped(data_file));
    text.whole("region", false, cells, 1, "NumberType=\"Int\" Precision=\"4\"");
    for (const auto& [name, field] : mesh.point_fields) text.whole(name, true, points, field.rows(), real);
    for (const auto& [name, field] : mesh.cell_fields) {
      if (name != "region") text.whole(name, false, cells, field.rows(), real);
    }
    for (std::size_t i = 0; k < times.size() && i < first.point_fields.size(); ++i)
      text.view(first.point_fields[i], true, k);
    for (std::size_t i = 0; k < times.size() && i < first.cell_fields.size(); ++i)
      text.view(first.cell_fields[i], false, k);
    text.out += "      </Grid>\n";
  }
  text.out += "    </Grid>\n  </Domain>\n</Xdmf>\n";
  return text.out;
}

}  // namespace brachium::io
