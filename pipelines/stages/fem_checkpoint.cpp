#include "pipelines/stages/fem_checkpoint.hpp"

#include <fmt/format.h>

#include <cstdlib>

#include "data/io/stage_file.hpp"

namespace brachium::pipelines {
namespace {

namespace fs = std::filesystem;

const std::string kRows = "rows_";  // begins the names of tables that are rows of the stage's own

data::Table column(const Eigen::Ref<const Eigen::VectorXd>& values) {
  return {"", {{"value", "1", std::vector<double>(values.data(), values.data() + values.size())}}};
}

Eigen::VectorXd values_of(const FemTables& tables, const std::string& name) {
  const std::vector<double>& v = tables.at(name).numbers("value");
  return Eigen::Map<const Eigen::VectorXd>(v.data(), static_cast<Eigen::Index>(v.size()));
}

std::string exact(double value) {
  return fmt::format("{}", value);
}  // the shortest text that reads back the same

double number(const std::map<std::string, std::string>& attributes, const std::string& key) {
  return std::strtod(attributes.at(key).c_str(), nullptr);
}

data::Table named(const std::map<std::string, double>& values) {
  std::vector<std::string> names;
  std::vector<double> numbers;
  for (const auto& [name, value] : values) {
    names.push_back(name);
    numbers.push_back(value);
  }
  return {"", {{"name", "", names}, {"value", "1", numbers}}};
}

std::map<std::string, double> named(const data::Table& table) {
  std::map<std::string, double> values;
  for (std::size_t k = 0; k < table.rows(); ++k) values[table.texts("name")[k]] = table.numbers("value")[k];
  return values;
}

void put(const fem::Configuration& c, const std::string& prefix, io::StageFileContent& content) {
  content.tables[prefix + "dofs"] = column(c.dofs);
  content.tables[prefix + "activation"] = column(c.activation);
  content.tables[prefix + "multiplier"] = column(c.multiplier.reshaped());
  content.tables[prefix + "contact_multiplier"] = column(c.contact_multiplier);
  content.tables[prefix + "dofs_before"] = column(c.dofs_before);
  content.attributes[prefix + "inverse_dt"] = exact(c.inverse_dt);
  content.attributes[prefix + "viscosity_pa_s"] = exact(c.viscosity_pa_s);
  content.attributes[prefix + "multiplier_rows"] =
      std::to_string(c.multiplier.size() > 0 ? c.multiplier.rows() : 0);
}

fem::Configuration configuration_of(const io::StageFileContent& content, const std::string& prefix) {
  fem::Configuration c;
  c.dofs = values_of(content.tables, prefix + "dofs");
  c.activation = values_of(content.tables, prefix + "activation");
  const Eigen::VectorXd multiplier = values_of(content.tables, prefix + "multiplier");
  const auto rows = static_cast<Eigen::Index>(number(content.attributes, prefix + "multiplier_rows"));
  if (rows > 0)
    c.multiplier = Eigen::Map<const Eigen::MatrixXd>(multiplier.data(), rows, multiplier.size() / rows);
  c.contact_multiplier = values_of(content.tables, prefix + "contact_multiplier");
  c.dofs_before = values_of(content.tables, prefix + "dofs_before");
  c.inverse_dt = number(content.attributes, prefix + "inverse_dt");
  c.viscosity_pa_s = number(content.attributes, prefix + "viscosity_pa_s");
  return c;
}

void put(const fem::SolveState& state, io::StageFileContent& content) {
  put(state.configuration, "", content);
  put(state.factorised_at, "factorised_", content);
  content.tables["amplitude"] = named(state.amplitude);
  content.tables["phase_amplitude"] = named(state.phase_amplitude);
  content.tables["phase_activation"] = column(state.phase_activation);
  content.tables["released_force"] = column(state.released_force);
  content.tables["released"] = {"", {{"name", "", state.released}}};
  content.tables["factorised_amplitude"] = column(state.factorised_amplitude);
  content.tables["state_before"] = column(state.dofs_before);
  content.attributes["phase"] = std::to_string(state.phase);
  content.attributes["phase_time"] = exact(state.phase_time);
  content.attributes["step_size"] = exact(state.step_size);
  content.attributes["step_before"] = exact(state.step_before);
  content.attributes["steps_taken"] = std::to_string(state.steps_taken);
  content.attributes["unstable"] = state.unstable ? "1" : "0";
}

fem::SolveState state_of(const io::StageFileContent& content) {
  fem::SolveState state;
  state.configuration = configuration_of(content, "");
  state.factorised_at = configuration_of(content, "factorised_");
  state.amplitude = named(content.tables.at("amplitude"));
  state.phase_amplitude = named(content.tables.at("phase_amplitude"));
  state.phase_activation = values_of(content.tables, "phase_activation");
  state.released_force = values_of(content.tables, "released_force");
  state.released = content.tables.at("released").texts("name");
  state.factorised_amplitude = values_of(content.tables, "factorised_amplitude");
  state.dofs_before = values_of(content.tables, "state_before");
  state.phase = static_cast<int>(number(content.attributes, "phase"));
  state.phase_time = number(content.attributes, "phase_time");
  state.step_size = number(content.attributes, "step_size");
  state.step_before = number(content.attributes, "step_before");
  state.steps_taken = static_cast<int>(number(content.attributes, "steps_taken"));
  state.unstable = number(content.attributes, "unstable") != 0.0;
  return state;
}

}  // namespace

FemCheckpoints::FemCheckpoints(fs::path folder, std::string problem)
    : folder_(std::move(folder)), problem_(std::move(problem)) {
  if (folder_.empty()) return;
  std::error_code ignored;
  for (std::size_t k = 1; fs::exists(folder_ / fmt::format("{:04}.h5", k), ignored); ++k) {
    try {
      const io::StageFileContent content = io::read_stage_content(folder_ / fmt::format("{:04}.h5", k));
      if (content.attributes.at("problem") != problem_) break;
      last_ = state_of(content);
      FemTables rows;
      for (const auto& [name, table] : content.tables) {
        if (name.starts_with(kRows)) rows[name.substr(kRows.size())] = table;
      }
      rows_.push_back(std::move(rows));
    } catch (const std::exception&) {
      break;  // damaged: what came before it stands
    }
  }
  count_ = rows_.size();
  if (count_ == 0) fs::remove_all(folder_, ignored);
}

void FemCheckpoints::keep(const fem::SolveState& state, const FemTables& rows) {
  if (folder_.empty()) return;
  std::error_code failed;
  fs::create_directories(folder_, failed);
  if (failed)
    throw data::InputError(
        "write-failed", fmt::format("cannot make the folder `{}`: {}", folder_.string(), failed.message()));
  io::StageFileContent content;
  put(state, content);
  for (const auto& [name, table] : rows) content.tables[kRows + name] = table;
  content.attributes["problem"] = problem_;
  io::StageFileWriter writer(folder_ / fmt::format("{:04}.h5", count_ + 1));
  writer.begin({});
  writer.finish(content);
  ++count_;
}

void FemCheckpoints::remove() {
  std::error_code ignored;
  if (!folder_.empty()) fs::remove_all(folder_, ignored);
}

}  // namespace brachium::pipelines
