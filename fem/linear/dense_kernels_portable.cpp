#include <cmath>
#include <cstring>

#include "fem/linear/pivot_block.hpp"

namespace brachium::fem {

namespace portable {

struct Tile {
  double t[kColumns][kRows];

  void multiply(int depth, const double* a, const double* b) {
    for (int j = 0; j < kColumns; ++j) {
      double sum[kRows] = {};
      for (int k = 0; k < depth; ++k) {
        for (int i = 0; i < kRows; ++i) sum[i] += a[k * kRows + i] * b[k * kColumns + j];
      }
      for (int i = 0; i < kRows; ++i) t[j][i] = sum[i];
    }
  }
  void subtract_from(double* c, std::ptrdiff_t step, std::ptrdiff_t shrink) const {
    for (int j = 0; j < kColumns; ++j, c += step, step -= shrink) {
      for (int i = 0; i < kRows; ++i) c[i] -= t[j][i];
    }
  }
  void negate_to(double* c, std::ptrdiff_t step, std::ptrdiff_t shrink) const {
    for (int j = 0; j < kColumns; ++j, c += step, step -= shrink) {
      for (int i = 0; i < kRows; ++i) c[i] = -t[j][i];
    }
  }
};

#include "fem/linear/dense_front_kernels.inc"

}  // namespace portable

const DenseKernels& dense_kernels_portable() {
  static const DenseKernels kernels{"portable", portable::eliminate_diagonal, portable::eliminate_rows,
                                    portable::schur_tile};
  return kernels;
}

const DenseKernels& dense_kernels() {
#if defined(__x86_64__)
  if (dense_kernels_avx2() != nullptr && __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")) {
    return *dense_kernels_avx2();
  }
#endif
  return dense_kernels_portable();
}

}  // namespace brachium::fem
