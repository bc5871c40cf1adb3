#pragma once
/// The solvers behind make_symmetric_solver, each in its own file.

#include <memory>

#include "fem/linear/symmetric_solver.hpp"

namespace brachium::fem {

std::unique_ptr<SymmetricSolver> make_ldl_solver(const SolverOptions& options);
std::unique_ptr<SymmetricSolver> make_cholmod_solver(const SolverOptions& options);
std::unique_ptr<SymmetricSolver> make_umfpack_solver(const SolverOptions& options);

}  // namespace brachium::fem
