/// FEBio's .feb files, mesh section of the specifications 2.5 (Geometry), 3.0 and 4.0 (Mesh), and MeshData.
/// The order of nodes of hex27 is VTK's but for the face centres: 2D planes of FEBio's shape functions
/// (FEHex27) in the order -y +x +y -x -z +z.

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <optional>
#include <pugixml.hpp>
#include <set>

#include "data/io/mesh_cursor.hpp"
#include "data/io/mesh_raw.hpp"

namespace brachium::io {
namespace {

using data::CellType;

/// Place of our node a in FEBio's list.
constexpr int febio_order[27] = {0,  1,  2,  3,  4,  5,  6,  7,  8,  9,  10, 11, 12, 13,
                                 14, 15, 16, 17, 18, 19, 23, 21, 20, 22, 24, 25, 26};

std::optional<CellType> cell_of(std::string_view type) {
  for (const CellType cell :
       {CellType::tet4, CellType::tet10, CellType::hex8, CellType::hex20, CellType::hex27}) {
    if (data::to_string(cell) == type) return cell;
  }
  return std::nullopt;
}

class FebioReader {
 public:
  explicit FebioReader(const std::filesystem::path& file) : in_(file) { raw_.file = file; }

  RawMesh read() {
    const pugi::xml_parse_result parsed = document_.load_buffer(in_.text().data(), in_.text().size());
    if (!parsed) {
      in_.fail_at(static_cast<std::size_t>(std::max<std::ptrdiff_t>(0, parsed.offset)), "mesh-syntax",
                  fmt::format("this is no well-formed XML: {}", parsed.description()),
                  "write or fetch the file again");
    }
    const pugi::xml_node root = document_.child("febio_spec");
    if (!root) in_.fail("mesh-syntax", "this is no FEBio file: there is no febio_spec");
    const std::string version = root.attribute("version").value();
    if (version != "2.5" && version != "3.0" && version != "4.0")
      fail(root, "mesh-unsupported", fmt::format("specification {} is not read", version),
           "save as 2.5, 3.0 or 4.0");
    const pugi::xml_node mesh = root.child(version == "2.5" ? "Geometry" : "Mesh");
    if (!mesh)
      fail(root, "mesh-truncated",
           fmt::format("there is no {} section", version == "2.5" ? "Geometry" : "Mesh"));
    if (mesh.attribute("from"))
      fail(mesh, "mesh-unsupported", "the mesh is in another file",
           fmt::format("give `{}` itself", mesh.attribute("from").value()));
    for (const char* name : {"Part", "Instance"}) {
      if (mesh.child(name))
        fail(mesh.child(name), "mesh-unsupported", "parts with instances are not read",
             "save the assembled mesh");
    }
    for (const pugi::xml_node nodes : mesh.children("Nodes")) read_nodes(nodes);
    for (const pugi::xml_node elements : mesh.children("Elements")) read_elements(elements);
    for (const pugi::xml_node set : mesh.children("NodeSet")) read_node_set(set);
    for (const pugi::xml_node surface : mesh.children("Surface")) read_surface(surface);
    for (const pugi::xml_node set : mesh.children("ElementSet")) read_element_set(set);
    check_domains(version == "2.5" ? mesh.child("MeshDomains") : root.child("MeshDomains"));
    for (auto& [name, members] : element_sets_) {
      Eigen::MatrixXd& field = raw_.cell_fields[name];
      field = Eigen::MatrixXd::Zero(1, static_cast<Eigen::Index>(raw_.types.size()));
      for (const int cell : members) field(0, cell) = 1.0;
    }
    for (const char* section : {"Geometry", "MeshData"}) {
      for (const pugi::xml_node data : root.child(section).children("ElementData")) read_element_data(data);
      for (const pugi::xml_node data : root.child(section).children("NodeData")) read_node_data(data);
      if (root.child(section).child("SurfaceData")) raw_.note("data on surfaces (SurfaceData) were left out");
    }
    for (const auto& [name, missing] : without_value_) note_missing(name, missing);
    for (const char* name : {"fiber", "mat_axis"}) {
      if (root.child("Material").find_node([&](const pugi::xml_node& n) {
            return std::string_view(n.name()) == name;
          }))
        raw_.note(fmt::format("<{}> within a material was left out: only MeshData are read", name));
    }
    return std::move(raw_);
  }

