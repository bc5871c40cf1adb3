#include "fem/linear/pivot_block.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace brachium::fem {

namespace {

constexpr double kAlpha = 0.6403882032022076;  // (1 + sqrt(17)) / 8

struct Matrix {
  double* a;
  double& operator()(int i, int j) const { return i >= j ? a[j * kBlock + i] : a[i * kBlock + j]; }
};

struct Elimination {
  PivotBlock& b;
  Matrix a;
  double growth[kBlock] = {};  // by place

  // Rows and columns p < q change places, in the columns of L that are done too.
  void interchange(int p, int q) {
    if (p == q) return;
    for (int j = 0; j < p; ++j) std::swap(b.a[j * kBlock + p], b.a[j * kBlock + q]);
    std::swap(a(p, p), a(q, q));
    for (int i = p + 1; i < b.size; ++i) {
      if (i != q) std::swap(a(i, p), a(i, q));
    }
    std::swap(b.from[p], b.from[q]);
    std::swap(growth[p], growth[q]);
    b.pivoted = true;
  }

  // Largest off-diagonal entry of row r among the rows and columns from k on.
  std::pair<double, int> largest(int r, int k) const {
    std::pair<double, int> result{0.0, r};
    for (int i = k; i < b.size; ++i) {
      if (i != r && std::abs(a(i, r)) > result.first) result = {std::abs(a(i, r)), i};
    }
    return result;
  }

  // 1 or 2 columns; the pivot stands at k (and k + 1).
  int choose(int k) {
    const double own = std::abs(a(k, k));
    const auto [column, r] = largest(k, k);
    if (own >= kAlpha * column) return 1;
    const double row = largest(r, k).first;
    if (own * row >= kAlpha * column * column) return 1;
    if (std::abs(a(r, r)) >= kAlpha * row) {
      interchange(k, r);
      return 1;
    }
    interchange(k + 1, r);
    return 2;
  }

  void one(int k) {
    const double d = a(k, k);
    growth[k] += std::abs(d);
    if (!(std::abs(d) > b.zero_pivot * std::max(b.diagonal[b.from[k]], growth[k]))) {
      for (int i = k + 1; i < b.size; ++i) {
        const double bound = b.zero_pivot * growth[k] * std::max(b.diagonal[b.from[i]], growth[i]);
        if (a(i, k) * a(i, k) > bound) b.lost_column = true;
        a(i, k) = 0.0;
      }
      b.d[k] = b.e[k] = 0.0;
      return;
    }
    b.d[k] = d;
    b.e[k] = 0.0;
    for (int j = k + 1; j < b.size; ++j) {
      const double l = a(j, k) / d;
      growth[j] += std::abs(l * a(j, k));
      for (int i = j; i < b.size; ++i) a(i, j) -= a(i, k) * l;
    }
    for (int i = k + 1; i < b.size; ++i) keep(i, k, a(i, k) / d);
  }

  void two(int k) {
    const double d0 = a(k, k), d1 = a(k + 1, k + 1), e = a(k + 1, k);
    b.pivoted = true;
    b.d[k] = d0;
    b.d[k + 1] = d1;
    b.e[k] = e;
    b.e[k + 1] = 0.0;
    growth[k] += std::abs(d0);
    growth[k + 1] += std::abs(d1);
    const double p0 = d0 / e, p1 = d1 / e, q = 1.0 / (e * (p0 * p1 - 1.0));
    a(k + 1, k) = 0.0;  // of L
    double l[2][kBlock];
    for (int i = k + 2; i < b.size; ++i) {
      l[0][i] = (p1 * a(i, k) - a(i, k + 1)) * q;
      l[1][i] = (p0 * a(i, k + 1) - a(i, k)) * q;
      growth[i] += std::abs(d0) * l[0][i] * l[0][i] + std::abs(d1) * l[1][i] * l[1][i] +
                   2.0 * std::abs(e * l[0][i] * l[1][i]);
    }
    for (int j = k + 2; j < b.size; ++j) {
      for (int i = j; i < b.size; ++i) a(i, j) -= a(i, k) * l[0][j] + a(i, k + 1) * l[1][j];
    }
    for (int i = k + 2; i < b.size; ++i) {
      keep(i, k, l[0][i]);
      keep(i, k + 1, l[1][i]);
    }
  }

  void keep(int i, int k, double l) {
    a(i, k) = l;
    b.largest_multiplier = std::max(b.largest_multiplier, std::abs(l));
  }
};

}  // namespace

void factorise_block_with_interchanges(PivotBlock& block) {
  Elimination elimination{block, {block.a}};
  for (int i = 0; i < block.size; ++i) {
    block.from[i] = i;
    elimination.growth[i] = block.growth[i];
  }
  for (int k = 0; k < block.size;) {
    const int columns = elimination.choose(k);
    columns == 1 ? elimination.one(k) : elimination.two(k);
    k += columns;
  }
  for (int k = 0; k < block.size; ++k) block.growth[block.from[k]] = elimination.growth[k];
}

}  // namespace brachium::fem
