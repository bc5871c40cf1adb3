/// Gmsh .msh 2.2 and 4.1, ASCII and binary (Gmsh 4.11 reference manual, 10.1 and 10.2.1; node orders 10.2
/// "Node ordering").

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <optional>
#include <set>

#include "data/io/gmsh_elements.hpp"
#include "data/io/gmsh_fields.hpp"
#include "data/io/mesh_cursor.hpp"
#include "data/io/mesh_raw.hpp"

namespace brachium::io {
namespace {

using data::CellType;

class GmshReader {
 public:
  explicit GmshReader(const std::filesystem::path& file) : in_(file) { raw_.file = file; }

  RawMesh read() {
    read_format();
    bool nodes = false, elements = false;
    while (!in_.at_end()) {
      const std::size_t start = in_.at();
      const std::string section(in_.token("a section"));
      if (section.size() < 2 || section[0] != '$' || section.starts_with("$End"))
        in_.fail_at(start, "mesh-syntax",
                    fmt::format("`{}` stands where a section should begin", section.substr(0, 40)));
      in_.line();
      in_.set_binary(binary_);
      if (section == "$PhysicalNames") {
        in_.set_binary(false);
        read_names();
      } else if (section == "$Entities") {
        read_entities();
      } else if (section == "$PartitionedEntities") {
        in_.fail("mesh-unsupported", "the mesh is partitioned", "save it in Gmsh without partitions");
      } else if (section == "$Nodes") {
        nodes = true;
        v4_ ? read_nodes_4() : read_nodes_2();
      } else if (section == "$Elements") {
        if (!nodes) in_.fail("mesh-syntax", "$Elements stand before $Nodes");
        elements = true;
        v4_ ? read_elements_4() : read_elements_2();
      } else if (section == "$NodeData" || section == "$ElementData") {
        fields_.read(in_, binary_, section == "$NodeData", raw_);
      } else {
        skip(section);
        continue;
      }
      end_section(section);
    }
    if (!nodes || !elements)
      in_.fail("mesh-truncated", fmt::format("the file has no {}", nodes ? "$Elements" : "$Nodes"),
               "write or fetch the file again");
    finish();
    return std::move(raw_);
  }

 private:
  // ---- pieces of text or bytes

  long long integer(const char* what) { return binary_ ? in_.raw<std::int32_t>(what) : in_.integer(what); }
  long long size(const char* what) {
    if (!binary_) return in_.integer(what);
    const auto value = in_.raw<std::uint64_t>(what);
    if (value > static_cast<std::uint64_t>(std::numeric_limits<long long>::max()))
      in_.fail("mesh-syntax", fmt::format("{} cannot be {}", what, value));
    return static_cast<long long>(value);
  }
  double number(const char* what) {
    if (!binary_) return in_.number(what);
    const double value = in_.raw<double>(what);
    if (!std::isfinite(value)) in_.fail("mesh-syntax", fmt::format("{} is not finite", what));
    return value;
  }
  std::size_t checked(long long n, const char* what, std::size_t text_bytes, std::size_t binary_bytes) {
    return in_.checked_count(n, what, binary_ ? binary_bytes : text_bytes);
  }

  void read_format() {
    if (in_.peek() != "$MeshFormat")
      in_.fail("mesh-syntax", "this is no Gmsh mesh: it does not begin with $MeshFormat",
               "a .geo file must be meshed first");
    in_.token("$MeshFormat");
    const std::string version(in_.token("the version"));
    v4_ = version == "4.1";
    if (!v4_ && version != "2.2" && version != "2" && version != "2.1") {
      in_.fail("mesh-unsupported", fmt::format("version {} of the format is not read", version.substr(0, 20)),
               "save as 2.2 or 4.1: gmsh FILE -save -format msh41 -o NEW.msh");
    }
    binary_ = in_.integer("the file type") == 1;
    const long long data_size = in_.integer("the data size");
    if (data_size != 8)
      in_.fail("mesh-unsupported", fmt::format("numbers of {} bytes are not read", data_size),
               "save with 8 bytes");
    in_.line();
    if (binary_) {
      const auto one = in_.raw<std::int32_t>("the byte order");
      if (one == 0x01000000) {
        in_.set_swap(true);
      } else if (one != 1) {
        in_.fail("mesh-syntax", "the byte order cannot be told");
      }
    }
    end_section("$MeshFormat");
  }

