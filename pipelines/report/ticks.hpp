#pragma once
/// Where an axis carries numbers: round ones, few enough to read.

#include <string>
#include <vector>

namespace brachium::pipelines::report {

struct Tick {
  double value = 0.0;
  std::string label;  ///< empty: a line without a number
};

/// Smallest of 1, 2, 5 x 10^k that divides `span` into at most `intervals` parts; span > 0.
double nice_step(double span, int intervals);

/// Multiples of a nice step within [lower, upper], labelled with the same number of decimals (or as powers of
/// ten where the numbers are very large or small). lower < upper, intervals >= 1.
std::vector<Tick> linear_ticks(double lower, double upper, int intervals);

/// Powers of ten within [lower, upper], thinned to `intervals`; below two decades also 2 and 5 times them,
/// and linear ticks where even those are fewer than two. 0 < lower < upper.
std::vector<Tick> log_ticks(double lower, double upper, int intervals);

}  // namespace brachium::pipelines::report
