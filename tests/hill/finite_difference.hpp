#pragma once
/// Derivatives by differences, to hold analytic ones against.

#include <algorithm>
#include <cmath>
#include <vector>

namespace brachium::tests {

/// f'(x) by the symmetric five-point difference, error of order h⁴.
template <class F>
double slope_of(const F& f, double x, double h) {
  return (8.0 * (f(x + h) - f(x - h)) - (f(x + 2.0 * h) - f(x - 2.0 * h))) / (12.0 * h);
}

/// The same for a vector-valued f.
template <class F>
std::vector<double> slopes_of(const F& f, double x, double h) {
  const std::vector<double> p1 = f(x + h), m1 = f(x - h), p2 = f(x + 2.0 * h), m2 = f(x - 2.0 * h);
  std::vector<double> d(p1.size());
  for (std::size_t k = 0; k < d.size(); ++k) d[k] = (8.0 * (p1[k] - m1[k]) - (p2[k] - m2[k])) / (12.0 * h);
  return d;
}

/// Largest |a - b| over the largest |b|.
inline double relative_error(const std::vector<double>& a, const std::vector<double>& b) {
  double worst = 0.0, scale = 0.0;
  for (std::size_t k = 0; k < b.size(); ++k) {
    worst = std::max(worst, std::abs(a[k] - b[k]));
    scale = std::max(scale, std::abs(b[k]));
  }
  return scale > 0.0 ? worst / scale : worst;
}

}  // namespace brachium::tests
