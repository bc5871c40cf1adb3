// Back-substitution: forward through the fronts with L, then D, then backward with L'.

#include <algorithm>

#include "fem/linear/multifrontal.hpp"

namespace brachium::fem {

namespace {

// y -= Σ_k l_k x_k over `columns` columns of `rows` values, `step` apart.
void subtract_columns(const double* l, std::ptrdiff_t step, int rows, int columns, const double* x,
                      double* y) {
  int k = 0;
  for (; k + 4 <= columns; k += 4, l += 4 * step) {
    const double x0 = x[k], x1 = x[k + 1], x2 = x[k + 2], x3 = x[k + 3];
    const double *l0 = l, *l1 = l + step, *l2 = l + 2 * step, *l3 = l + 3 * step;
    for (int i = 0; i < rows; ++i) y[i] -= (l0[i] * x0 + l1[i] * x1) + (l2[i] * x2 + l3[i] * x3);
  }
  for (; k < columns; ++k, l += step) {
    for (int i = 0; i < rows; ++i) y[i] -= l[i] * x[k];
  }
}

double dot(const double* a, const double* b, int count) {
  double sum[8] = {};
  int i = 0;
  for (; i + 8 <= count; i += 8) {
    for (int q = 0; q < 8; ++q) sum[q] += a[i + q] * b[i + q];
  }
  for (; i < count; ++i) sum[0] += a[i] * b[i];
  return ((sum[0] + sum[4]) + (sum[1] + sum[5])) + ((sum[2] + sum[6]) + (sum[3] + sum[7]));
}

}  // namespace

void Multifrontal::forward(int f, double* y, std::vector<double>& below) const {
  const Front& front = tree_.fronts[f];
  const double* panel = factor_.panels.get() + front.panel_start;
  const std::ptrdiff_t size = front.size();
  double* own = y + front.first;
  std::fill(below.begin(), below.begin() + front.updates, 0.0);
  for (int first = 0, b = 0; first < front.pivots; first += kBlock, ++b) {
    const int m = std::min(kBlock, front.pivots - first);
    if (factor_.block_pivoted[factor_.block_start[f] + b] != 0) {
      double moved[kBlock];
      std::copy(own + first, own + first + m, moved);
      for (int k = 0; k < m; ++k) own[first + k] = moved[factor_.interchange[front.first + first + k]];
    }
    for (int k = 0; k < m; ++k) {
      const double* column = panel + (first + k) * size + first;
      for (int i = k + 1; i < m; ++i) own[first + i] -= column[i] * own[first + k];
    }
    const double* columns = panel + first * size;
    const int done = first + m;
    subtract_columns(columns + done, size, front.pivots - done, m, own + first, own + done);
    subtract_columns(columns + front.pivots, size, front.updates, m, own + first, below.data());
  }
  const int* row = tree_.row.data() + front.row_start;
  for (int i = 0; i < front.updates; ++i) y[row[i]] += below[i];
}

void Multifrontal::backward(int f, double* y, std::vector<double>& below) const {
  const Front& front = tree_.fronts[f];
  const double* panel = factor_.panels.get() + front.panel_start;
  const std::ptrdiff_t size = front.size();
  double* own = y + front.first;
  const int* row = tree_.row.data() + front.row_start;
  for (int i = 0; i < front.updates; ++i) below[i] = y[row[i]];
  const int blocks = (front.pivots + kBlock - 1) / kBlock;
  for (int b = blocks - 1; b >= 0; --b) {
    const int first = b * kBlock, m = std::min(kBlock, front.pivots - first), done = first + m;
    for (int k = m - 1; k >= 0; --k) {
      const double* column = panel + (first + k) * size;
      double sum = dot(column + front.pivots, below.data(), front.updates) +
                   dot(column + done, own + done, front.pivots - done);
      for (int i = first + k + 1; i < done; ++i) sum += column[i] * own[i];
      own[first + k] -= sum;
    }
    if (factor_.block_pivoted[factor_.block_start[f] + b] != 0) {
      double moved[kBlock];
      std::copy(own + first, own + done, moved);
      for (int k = 0; k < m; ++k) own[first + factor_.interchange[front.first + first + k]] = moved[k];
    }
  }
}

void Multifrontal::solve(double* y) const {
  std::vector<double> below(static_cast<std::size_t>(largest_front_));
  const int count = static_cast<int>(tree_.fronts.size());
  for (int f = 0; f < count; ++f) forward(f, y, below);
  const int n = static_cast<int>(factor_.d.size());
  for (int k = 0; k < n; ++k) {
    if (factor_.e[k] != 0.0) {
      const double e = factor_.e[k], p0 = factor_.d[k] / e, p1 = factor_.d[k + 1] / e,
                   q = 1.0 / (e * (p0 * p1 - 1.0));
      const double y0 = y[k], y1 = y[k + 1];
      y[k] = (p1 * y0 - y1) * q;
      y[k + 1] = (p0 * y1 - y0) * q;
      ++k;
    } else {
      y[k] /= factor_.d[k];
    }
  }
  for (int f = count - 1; f >= 0; --f) backward(f, y, below);
}

}  // namespace brachium::fem
