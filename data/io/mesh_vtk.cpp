/// VTK's legacy format, unstructured grids (.vtk), versions 1 to 5, ASCII and binary (big-endian).

#include <fmt/format.h>

#include <algorithm>
#include <cctype>

#include "data/io/mesh_cursor.hpp"
#include "data/io/vtk_grid.hpp"

namespace brachium::io {
namespace {

std::string lower(std::string_view text) {
  std::string out(text);
  std::ranges::transform(out, out.begin(),
                         [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return out;
}

class VtkReader {
 public:
  explicit VtkReader(const std::filesystem::path& file) : in_(file) { in_.set_swap(true); }

  RawMesh read(const MeshReadOptions& options) {
    if (!in_.text().starts_with("# vtk DataFile Version"))
      in_.fail("mesh-syntax", "this is no VTK file: it does not begin with `# vtk DataFile Version`");
    in_.line();
    in_.line();  // the title
    const std::string format = lower(in_.token("ASCII or BINARY"));
    if (format != "ascii" && format != "binary")
      in_.fail("mesh-syntax", fmt::format("`{}` stands where ASCII or BINARY should", format.substr(0, 40)));
    binary_ = format == "binary";
    if (lower(in_.token("DATASET")) != "dataset") in_.fail("mesh-syntax", "DATASET should stand here");
    const std::string dataset(in_.token("the kind of dataset"));
    if (lower(dataset) != "unstructured_grid")
      in_.fail("mesh-unsupported",
               fmt::format("a dataset of kind {} is no volume mesh", dataset.substr(0, 40)),
               "write an UNSTRUCTURED_GRID");
    in_.line();
    while (!in_.at_end()) {
      const std::size_t start = in_.at();
      const std::string word = lower(in_.token("a keyword"));
      if (word == "points") {
        const std::size_t n = in_.count("the number of points", 3);
        read_numbers(std::string(in_.token("a type")), n, 3, grid_.points);
      } else if (word == "cells") {
        read_cells();
      } else if (word == "cell_types") {
        const std::size_t n = in_.count("the number of cells", 1);
        read_numbers("int", n, 1, grid_.types);
      } else if (word == "point_data" || word == "cell_data") {
        arrays_ = word == "point_data" ? &grid_.point_arrays : &grid_.cell_arrays;
        tuples_ = in_.count("the number of tuples", 1);
        in_.line();
      } else if (word == "metadata") {
        while (in_.left() > 0 && !in_.line().empty()) {
        }
      } else if (word == "field") {
        read_field();
      } else if (arrays_ &&
                 (word == "scalars" || word == "vectors" || word == "normals" || word == "tensors" ||
                  word == "lookup_table" || word == "color_scalars" || word == "texture_coordinates")) {
        read_attribute(word);
      } else {
        in_.fail_at(start, "mesh-syntax",
                    fmt::format("`{}` is no keyword that is known here", word.substr(0, 40)));
      }
    }
    return raw_mesh(grid_, in_, options);
  }

 private:
  static std::size_t type_size(const std::string& type) {
    if (type == "char" || type == "unsigned_char" || type == "vtktypeint8" || type == "vtktypeuint8")
      return 1;
    if (type == "short" || type == "unsigned_short" || type == "vtktypeint16" || type == "vtktypeuint16")
      return 2;
    if (type == "int" || type == "unsigned_int" || type == "float" || type == "vtktypeint32" ||
        type == "vtktypeuint32")
      return 4;
    if (type == "long" || type == "unsigned_long" || type == "double" || type == "vtktypeint64" ||
        type == "vtktypeuint64" || type == "vtkidtype")
      return type == "vtkidtype" ? 4 : 8;
    return 0;
  }

  double raw_number(const std::string& type) {
    if (type == "double") return in_.raw<double>("numbers");
    if (type == "float") return static_cast<double>(in_.raw<float>("numbers"));
    const bool is_unsigned = type.starts_with("unsigned") || type.starts_with("vtktypeuint");
    switch (type_size(type)) {
      case 1:
        return is_unsigned ? in_.raw<std::uint8_t>("numbers") : in_.raw<std::int8_t>("numbers");
      case 2:
        return is_unsigned ? in_.raw<std::uint16_t>("numbers") : in_.raw<std::int16_t>("numbers");
      case 4:
        return is_unsigned ? in_.raw<std::uint32_t>("numbers") : in_.raw<std::int32_t>("numbers");
      default:
        return is_unsigned ? static_cast<double>(in_.raw<std::uint64_t>("numbers"))
                           : static_cast<double>(in_.raw<std::int64_t>("numbers"));
    }
  }

  void read_numbers(const std::string& type_name, std::size_t tuples, std::size_t components,
                    std::vector<double>& out) {
    const std::string type = lower(type_name);
    if (type_size(type) == 0)
      in_.fail("mesh-unsupported", fmt::format("numbers of type `{}` are not read", type_name.substr(0, 40)));
    in_.line();
    const std::size_t bytes = components * (binary_ ? type_size(type) : 2);
    if (components == 0 || tuples > in_.left() / bytes + 1)
      in_.fail("mesh-truncated", fmt::format("the file ends too early for {} tuples", tuples),
               "write or fetch the file again");
    out.resize(tuples * components);
    in_.set_binary(binary_);
    for (double& v : out) v = binary_ ? raw_number(type) : in_.number("a number");
    in_.set_binary(false);
  }

  void read_cells() {
    const std::size_t n = in_.count("the number of cells", 1), size = in_.count("the size of the cells", 1);
    in_.line();
    const std::size_t start = in_.at();
    if (lower(in_.peek()) == "offsets") {  // version 5: n - 1 cells
      in_.token("OFFSETS");
      std::vector<double> offsets;
      read_numbers(std::string(in_.token("a type")), n, 1, offsets);
      if (lower(in_.token("CONNECTIVITY")) != "connectivity")
        in_.fail("mesh-syntax", "CONNECTIVITY should stand here");
      read_numbers(std::string(in_.token("a type")), size, 1, grid_.connectivity);
      if (!offsets.empty()) grid_.offsets.assign(offsets.begin() + 1, offsets.end());
      if (!offsets.empty() && offsets.front() != 0.0)
        in_.fail("mesh-syntax", "the offsets do not begin with 0");
      return;
    }
    in_.seek(start);
    in_.set_binary(binary_);
    const auto next = [&] {
      return binary_ ? static_cast<long long>(in_.raw<std::int32_t>("cells")) : in_.integer("cells");
    };
    std::size_t used = 0;
    for (std::size_t c = 0; c < n; ++c) {
      const std::size_t nodes = in_.checked_count(next(), "the number of nodes of a cell", binary_ ? 4 : 2);
      used += nodes + 1;
      if (used > size) in_.fail("mesh-size", "the cells are longer than their stated size");
      for (std::size_t i = 0; i < nodes; ++i) grid_.connectivity.push_back(static_cast<double>(next()));
      grid_.offsets.push_back(static_cast<double>(grid_.connectivity.size()));
    }
    in_.set_binary(false);
  }

  void read_field() {
    in_.token("the name of the field");
    const std::size_t n = in_.count("the number of arrays", 4);
    for (std::size_t i = 0; i < n; ++i) {
      while (lower(in_.peek()) == "metadata") {
        in_.line();
        while (in_.left() > 0 && !in_.line().empty()) {
        }
      }
      VtkArray array;
      array.name = in_.token("the name of an array");
      array.components = in_.count("the number of components", 1);
      const std::size_t tuples = in_.count("the number of tuples", 1);
      const std::string type(in_.token("a type"));
      if (lower(type) == "string") {
        if (binary_)
          in_.fail("mesh-unsupported",
                   fmt::format("array `{}` of texts is not read from binary files", array.name),
                   "write it as ASCII, or use integers");
        in_.line();
        for (std::size_t t = 0; t < tuples * array.components; ++t) {
          if (in_.left() == 0)
            in_.fail("mesh-truncated", "the file ends within texts", "write or fetch the file again");
          array.texts.push_back(decoded(in_.line()));
        }
      } else {
        read_numbers(type, tuples, array.components, array.numbers);
      }
      // Arrays before POINT_DATA or CELL_DATA belong to the whole dataset.
      if (arrays_) arrays_->push_back(std::move(array));
    }
  }

  /// Texts are written with %XX for special characters.
  static std::string decoded(std::string_view text) {
    std::string out;
    for (std::size_t i = 0; i < text.size(); ++i) {
      const auto hex = [&](std::size_t k) { return std::isxdigit(static_cast<unsigned char>(text[k])) != 0; };
      if (text[i] == '%' && i + 2 < text.size() && hex(i + 1) && hex(i + 2)) {
        out.push_back(static_cast<char>(std::stoi(std::string(text.substr(i + 1, 2)), nullptr, 16)));
        i += 2;
      } else {
        out.push_back(text[i]);
      }
    }
    return out;
  }

  void read_attribute(const std::string& word) {
    VtkArray array;
    array.name = in_.token("the name of an array");
    if (word == "lookup_table") {  // a table of colours: 4 bytes or numbers each
      const std::size_t n = in_.count("the size of a colour table", 1);
      std::vector<double> ignored;
      read_numbers(binary_ ? "unsigned_char" : "float", n, 4, ignored);
      return;
    }
    if (word == "color_scalars") {
      array.components = in_.count("the number of components", 1);
      std::vector<double> ignored;
      read_numbers(binary_ ? "unsigned_char" : "float", tuples_, array.components, ignored);
      return;
    }
    if (word == "texture_coordinates") array.components = in_.count("the number of components", 1);
    const std::string type(in_.token("a type"));
    if (word == "vectors" || word == "normals") array.components = 3;
    if (word == "tensors") array.components = 9;
    if (word == "scalars") {
      const std::string rest(in_.line());
      array.components = rest.find_first_of("123456789") == std::string::npos
                             ? 1
                             : static_cast<std::size_t>(rest[rest.find_first_of("123456789")] - '0');
      if (lower(in_.peek()) == "lookup_table") {
        in_.token("LOOKUP_TABLE");
        in_.token("the name of a colour table");
      }
    }
    read_numbers(type, tuples_, array.components, array.numbers);
    arrays_->push_back(std::move(array));
  }

  MeshCursor in_;
  VtkGrid grid_;
  bool binary_ = false;
  std::vector<VtkArray>* arrays_ = nullptr;
  std::size_t tuples_ = 0;
};

}  // namespace

MeshFile read_vtk(const std::filesystem::path& file, const MeshReadOptions& options) {
  metres_per_unit(file, options);
  return assemble(VtkReader(file).read(options), options);
}

}  // namespace brachium::io
