#include <cstddef>

#include "fem/assembly/batch.hpp"

namespace brachium::fem {
namespace {

namespace baseline {
#include "fem/material/laws.inc"

#include "fem/assembly/kernel.inc"
}  // namespace baseline

#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__)
#define BRACHIUM_HAS_AVX2 1
#define BRACHIUM_LANES_AVX 1
#pragma GCC push_options
#pragma GCC target("avx2,fma")
namespace avx2 {
#include "fem/material/laws.inc"

#include "fem/assembly/kernel.inc"
}  // namespace avx2
#pragma GCC pop_options
#endif

}  // namespace

std::size_t kernel_scratch_size(const KernelInput& in) {
  const int points = in.points * (9 + 9 + 1 + 45 + 27), couplings = 2 * 3 * in.pressures * in.padded_nodes;
  return static_cast<std::size_t>(points + couplings);
}

Kernel choose_kernel(bool portable) {
#ifdef BRACHIUM_HAS_AVX2
  if (!portable && __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")) return avx2::run;
#endif
  static_cast<void>(portable);
  return baseline::run;
}

const char* kernel_name(Kernel kernel) {
  return kernel == baseline::run ? "portable" : "AVX2 with fused multiply-add";
}

}  // namespace brachium::fem
