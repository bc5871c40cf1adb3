#pragma once
/// Fields of fem.solve's states, for ParaView: NAME.vtkhdf and NAME.xdmf (data/io/mesh_writer.hpp).
///
/// The fields of a state are a table (one row a point of the mesh) until the end of the solve, so that they
/// are kept with the accepted states (fem_checkpoint.hpp) and a solve that goes on has those of earlier runs
/// too.

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "data/model/mesh.hpp"
#include "data/model/table.hpp"
#include "fem/solve/solve.hpp"

namespace brachium::pipelines {

/// Whether a state's fields are wanted: `which` is "all", "phase_ends", "last" or "none". Of "last" every
/// state is until the next one comes.
bool wants_fields(const std::string& which, const fem::StepRecord& record);

/// Columns: time (one value), displacement_x_m .. z_m, then the fields.
data::Table field_rows(double time, const data::Mesh& mesh, const fem::Configuration& configuration,
                       const std::vector<std::pair<std::string, Eigen::VectorXd>>& at_points);

/// Writes the states (rows of field_rows, one after the other; the last only, where `which` says so) to
/// <beside>.vtkhdf and <beside>.xdmf; their names. Where a field has no value (no fibres) it is written as 0,
/// and the field `<name>_known` tells.
std::vector<std::string> write_fields(const std::filesystem::path& beside, const std::string& which,
                                      const data::Mesh& mesh, const data::Table& rows);

}  // namespace brachium::pipelines
