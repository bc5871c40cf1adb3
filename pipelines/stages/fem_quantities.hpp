#pragma once
/// Wanted quantities of fem.solve: one row per accepted state.

#include <string>
#include <variant>
#include <vector>

#include "data/model/table.hpp"
#include "fem/assembly/discretisation.hpp"
#include "fem/quantities/cell_state.hpp"
#include "fem/quantities/quantities.hpp"
#include "fem/solve/solve.hpp"
#include "pipelines/stages/fem_problem.hpp"

namespace brachium::pipelines {

/// Mistakes of the tables `output`: names given twice, missing or unused keys, surfaces and regions that are
/// not there.
void check_outputs(const Options& options, const data::Mesh& mesh, Mistakes& mistakes);

/// Points and planes that do not meet the body: what only the discretised body can tell.
void check_places(const Options& options, const fem::Discretisation& discretisation, Mistakes& mistakes);

/// Reads the wanted quantities off accepted states.
class FemQuantities {
 public:
  FemQuantities(const Options& options, const fem::Problem& problem,
                const fem::Discretisation& discretisation);

  /// A table with one row: state, step, phase, phase_time, activations, amplitudes, energy, volume, wanted
  /// quantities.
  data::Table row(int state, const fem::AcceptedState& accepted, const fem::PointFields& fields) const;

 private:
  class Row;
  void contact(const Options& entry, const fem::AcceptedState& accepted, Row& row) const;
  void point(const Options& entry, const fem::CellStates& states, Row& row) const;

  const Options& options_;
  const fem::Problem& problem_;
  const fem::Discretisation& discretisation_;
  fem::Contacts contacts_;
  Eigen::VectorXd weights_;          ///< reference volume of each quadrature point [m3]
  std::vector<std::string> moved_;   ///< conditions that a phase moves
  std::vector<std::size_t> active_;  ///< regions with an active law
};

/// Rows of `from` appended to `to`, which takes its columns where it has none. Columns must agree
/// (std::logic_error).
void append_rows(data::Table& to, const data::Table& from);

}  // namespace brachium::pipelines