 private:
  [[noreturn]] void fail(const pugi::xml_node& node, const std::string& code, const std::string& message,
                         const std::string& help = {}) const {
    in_.fail_at(static_cast<std::size_t>(std::max<std::ptrdiff_t>(0, node.offset_debug())), code, message,
                help);
  }

  /// Numbers parted by commas or blanks.
  template <class T>
  std::vector<T> numbers(const pugi::xml_node& node) const {
    const std::string_view text = node.text().get();
    std::vector<T> list;
    for (const char *at = text.data(), *end = at + text.size(); at != end;) {
      if (*at == ',' || *at == ' ' || *at == '\n' || *at == '\t' || *at == '\r') {
        ++at;
        continue;
      }
      T value{};
      const auto [next, status] = std::from_chars(at, end, value);
      bool sound = status == std::errc();
      if constexpr (std::is_floating_point_v<T>) sound = sound && std::isfinite(value);
      if (!sound)
        fail(
            node, "mesh-syntax",
            fmt::format("`{}` is no number",
                        std::string_view(at, std::min<std::size_t>(20, static_cast<std::size_t>(end - at)))));
      list.push_back(value);
      at = next;
    }
    return list;
  }

  long long id_of(const pugi::xml_node& node) const {
    const std::string_view text = node.attribute("id").value();
    long long id = 0;
    const auto [end, status] = std::from_chars(text.data(), text.data() + text.size(), id);
    if (status != std::errc() || end != text.data() + text.size())
      fail(node, "mesh-syntax", fmt::format("<{}> has no id", node.name()));
    return id;
  }

  std::string name_of(const pugi::xml_node& node, const char* what) {
    const std::string name = node.attribute("name").value();
    if (name.empty()) fail(node, "mesh-syntax", fmt::format("a {} has no name", what));
    if (!names_.insert({what, name}).second)
      fail(node, "mesh-duplicate-name", fmt::format("two {}s are called `{}`", what, name),
           "a name must mean one thing: rename or merge");
    return name;
  }

  int point(const pugi::xml_node& node, long long id) const {
    const auto found = point_.find(id);
    if (found == point_.end()) fail(node, "mesh-index", fmt::format("node {} does not exist", id));
    return found->second;
  }

  void read_nodes(const pugi::xml_node& nodes) {
    for (const pugi::xml_node node : nodes.children("node")) {
      const auto x = numbers<double>(node);
      if (x.size() != 3) fail(node, "mesh-syntax", fmt::format("a node has {} coordinates", x.size()));
      const long long id = id_of(node);
      if (!point_.try_emplace(id, static_cast<int>(raw_.points.size())).second)
        fail(node, "mesh-syntax", fmt::format("node {} stands twice", id));
      raw_.points.emplace_back(x[0], x[1], x[2]);
    }
  }

  void read_elements(const pugi::xml_node& elements) {
    const std::string type = elements.attribute("type").value();
    const auto cell = cell_of(type);
    if (!cell)
      fail(elements, "mesh-cell-type", fmt::format("elements of type `{}` cannot be used", type),
           "usable: tet4, tet10, hex8, hex20, hex27");
    std::string name;
    if (elements.attribute("name")) {
      name = name_of(elements, "element block");
    } else {
      name = fmt::format("part_{}", raw_.regions.names.size() + 1);
      raw_.note(fmt::format("an element block without a name was called `{}`", name));
    }
    const int region = raw_.regions.index(name);
    std::vector<int>& block = element_blocks_[name];
    std::vector<int> nodes;
    for (const pugi::xml_node elem : elements.children("elem")) {
      const auto ids = numbers<long long>(elem);
      if (static_cast<int>(ids.size()) != data::nodes_per_cell(*cell))
        fail(elem, "mesh-size", fmt::format("an element of type {} has {} nodes", type, ids.size()));
      nodes.clear();
      for (const long long id : ids) nodes.push_back(point(elem, id));
      if (!cell_.try_emplace(id_of(elem), static_cast<int>(raw_.types.size())).second)
        fail(elem, "mesh-syntax", fmt::format("element {} stands twice", id_of(elem)));
      block.push_back(static_cast<int>(raw_.types.size()));
      raw_.add_cell(*cell, region, nodes, febio_order);
    }
  }

