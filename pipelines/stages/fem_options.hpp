#pragma once
/// Options of fem.solve: everything a boundary-value problem is made of, and what is wanted of its solution.

#include <vector>

#include "fem/solve/solve.hpp"
#include "pipelines/stage.hpp"

namespace brachium::pipelines {

/// All options of the stage, nested tables with their fields.
std::vector<OptionSpec> fem_option_specs();
OptionSpec fem_mesh_option();  ///< the table `mesh`

/// The table `solver`, shared by stages that solve continuum problems.
OptionSpec solver_option();
/// What it says; threads from the run.
fem::SolveOptions solve_options(const Options& options, std::size_t threads);

}  // namespace brachium::pipelines
