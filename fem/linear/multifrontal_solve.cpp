// Back-substitution: forward through the fronts with L, then D, then backward with L'. L is read once each
// way, in the order in which it is stored.

#include <algorithm>

#include "fem/linear/multifrontal.hpp"

namespace brachium::fem {

namespace {

// y(12 rows of a panel) -= L x over columns [0, columns).
void subtract_panel(const DenseFront& f, int panel, int columns, const double* x, double* y) {
  const double *l0 = f.l_group(3 * panel), *l1 = f.l_group(3 * panel + 1), *l2 = f.l_group(3 * panel + 2);
  double sum[kRows] = {};
  for (int k = 0; k < columns; ++k) {
    for (int i = 0; i < 4; ++i) sum[i] += l0[4 * k + i] * x[k];
    for (int i = 0; i < 4; ++i) sum[4 + i] += l1[4 * k + i] * x[k];
    for (int i = 0; i < 4; ++i) sum[8 + i] += l2[4 * k + i] * x[k];
  }
  for (int i = 0; i < kRows; ++i) y[i] -= sum[i];
}

// sums(4 partial sums of each column) += L' y over columns [0, columns) of a panel.
void add_panel(const DenseFront& f, int panel, int columns, const double* y, double* sums) {
  const double *l0 = f.l_group(3 * panel), *l1 = f.l_group(3 * panel + 1), *l2 = f.l_group(3 * panel + 2);
  for (int k = 0; k < columns; ++k) {
    for (int i = 0; i < 4; ++i) {
      sums[4 * k + i] += l0[4 * k + i] * y[i] + (l1[4 * k + i] * y[4 + i] + l2[4 * k + i] * y[8 + i]);
    }
  }
}

double l_entry(const DenseFront& f, int row, int column) {
  return f.l_group(row / 4)[4 * column + row % 4];
}

}  // namespace

// `padded`: the front's pivots and update rows, each filled up to whole panels.
void Multifrontal::forward(int f, double* y, double* padded) const {
  const Front& shape = tree_.fronts[f];
  const DenseFront front = view(f);
  const int w = shape.pivots, padded_pivots = front.pivot_panels() * kRows;
  double *own = padded, *below = padded + padded_pivots;
  std::copy(y + shape.first, y + shape.first + w, own);
  std::fill(own + w, own + padded_pivots, 0.0);
  for (int first = 0, b = 0; first < w; first += kBlock, ++b) {
    const int m = std::min(kBlock, w - first);
    for (int row = first; row < first + m; row += kRows)
      subtract_panel(front, row / kRows, first, own, own + row);
    if (factor_.block_pivoted[factor_.block_start[f] + b] != 0) {
      double moved[kBlock];
      std::copy(own + first, own + first + m, moved);
      for (int k = 0; k < m; ++k) own[first + k] = moved[factor_.interchange[shape.first + first + k]];
    }
    for (int k = first; k < first + m; ++k) {
      for (int i = k + 1; i < first + m; ++i) own[i] -= l_entry(front, i, k) * own[k];
    }
  }
  std::copy(own, own + w, y + shape.first);
  std::fill(below, below + (front.panels() - front.pivot_panels()) * kRows, 0.0);
  for (int p = front.pivot_panels(); p < front.panels(); ++p) {
    subtract_panel(front, p, w, own, below + (p - front.pivot_panels()) * kRows);
  }
  const int* row = tree_.row.data() + shape.row_start;
  for (int i = 0; i < shape.updates; ++i) y[row[i]] += below[i];
}

void Multifrontal::backward(int f, double* y, double* padded, double* sums) const {
  const Front& shape = tree_.fronts[f];
  const DenseFront front = view(f);
  const int w = shape.pivots, padded_pivots = front.pivot_panels() * kRows;
  double *own = padded, *below = padded + padded_pivots;
  std::copy(y + shape.first, y + shape.first + w, own);
  std::fill(own + w, own + padded_pivots, 0.0);
  const int* row = tree_.row.data() + shape.row_start;
  for (int i = 0; i < shape.updates; ++i) below[i] = y[row[i]];
  std::fill(below + shape.updates, below + (front.panels() - front.pivot_panels()) * kRows, 0.0);
  std::fill(sums, sums + 4 * w, 0.0);
  for (int p = front.pivot_panels(); p < front.panels(); ++p) {
    add_panel(front, p, w, below + (p - front.pivot_panels()) * kRows, sums);
  }
  for (int b = front.blocks() - 1; b >= 0; --b) {
    const int first = b * kBlock, m = std::min(kBlock, w - first);
    for (int k = first + m - 1; k >= first; --k) {
      double sum = (sums[4 * k] + sums[4 * k + 1]) + (sums[4 * k + 2] + sums[4 * k + 3]);
      for (int i = k + 1; i < first + m; ++i) sum += l_entry(front, i, k) * own[i];
      own[k] -= sum;
    }
    if (factor_.block_pivoted[factor_.block_start[f] + b] != 0) {
      double moved[kBlock];
      std::copy(own + first, own + first + m, moved);
      for (int k = 0; k < m; ++k) own[first + factor_.interchange[shape.first + first + k]] = moved[k];
    }
    for (int r = first; r < first + m; r += kRows) add_panel(front, r / kRows, first, own + r, sums);
  }
  std::copy(own, own + w, y + shape.first);
}

void Multifrontal::solve(double* y) const {
  std::vector<double> padded(static_cast<std::size_t>(largest_front_) + 2 * kRows);
  std::vector<double> sums(4 * static_cast<std::size_t>(largest_front_));
  const int count = static_cast<int>(tree_.fronts.size());
  for (int f = 0; f < count; ++f) forward(f, y, padded.data());
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
  for (int f = count - 1; f >= 0; --f) backward(f, y, padded.data(), sums.data());
}

}  // namespace brachium::fem
