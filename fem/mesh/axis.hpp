#pragma once
/// Cells along a line: how many, and how their sizes grow.

#include <string>
#include <vector>

namespace brachium::fem {

struct Axis {
  double length_m = 0.0;
  int cells = 1;
  double grading = 1.0;    ///< size of the last cell / size of the first, in geometric progression
  bool symmetric = false;  ///< the progression runs from both ends to the middle: middle / end cell size
};

/// The cells + 1 positions, from 0 to length_m exactly. Throws InputError("bad-mesh-option") naming `what`.
std::vector<double> positions(const Axis& axis, const std::string& what);

/// InputError("bad-mesh-option") unless `value` is finite and within [low, high] (open at low if
/// `above_low`).
void check_option(const std::string& what, double value, double low, double high, bool above_low);

}  // namespace brachium::fem
