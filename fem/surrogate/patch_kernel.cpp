#include <cstddef>

#include "fem/surrogate/patches.hpp"

namespace brachium::fem {
namespace {

typedef double Lane4 __attribute__((vector_size(32)));                              // four outputs
typedef double LooseLane4 __attribute__((vector_size(32), aligned(8), may_alias));  // ... anywhere in memory

namespace baseline {
#include "fem/surrogate/patch_kernel.inc"
}  // namespace baseline

#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__)
#define BRACHIUM_HAS_AVX2 1
#pragma GCC push_options
#pragma GCC target("avx2,fma")
namespace avx2 {
#include "fem/surrogate/patch_kernel.inc"
}  // namespace avx2
#pragma GCC pop_options
#endif

}  // namespace

PatchKernel choose_patch_kernel(bool portable) {
#ifdef BRACHIUM_HAS_AVX2
  if (!portable && __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")) return avx2::run;
#endif
  static_cast<void>(portable);
  return baseline::run;
}

}  // namespace brachium::fem
