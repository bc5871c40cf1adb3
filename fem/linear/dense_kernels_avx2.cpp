// Used where the machine has AVX2 and fused multiply-add.

#include <cmath>
#include <cstring>

#include "fem/linear/pivot_block.hpp"

#if defined(__x86_64__)

#include <immintrin.h>

// From here on, so that nothing of the headers above is compiled for machines that have it only.
#pragma GCC push_options
#pragma GCC target("avx2,fma")

namespace brachium::fem {

namespace avx2 {

// 12 x 4 sums in twelve registers: 3 loads and 4 broadcasts for 12 fused multiply-adds.
struct Tile {
  __m256d t00, t10, t20, t01, t11, t21, t02, t12, t22, t03, t13, t23;

  [[gnu::always_inline]] void multiply(int depth, const double* a, const double* b) {
    t00 = t10 = t20 = t01 = t11 = t21 = t02 = t12 = t22 = t03 = t13 = t23 = _mm256_setzero_pd();
    for (int k = 0; k < depth; ++k, a += kRows, b += kColumns) {
      const __m256d a0 = _mm256_loadu_pd(a), a1 = _mm256_loadu_pd(a + 4), a2 = _mm256_loadu_pd(a + 8);
      __m256d x = _mm256_broadcast_sd(b);
      t00 = _mm256_fmadd_pd(a0, x, t00);
      t10 = _mm256_fmadd_pd(a1, x, t10);
      t20 = _mm256_fmadd_pd(a2, x, t20);
      x = _mm256_broadcast_sd(b + 1);
      t01 = _mm256_fmadd_pd(a0, x, t01);
      t11 = _mm256_fmadd_pd(a1, x, t11);
      t21 = _mm256_fmadd_pd(a2, x, t21);
      x = _mm256_broadcast_sd(b + 2);
      t02 = _mm256_fmadd_pd(a0, x, t02);
      t12 = _mm256_fmadd_pd(a1, x, t12);
      t22 = _mm256_fmadd_pd(a2, x, t22);
      x = _mm256_broadcast_sd(b + 3);
      t03 = _mm256_fmadd_pd(a0, x, t03);
      t13 = _mm256_fmadd_pd(a1, x, t13);
      t23 = _mm256_fmadd_pd(a2, x, t23);
    }
  }

  template <class Put>
  [[gnu::always_inline]] void put(double* c, std::ptrdiff_t step, std::ptrdiff_t shrink,
                                  const Put& column) const {
    column(c, t00, t10, t20);
    c += step;
    column(c, t01, t11, t21);
    c += step - shrink;
    column(c, t02, t12, t22);
    c += step - 2 * shrink;
    column(c, t03, t13, t23);
  }

  [[gnu::always_inline]] void subtract_from(double* c, std::ptrdiff_t step, std::ptrdiff_t shrink) const {
    put(c, step, shrink, [](double* to, __m256d x, __m256d y, __m256d z) {
      _mm256_storeu_pd(to, _mm256_sub_pd(_mm256_loadu_pd(to), x));
      _mm256_storeu_pd(to + 4, _mm256_sub_pd(_mm256_loadu_pd(to + 4), y));
      _mm256_storeu_pd(to + 8, _mm256_sub_pd(_mm256_loadu_pd(to + 8), z));
    });
  }

  [[gnu::always_inline]] void negate_to(double* c, std::ptrdiff_t step, std::ptrdiff_t shrink) const {
    put(c, step, shrink, [](double* to, __m256d x, __m256d y, __m256d z) {
      const __m256d zero = _mm256_setzero_pd();
      _mm256_storeu_pd(to, _mm256_sub_pd(zero, x));
      _mm256_storeu_pd(to + 4, _mm256_sub_pd(zero, y));
      _mm256_storeu_pd(to + 8, _mm256_sub_pd(zero, z));
    });
  }
};

#include "fem/linear/dense_front_kernels.inc"

}  // namespace avx2

#pragma GCC pop_options

const DenseKernels* dense_kernels_avx2() {
  static const DenseKernels kernels{"AVX2", avx2::eliminate_diagonal, avx2::eliminate_rows, avx2::schur_tile};
  return &kernels;
}

}  // namespace brachium::fem

#else

namespace brachium::fem {
const DenseKernels* dense_kernels_avx2() {
  return nullptr;
}
}  // namespace brachium::fem

#endif
