#include "fem/linear/symmetric_solver.hpp"

#include "data/model/error.hpp"
#include "fem/linear/solver_parts.hpp"

namespace brachium::fem {

const std::vector<std::string>& symmetric_solver_names() {
  static const std::vector<std::string> names{"ldl", "cholmod", "umfpack"};
  return names;
}

std::unique_ptr<SymmetricSolver> make_symmetric_solver(const std::string& name,
                                                       const SolverOptions& options) {
  if (name == "ldl") return make_ldl_solver(options);
  if (name == "cholmod") return make_cholmod_solver(options);
  if (name == "umfpack") return make_umfpack_solver(options);
  throw data::InputError("unknown-solver", "`" + name + "` is not a solver of sparse symmetric systems",
                         data::suggest(name, symmetric_solver_names()));
}

}  // namespace brachium::fem
