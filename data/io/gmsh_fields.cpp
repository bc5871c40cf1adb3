#include "data/io/gmsh_fields.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace brachium::io {

void GmshFields::read(MeshCursor& in, bool binary, bool of_nodes, RawMesh& raw) {
  in.set_binary(false);
  const std::size_t texts = in.count("the number of texts", 2);
  in.line();
  std::string name;
  for (std::size_t i = 0; i < texts; ++i) {
    std::string_view text = in.line();
    if (i > 0) continue;
    const std::size_t open = text.find('"'), close = text.rfind('"');
    if (open != std::string_view::npos && close > open) text = text.substr(open + 1, close - open - 1);
    name = text;
  }
  if (name.empty()) in.fail("mesh-syntax", "a field has no name");
  const std::size_t reals = in.count("the number of real tags", 2);
  for (std::size_t i = 0; i < reals; ++i) in.number("a real tag");
  const std::size_t integers = in.count("the number of integer tags", 2);
  long long tags[3] = {0, 0, 0};  // step, components, count
  for (std::size_t i = 0; i < integers; ++i) {
    const long long value = in.integer("an integer tag");
    if (i < 3) tags[i] = value;
  }
  in.line();
  if (integers < 3 || tags[1] < 1 || tags[1] > 9)
    in.fail("mesh-syntax", "a field needs a step, 1 to 9 components and a count");
  in.set_binary(binary);
  const auto components = static_cast<std::size_t>(tags[1]);
  const std::size_t n =
      in.checked_count(tags[2], "the number of values", binary ? 4 + 8 * components : 2 + 2 * components);
  Rows& rows = fields_[{of_nodes, name}];
  if (!rows.empty()) {
    raw.note(fmt::format("field `{}` has several steps; the last is used", name));
    rows.clear();
  }
  for (std::size_t i = 0; i < n; ++i) {
    const long long tag = binary ? in.raw<std::int32_t>("a tag") : in.integer("a tag");
    std::vector<double> row(components);
    for (double& v : row) {
      v = binary ? in.raw<double>("a value") : in.number("a value");
      if (!std::isfinite(v))
        in.fail("mesh-not-finite", fmt::format("field `{}` holds a value that is not finite", name));
    }
    rows.emplace_back(tag, std::move(row));
  }
}

void GmshFields::finish(RawMesh& raw, const std::unordered_map<long long, int>& point_of_node,
                        const std::unordered_map<long long, int>& cell_of_element) const {
  for (const auto& [key, rows] : fields_) {
    const auto& [of_nodes, name] = key;
    if (rows.empty()) continue;
    const auto& number = of_nodes ? point_of_node : cell_of_element;
    const std::size_t width = of_nodes ? raw.points.size() : raw.types.size();
    const auto components = static_cast<Eigen::Index>(rows.front().second.size());
    Eigen::MatrixXd field = Eigen::MatrixXd::Zero(components, static_cast<Eigen::Index>(width));
    std::vector<char> given(width, 0);
    for (const auto& [tag, row] : rows) {
      const auto found = number.find(tag);
      if (found == number.end()) continue;  // of a surface or line element
      field.col(found->second) = Eigen::Map<const Eigen::VectorXd>(row.data(), components);
      given[static_cast<std::size_t>(found->second)] = 1;
    }
    const auto missing = std::ranges::count(given, 0);
    if (missing > 0) {
      raw.note(fmt::format("field `{}` has no value at {} {}; 0 is used there", name, missing,
                           of_nodes ? "points" : "cells"));
    }
    (of_nodes ? raw.point_fields : raw.cell_fields)[name] = std::move(field);
  }
}

}  // namespace brachium::io