  void end_section(const std::string& section) {
    in_.set_binary(false);
    const std::string expected = "$End" + section.substr(1);
    const std::size_t start = in_.at();
    const std::string_view found = in_.token(expected.c_str());
    if (found != expected) {
      in_.set_binary(binary_);
      in_.fail_at(start, "mesh-syntax", fmt::format("{} should stand here", expected),
                  "the counts of the section do not fit");
    }
  }

  void skip(const std::string& section) {
    const std::string end = "$End" + section.substr(1);
    const std::size_t found = in_.text().find("\n" + end, in_.at() == 0 ? 0 : in_.at() - 1);
    if (found == std::string::npos)
      in_.fail("mesh-truncated", fmt::format("{} does not end", section), "write or fetch the file again");
    in_.seek(found + 1 + end.size());
    in_.set_binary(false);
    static const std::set<std::string> harmless{"$Comments", "$Periodic", "$Parametrizations",
                                                "$GhostElements"};
    if (!harmless.contains(section)) raw_.note(fmt::format("section {} was left out", section));
  }

  void read_names() {
    const std::size_t n = in_.count("the number of names", 5);
    for (std::size_t i = 0; i < n; ++i) {
      const long long dimension = in_.integer("a dimension"), tag = in_.integer("a tag");
      const std::size_t start = in_.at();
      const std::string_view rest = in_.line();
      const std::size_t open = rest.find('"'), close = rest.rfind('"');
      if (open == std::string_view::npos || close <= open + 1)
        in_.fail_at(start, "mesh-syntax", "a name in quotes should stand here");
      const std::string name(rest.substr(open + 1, close - open - 1));
      for (const auto& [key, other] : names_) {
        if (key.first == dimension && other == name)
          in_.fail_at(start, "mesh-duplicate-name", fmt::format("two physical groups are called `{}`", name),
                      "rename one");
      }
      names_[{static_cast<int>(dimension), tag}] = name;
    }
  }

  void read_entities() {
    std::size_t counts[4];
    long long totals[4];
    for (long long& n : totals) n = size("a number of entities");
    for (int d = 0; d < 4; ++d) counts[d] = checked(totals[d], "a number of entities", 4, d == 0 ? 36 : 68);
    for (int d = 0; d < 4; ++d) {
      for (std::size_t i = 0; i < counts[d]; ++i) {
        const long long tag = integer("the tag of an entity");
        for (int k = 0; k < (d == 0 ? 3 : 6); ++k) number("a bound of an entity");
        const std::size_t groups =
            checked(size("a number of physical groups"), "a number of physical groups", 2, 4);
        for (std::size_t k = 0; k < groups; ++k)
          groups_of_[{d, tag}].push_back(std::abs(integer("a physical group")));
        if (d == 0) continue;
        const std::size_t bounds =
            checked(size("a number of bounding entities"), "a number of bounding entities", 2, 4);
        for (std::size_t k = 0; k < bounds; ++k) integer("a bounding entity");
      }
    }
  }

  void add_node(long long tag, double x, double y, double z) {
    const auto [found, is_new] = node_.try_emplace(tag, static_cast<int>(raw_.points.size()));
    if (!is_new) in_.fail("mesh-syntax", fmt::format("node {} stands twice", tag));
    raw_.points.emplace_back(x, y, z);
  }

