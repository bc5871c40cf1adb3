// Back-substitution: forward through the fronts with L, then D, then backward with L'. L is read once each
// way.
//
// Forward, what a front takes off the rows below it is carried to its parent, which adds what its children
// carry in their order; backward, a front reads rows of its ancestors and writes its own. So fronts of
// different subtrees do not meet, and the sums do not depend on who computes them: threads work on subtrees,
// and help each other in large fronts, whose panels go in parts that depend on the front alone.

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

constexpr int kPart = 16;                    // panels
constexpr long long kSharedValues = 150000;  // of L below the pivots, from which on threads share a front

bool shared(const DenseFront& f, int pivots) {
  return static_cast<long long>(f.panels() - f.pivot_panels()) * kRows * pivots > kSharedValues;
}

double l_entry(const DenseFront& f, int row, int column) {
  return f.l_group(row / 4)[4 * column + row % 4];
}

}  // namespace

// Scratch of one task: a front's pivots and update rows, each filled up to whole panels; partial sums.
struct Multifrontal::Scratch {
  explicit Scratch(int largest_front)
      : padded(static_cast<std::size_t>(largest_front) + 2 * kRows),
        sums(4 * static_cast<std::size_t>(largest_front)) {}
  std::vector<double> padded, sums, part_sums;
};

void Multifrontal::forward(int f, double* y, double* carried, Scratch& scratch, TaskPool& pool) const {
  const Front& shape = tree_.fronts[f];
  const DenseFront front = view(f);
  const int w = shape.pivots, padded_pivots = front.pivot_panels() * kRows,
            panels_below = front.panels() - front.pivot_panels();
  double *own = scratch.padded.data(), *below = own + padded_pivots;
  std::copy(y + shape.first, y + shape.first + w, own);
  std::fill(own + w, own + padded_pivots, 0.0);
  std::fill(below, below + panels_below * kRows, 0.0);
  for (int c = tree_.child_start[f]; c < tree_.child_start[f + 1]; ++c) {
    const Front& child = tree_.fronts[tree_.child[c]];
    const int* place = tree_.row_in_parent.data() + child.row_start;
    const double* value = carried + child.row_start;
    for (int i = 0; i < child.updates; ++i) {
      if (place[i] < w)
        own[place[i]] += value[i];
      else
        below[place[i] - w] += value[i];
    }
  }
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
  const auto part = [&](int number) {
    for (int p = number * kPart; p < std::min(panels_below, (number + 1) * kPart); ++p)
      subtract_panel(front, front.pivot_panels() + p, w, own, below + p * kRows);
  };
  const int parts = (panels_below + kPart - 1) / kPart;
  if (shared(front, w)) {
    pool.run_loop(parts, part);
  } else {
    for (int k = 0; k < parts; ++k) part(k);
  }
  std::copy(below, below + shape.updates, carried + shape.row_start);
}

void Multifrontal::backward(int f, double* y, Scratch& scratch, TaskPool& pool) const {
  const Front& shape = tree_.fronts[f];
  const DenseFront front = view(f);
  const int w = shape.pivots, padded_pivots = front.pivot_panels() * kRows,
            panels_below = front.panels() - front.pivot_panels();
  double *own = scratch.padded.data(), *below = own + padded_pivots, *sums = scratch.sums.data();
  std::copy(y + shape.first, y + shape.first + w, own);
  std::fill(own + w, own + padded_pivots, 0.0);
  const int* row = tree_.row.data() + shape.row_start;
  for (int i = 0; i < shape.updates; ++i) below[i] = y[row[i]];
  std::fill(below + shape.updates, below + panels_below * kRows, 0.0);
  std::fill(sums, sums + 4 * w, 0.0);
  if (shared(front, w)) {
    const int parts = (panels_below + kPart - 1) / kPart;
    const auto width = static_cast<std::size_t>(4 * w);
    scratch.part_sums.assign(static_cast<std::size_t>(parts) * width, 0.0);
    pool.run_loop(parts, [&](int number) {
      for (int p = number * kPart; p < std::min(panels_below, (number + 1) * kPart); ++p)
        add_panel(front, front.pivot_panels() + p, w, below + p * kRows,
                  scratch.part_sums.data() + static_cast<std::size_t>(number) * width);
    });
    for (int k = 0; k < parts; ++k) {
      const double* part = scratch.part_sums.data() + static_cast<std::size_t>(k) * width;
      for (std::size_t i = 0; i < width; ++i) sums[i] += part[i];
    }
  } else {
    for (int p = 0; p < panels_below; ++p)
      add_panel(front, front.pivot_panels() + p, w, below + p * kRows, sums);
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

void Multifrontal::solve(double* y, TaskPool& pool) const {
  std::vector<double> carried(tree_.row.size());
  pool.run_tree(unit_parent_, unit_priority_, [&](int unit) {
    Scratch scratch(largest_front_);
    for (int f = unit_first_[unit]; f <= unit_last_[unit]; ++f) forward(f, y, carried.data(), scratch, pool);
  });
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
  for (const std::vector<int>& level : unit_levels_) {
    const std::vector<int> apart(level.size(), -1);
    const std::vector<double> priority(level.size(), 0.0);
    pool.run_tree(apart, priority, [&](int k) {
      const int unit = level[static_cast<std::size_t>(k)];
      Scratch scratch(largest_front_);
      for (int f = unit_last_[unit]; f >= unit_first_[unit]; --f) backward(f, y, scratch, pool);
    });
  }
}

}  // namespace brachium::fem
