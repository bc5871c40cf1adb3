#include "pipelines/stages/fem_field_files.hpp"

#include <algorithm>
#include <cmath>

#include "data/io/mesh_writer.hpp"

namespace brachium::pipelines {
namespace {

std::string unit_of(const std::string& name) {
  return name.ends_with("_pa") ? "Pa" : name.ends_with("_m") ? "m" : "1";
}

std::string without_unit(const std::string& name) {
  return name.ends_with("_pa") ? name.substr(0, name.size() - 3) : name;
}

/// Entries [first, first + count) of a column.
Eigen::RowVectorXd part(const data::Table& rows, const std::string& column, std::size_t first,
                        std::size_t count) {
  const std::vector<double>& v = rows.numbers(column);
  return Eigen::Map<const Eigen::RowVectorXd>(v.data() + first, static_cast<Eigen::Index>(count));
}

}  // namespace

bool wants_fields(const std::string& which, const fem::StepRecord& record) {
  return which == "all" || which == "last" || (which == "phase_ends" && record.phase_time >= 1.0 - 1e-12);
}

data::Table field_rows(double time, const data::Mesh& mesh, const fem::Configuration& configuration,
                       const std::vector<std::pair<std::string, Eigen::VectorXd>>& at_points) {
  const auto n = static_cast<std::size_t>(mesh.point_count());
  data::Table table{"Fields by state", {{"time", "1", std::vector<double>(n, time)}}};
  const char* const axes[] = {"displacement_x_m", "displacement_y_m", "displacement_z_m"};
  for (int a = 0; a < 3; ++a) {
    std::vector<double> u(n);
    for (std::size_t p = 0; p < n; ++p) u[p] = configuration.dofs[3 * static_cast<Eigen::Index>(p) + a];
    table.columns.push_back({axes[a], "m", std::move(u)});
  }
  for (const auto& [name, values] : at_points)
    table.columns.push_back(
        {name, unit_of(name), std::vector<double>(values.data(), values.data() + values.size())});
  return table;
}

std::vector<std::string> write_fields(const std::filesystem::path& beside, const std::string& which,
                                      const data::Mesh& mesh, const data::Table& rows) {
  const auto n = static_cast<std::size_t>(mesh.point_count());
  const std::size_t states = rows.rows() / n;
  std::vector<bool> gaps(rows.columns.size());
  for (std::size_t c = 4; c < rows.columns.size(); ++c) {
    const std::vector<double>& v = rows.numbers(rows.columns[c].name);
    gaps[c] = std::any_of(v.begin(), v.end(), [](double x) { return !std::isfinite(x); });
  }
  const std::filesystem::path file = beside.string() + ".vtkhdf";
  io::MeshSeriesWriter writer(file, mesh);
  for (std::size_t s = which == "last" ? states - 1 : 0; s < states; ++s) {
    io::MeshStep step;
    step.time = rows.numbers("time")[s * n];
    Eigen::MatrixXd u(3, static_cast<Eigen::Index>(n));
    for (int a = 0; a < 3; ++a)
      u.row(a) = part(rows, rows.columns[static_cast<std::size_t>(a) + 1].name, s * n, n);
    step.point_fields.push_back({"displacement", "m", std::move(u)});
    for (std::size_t c = 4; c < rows.columns.size(); ++c) {
      Eigen::MatrixXd values = part(rows, rows.columns[c].name, s * n, n);
      const std::string name = without_unit(rows.columns[c].name);
      if (gaps[c]) {
        step.point_fields.push_back({name + "_known", "1", values.array().isFinite().cast<double>()});
        values = values.array().isFinite().select(values, 0.0);
      }
      step.point_fields.push_back({name, rows.columns[c].unit, std::move(values)});
    }
    writer.add(step);
  }
  writer.finish();
  return {file.filename().string(), file.stem().string() + ".xdmf"};
}

}  // namespace brachium::pipelines