  void read_nodes_2() {
    const std::size_t n = in_.count("the number of nodes", binary_ ? 28 : 8);
    in_.line();
    for (std::size_t i = 0; i < n; ++i) {
      const long long tag = integer("the tag of a node");
      const double x = number("a coordinate"), y = number("a coordinate"), z = number("a coordinate");
      add_node(tag, x, y, z);
    }
  }

  void read_nodes_4() {
    const std::size_t blocks = checked(size("the number of blocks"), "the number of blocks", 8, 20);
    for (int k = 0; k < 3; ++k) size("a count of nodes");
    std::vector<long long> tags;
    for (std::size_t b = 0; b < blocks; ++b) {
      const long long dimension = integer("the dimension of a block");
      integer("the entity of a block");
      const long long parametric = integer("whether nodes are parametric");
      const std::size_t n =
          checked(size("the number of nodes of a block"), "the number of nodes of a block", 8, 32);
      tags.resize(n);
      for (long long& tag : tags) tag = size("the tag of a node");
      for (const long long tag : tags) {
        const double x = number("a coordinate"), y = number("a coordinate"), z = number("a coordinate");
        for (long long k = 0; parametric != 0 && k < std::clamp(dimension, 0LL, 3LL); ++k)
          number("a parameter");
        add_node(tag, x, y, z);
      }
    }
  }

  GmshElement known_kind(long long type) {
    const auto kind = gmsh_element(type);
    if (!kind) {
      in_.fail("mesh-cell-type", fmt::format("element type {} of Gmsh is not known", type),
               "use first or second order tetrahedra or hexahedra");
    }
    if (kind->dimension == 3 && !kind->cell) {
      in_.fail("mesh-cell-type",
               fmt::format("volume elements of type {} ({}) cannot be used", type, kind->name),
               "mesh with tetrahedra, or recombine into hexahedra only");
    }
    return *kind;
  }

  /// An element with its physical groups: of the entity (4.1), or the one it states (2.2; 0: none).
  void add_element(long long tag, const GmshElement& kind, const std::vector<long long>& groups,
                   long long entity) {
    file_nodes_.resize(static_cast<std::size_t>(kind.nodes));
    for (std::size_t i = 0; i < file_nodes_.size(); ++i) {
      const auto found = node_.find(node_tags_[i]);
      if (found == node_.end())
        in_.fail("mesh-index",
                 fmt::format("element {} uses node {}, which does not exist", tag, node_tags_[i]));
      file_nodes_[i] = found->second;
    }
    if (kind.dimension == 2) {
      for (const long long group : groups) {
        RawMesh::Facet facet;
        const bool triangle = kind.nodes == 3 || kind.nodes == 6;
        std::copy_n(file_nodes_.begin(), triangle ? 3 : 4, facet.corners.begin());
        facet.surface = raw_.surfaces.index(name_of(2, group));
        raw_.facets.push_back(facet);
      }
    } else if (kind.dimension == 3) {
      if (groups.size() > 1) {
        in_.fail("mesh-double-region",
                 fmt::format("element {} belongs to two physical volumes: `{}` and `{}`", tag,
                             name_of(3, groups[0]), name_of(3, groups[1])),
                 "a cell must belong to one region: remove one of the groups");
      }
      std::string region;
      if (groups.empty()) {
        region = fmt::format("volume_{}", entity);
        unnamed_.insert(region);
      } else {
        region = name_of(3, groups.front());
      }
      cell_of_element_[tag] = static_cast<int>(raw_.types.size());
      raw_.add_cell(*kind.cell, raw_.regions.index(region), file_nodes_,
                    data::corners_per_cell(*kind.cell) == 8 ? gmsh_hexahedron_order : gmsh_tetrahedron_order);
    }
  }

  std::string name_of(int dimension, long long group) const {
    const auto found = names_.find({dimension, group});
    return found != names_.end() ? found->second
                                 : fmt::format("{}_{}", dimension == 3 ? "region" : "surface", group);
  }