  /// Ids as a list in the text (4.0) or one child each (2.5, 3.0).
  std::vector<long long> members(const pugi::xml_node& set) const {
    std::vector<long long> ids;
    bool children = false;
    for (const pugi::xml_node child : set.children()) {
      if (child.type() != pugi::node_element) continue;
      children = true;
      if (!child.attribute("id"))
        fail(child, "mesh-unsupported", fmt::format("<{}> within a set is not read", child.name()),
             "list the members themselves");
      ids.push_back(id_of(child));
    }
    return children ? ids : numbers<long long>(set);
  }

  void read_node_set(const pugi::xml_node& set) {
    const std::string name = name_of(set, "node set");
    auto& list = raw_.node_sets[name];
    for (const long long id : members(set)) list.push_back(point(set, id));
  }

  void read_element_set(const pugi::xml_node& set) {
    const std::string name = name_of(set, "element set");
    auto& list = element_sets_[name];
    for (const long long id : members(set)) {
      const auto found = cell_.find(id);
      if (found == cell_.end()) fail(set, "mesh-index", fmt::format("element {} does not exist", id));
      list.push_back(found->second);
    }
  }

  void read_surface(const pugi::xml_node& surface) {
    const int number = raw_.surfaces.index(name_of(surface, "surface"));
    for (const pugi::xml_node face : surface.children()) {
      if (face.type() != pugi::node_element) continue;
      const std::string_view type = face.name();
      const bool triangle = type.starts_with("tri"), quad = type.starts_with("quad");
      if (!triangle && !quad)
        fail(face, "mesh-cell-type", fmt::format("a face of type `{}` cannot be used", type),
             "usable: tri3, tri6, quad4, quad8, quad9");
      const auto ids = numbers<long long>(face);
      const std::size_t corners = triangle ? 3 : 4;
      if (ids.size() < corners)
        fail(face, "mesh-size", fmt::format("a face of type {} has {} nodes", type, ids.size()));
      RawMesh::Facet facet;
      for (std::size_t i = 0; i < corners; ++i) facet.corners[i] = point(face, ids[i]);
      facet.surface = number;
      raw_.facets.push_back(facet);
    }
  }

  /// Members of the set that a table of MeshData is about, in their order: its entries are numbered by it.
  const std::vector<int>& set_of(const pugi::xml_node& data, const char* attribute,
                                 const std::map<std::string, std::vector<int>>& first,
                                 const std::map<std::string, std::vector<int>>& second) const {
    const std::string name = data.attribute(attribute).value();
    std::vector<std::string> known;
    for (const auto* sets : {&first, &second}) {
      if (const auto found = sets->find(name); found != sets->end()) return found->second;
      for (const auto& [other, members] : *sets) known.push_back(other);
    }
    fail(data, "missing-region",
         fmt::format("<{}> is about the set `{}`, which the mesh does not have", data.name(), name),
         data::suggest(name, known));
  }

  /// Place of an entry's member among all cells or points: by its number within the set (lid) or by its id
  /// (2.5).
  std::size_t member(const pugi::xml_node& entry, const std::vector<int>& set,
                     const std::unordered_map<long long, int>& by_id) const {
    if (!entry.attribute("lid")) {
      const auto found = by_id.find(id_of(entry));
      if (found == by_id.end())
        fail(entry, "mesh-index", fmt::format("<{}> {} does not exist", entry.name(), id_of(entry)));
      return static_cast<std::size_t>(found->second);
    }
    const long long lid = entry.attribute("lid").as_llong();
    if (lid < 1 || lid > static_cast<long long>(set.size()))
      fail(entry, "mesh-index", fmt::format("entry {} of a set of {} members", lid, set.size()));
    return static_cast<std::size_t>(set[static_cast<std::size_t>(lid - 1)]);
  }

