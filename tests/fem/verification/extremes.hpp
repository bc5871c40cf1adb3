#pragma once
/// Problems at the edge of what is sensible, each solved or refused with a reason: the table of
/// tests/bench/fem_extremes, a small part of which are tests.

#include <string>
#include <vector>

#include "fem/solve/solve.hpp"

namespace brachium::fem::verification {

struct Extreme {
  std::string name;
  Problem problem;
  SolveOptions options;
};

struct Outcome {
  bool solved = false;
  std::string reason;  ///< of a refusal or a failure
  int steps = 0, cut_backs = 0;
  long newton = 0, chord = 0, augmentations = 0, relaxation = 0;
  double smallest_jacobian = 1.0, force_n = 0.0, seconds = 0.0;
  std::string stability;
  long negative_modes = 0;
};

/// Smallest over largest Jacobian at a cell's corners, worst cell.
double jacobian_ratio(const data::Mesh& mesh);

/// 2 x 2 x 2 cells whose common corner is moved along the diagonal until `ratio` is reached.
std::shared_ptr<data::Mesh> distorted_box(data::CellType type, double ratio);

/// The rows by name; `formulation` is used where the row does not need another.
std::vector<Extreme> extremes(Formulation formulation);
Extreme extreme(const std::string& name, Formulation formulation);

/// Runs one; never throws for what the solver refuses.
Outcome outcome_of(const Extreme& extreme);

}  // namespace brachium::fem::verification