  void read_elements_2() {
    const std::size_t n = in_.count("the number of elements", binary_ ? 4 : 6);
    in_.line();
    for (std::size_t done = 0; done < n;) {
      long long tag = 0, type = 0, follow = 1, tags = 0;
      if (binary_) {
        type = integer("an element type");
        follow = integer("a number of elements");
        tags = integer("a number of tags");
        checked(follow, "a number of elements", 1, 8);
      } else {
        tag = in_.integer("the tag of an element");
        type = in_.integer("an element type");
        tags = in_.integer("a number of tags");
      }
      const GmshElement kind = known_kind(type);
      checked(tags, "a number of tags", 2, 4);
      if (follow < 1) in_.fail("mesh-syntax", fmt::format("a block of {} elements", follow));
      for (long long k = 0; k < follow; ++k, ++done) {
        if (binary_) tag = integer("the tag of an element");
        long long group = 0, entity = 0;
        for (long long t = 0; t < tags; ++t) {
          const long long value = integer("a tag");
          if (t == 0) group = std::abs(value);
          if (t == 1) entity = value;
        }
        node_tags_.resize(static_cast<std::size_t>(kind.nodes));
        for (long long& node : node_tags_) node = integer("a node of an element");
        add_element(tag, kind, group == 0 ? std::vector<long long>{} : std::vector<long long>{group}, entity);
      }
    }
  }

  void read_elements_4() {
    const std::size_t blocks = checked(size("the number of blocks"), "the number of blocks", 8, 20);
    for (int k = 0; k < 3; ++k) size("a count of elements");
    for (std::size_t b = 0; b < blocks; ++b) {
      const long long dimension = integer("the dimension of a block"),
                      entity = integer("the entity of a block");
      const GmshElement kind = known_kind(integer("an element type"));
      if (kind.dimension != dimension)
        in_.fail("mesh-syntax", fmt::format("elements {} in a block of dimension {}", kind.name, dimension));
      const std::size_t n =
          checked(size("the number of elements of a block"), "the number of elements of a block", 4, 16);
      const auto found = groups_of_.find({static_cast<int>(dimension), entity});
      const std::vector<long long> groups =
          found == groups_of_.end() ? std::vector<long long>{} : found->second;
      for (std::size_t i = 0; i < n; ++i) {
        const long long tag = size("the tag of an element");
        node_tags_.resize(static_cast<std::size_t>(kind.nodes));
        for (long long& node : node_tags_) node = size("a node of an element");
        add_element(tag, kind, groups, entity);
      }
    }
  }

  void finish() {
    if (!unnamed_.empty()) {
      raw_.note(fmt::format(
          "cells without a physical volume were put into {} named after their geometry, such as `{}`",
          unnamed_.size() == 1 ? "a region" : "regions", *unnamed_.begin()));
    }
    for (const auto& [key, name] : names_) {
      const auto& used = key.first == 3 ? raw_.regions.names : raw_.surfaces.names;
      if (key.first >= 2 && std::ranges::find(used, name) == used.end())
        raw_.note(fmt::format("physical group `{}` is empty", name));
    }
    fields_.finish(raw_, node_, cell_of_element_);
  }

  MeshCursor in_;
  RawMesh raw_;
  bool v4_ = false, binary_ = false;
  std::map<std::pair<int, long long>, std::string> names_;                 // (dimension, group)
  std::map<std::pair<int, long long>, std::vector<long long>> groups_of_;  // (dimension, entity)
  std::unordered_map<long long, int> node_, cell_of_element_;
  GmshFields fields_;
  std::set<std::string> unnamed_;
  std::vector<long long> node_tags_;
  std::vector<int> file_nodes_;
};

}  // namespace

MeshFile read_gmsh(const std::filesystem::path& file, const MeshReadOptions& options) {
  metres_per_unit(file, options);
  return assemble(GmshReader(file).read(), options);
}

}  // namespace brachium::io
