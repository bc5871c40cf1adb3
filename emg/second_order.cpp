#include "emg/second_order.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace brachium::emg {
namespace {

constexpr std::size_t size = 6;  // change of e over the interval, e, x1, x2, w1, w2
using Matrix = std::array<std::array<double, size>, size>;

Matrix product(const Matrix& a, const Matrix& b) {  // of lower triangular matrices
  Matrix c{};
  for (std::size_t i = 0; i < size; ++i) {
    for (std::size_t k = 0; k <= i; ++k) {
      for (std::size_t j = 0; j <= k; ++j) c[i][j] += a[i][k] * b[k][j];
    }
  }
  return c;
}

}  // namespace

std::array<double, 4> SecondOrderStep::operator()(const std::array<double, 4>& x, double e_start,
                                                  double e_change) const {
  std::array<double, 4> y{};
  for (std::size_t i = 0; i < 4; ++i) {
    double sum = from_start[i] * e_start + from_change[i] * e_change;
    for (std::size_t j = 0; j <= i; ++j) sum += transition[i][j] * x[j];
    y[i] = sum;
  }
  return y;
}

SecondOrderStep second_order_step(double time_constant_1_s, double time_constant_2_s, double interval_s) {
  const double p1 = interval_s / time_constant_1_s;
  const double p2 = interval_s / time_constant_2_s;
  const double shift = std::max(p1, p2);
  int squarings = 0;
  while (std::ldexp(shift, -squarings) > 0.5) ++squarings;
  const double scale = std::ldexp(1.0, -squarings);

  // (M + shift I) scale, M the matrix of y' = M y in units of the interval
  Matrix n{};
  const std::array<double, size> diagonal{0.0, 0.0, -p1, -p2, -p1, -p2};
  for (std::size_t i = 0; i < size; ++i) n[i][i] = (diagonal[i] + shift) * scale;
  n[1][0] = scale;       // e  grows by its change
  n[2][1] = p1 * scale;  // x1 follows e
  n[3][2] = p2 * scale;  // x2 follows x1
  n[4][3] = p1 * scale;  // w1 follows x2
  n[5][3] = p2 * scale;  // w2 follows x2

  Matrix exponential{}, term{};
  for (std::size_t i = 0; i < size; ++i) exponential[i][i] = term[i][i] = 1.0;
  for (int k = 1; k <= 24; ++k) {  // entries of n are at most 1: the first term left out is below 1/25!
    term = product(term, n);
    for (auto& row : term) {
      for (double& entry : row) entry /= k;
    }
    for (std::size_t i = 0; i < size; ++i) {
      for (std::size_t j = 0; j <= i; ++j) exponential[i][j] += term[i][j];
    }
  }
  const double back = std::exp(-shift * scale);
  for (auto& row : exponential) {
    for (double& entry : row) entry *= back;
  }
  for (int k = 0; k < squarings; ++k) exponential = product(exponential, exponential);

  // A constant is answered by that constant: from_start and transition of a row sum to 1. Each squaring doubles the
  // relative error of the factor e^(-shift scale), which all entries share; dividing by the sum removes it.
  SecondOrderStep step;
  for (std::size_t i = 0; i < 4; ++i) {
    const auto& row = exponential[i + 2];
    const double sum = row[1] + row[2] + row[3] + row[4] + row[5];
    step.from_change[i] = row[0] / sum;
    step.from_start[i] = row[1] / sum;
    for (std::size_t j = 0; j < 4; ++j) step.transition[i][j] = row[j + 2] / sum;
  }
  return step;
}

}  // namespace brachium::emg