  void put(std::map<std::string, Eigen::MatrixXd>& fields, const std::string& name,
           const pugi::xml_node& entry, std::size_t column, const std::vector<double>& values,
           std::size_t columns) {
    Eigen::MatrixXd& field = fields[name];
    const auto rows = static_cast<Eigen::Index>(values.size());
    if (field.size() == 0) {
      field = Eigen::MatrixXd::Zero(rows, static_cast<Eigen::Index>(columns));
      without_value_[name].assign(columns, true);
    }
    if (field.rows() != rows)
      fail(entry, "mesh-size",
           fmt::format("an entry of `{}` has {} numbers, others have {}", name, rows, field.rows()));
    field.col(static_cast<Eigen::Index>(column)) = Eigen::Map<const Eigen::VectorXd>(values.data(), rows);
    without_value_[name][column] = false;
  }

  /// What a table of MeshData holds: `var` until 3.0, `type` or the name of a table of the user's in 4.0.
  static std::string kind_of(const pugi::xml_node& data) {
    for (const char* key : {"var", "type", "name"}) {
      if (data.attribute(key)) return data.attribute(key).value();
    }
    return {};
  }

  void refuse_computed(const pugi::xml_node& data) const {
    const bool generator = data.attribute("generator") || (data.attribute("name") && data.attribute("type"));
    if (generator)
      fail(data, "mesh-unsupported",
           fmt::format("<{}> is left to FEBio to compute, not given by values", data.name()),
           "write the values into the file");
  }

  /// Fibres, axes, and tables of the user's by cell. `mat_axis` gives two fields: a, along which FEBio's
  /// fibres lie, and d.
  void read_element_data(const pugi::xml_node& data) {
    const std::string kind = kind_of(data);
    refuse_computed(data);
    static const std::vector<int> none;
    const bool named = data.attribute("elem_set");
    const std::vector<int>& set = named ? set_of(data, "elem_set", element_sets_, element_blocks_) : none;
    for (const pugi::xml_node entry : data.children()) {
      if (entry.type() != pugi::node_element) continue;
      const std::size_t cell = member(entry, set, cell_), cells = raw_.types.size();
      bool parts = false;
      const pugi::xml_node axes = entry.child("mat_axis") ? entry.child("mat_axis") : entry;
      for (const auto& [part, name] :
           {std::pair{entry.child("fiber"), "fiber"}, std::pair{axes.child("a"), "mat_axis_a"},
            std::pair{axes.child("d"), "mat_axis_d"}}) {
        if (!part) continue;
        parts = true;
        put(raw_.cell_fields, name, entry, cell, numbers<double>(part), cells);
      }
      if (!parts) put(raw_.cell_fields, kind, entry, cell, numbers<double>(entry), cells);
    }
  }

  void read_node_data(const pugi::xml_node& data) {
    refuse_computed(data);
    const std::vector<int>& set = set_of(data, "node_set", raw_.node_sets, {});
    for (const pugi::xml_node entry : data.children()) {
      if (entry.type() != pugi::node_element) continue;
      put(raw_.point_fields, kind_of(data), entry, member(entry, set, point_), numbers<double>(entry),
          raw_.points.size());
    }
  }

  void note_missing(const std::string& name, const std::vector<bool>& missing) {
    const auto count = std::count(missing.begin(), missing.end(), true);
    if (count == 0) return;
    raw_.note(fmt::format("field `{}` has no value at {} {}; 0 is used there", name, count,
                          raw_.cell_fields.contains(name) ? "cells" : "points"));
  }

  void check_domains(const pugi::xml_node& domains) const {
    for (const pugi::xml_node domain : domains.children()) {
      if (domain.type() != pugi::node_element) continue;
      const std::string name = domain.attribute("name").value();
      if (std::ranges::find(raw_.regions.names, name) == raw_.regions.names.end())
        fail(domain, "missing-region", fmt::format("domain `{}` names no element block", name),
             data::suggest(name, raw_.regions.names));
    }
  }

  MeshCursor in_;
  pugi::xml_document document_;
  RawMesh raw_;
  std::unordered_map<long long, int> point_, cell_;
  std::set<std::pair<std::string, std::string>> names_;
  std::map<std::string, std::vector<int>> element_sets_, element_blocks_;
  std::map<std::string, std::vector<bool>> without_value_;  ///< by field of MeshData
};

}  // namespace

MeshFile read_febio(const std::filesystem::path& file, const MeshReadOptions& options) {
  metres_per_unit(file, options);
  return assemble(FebioReader(file).read(), options);
}

}  // namespace brachium::io
