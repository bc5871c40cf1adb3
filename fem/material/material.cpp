#include "fem/material/material.hpp"

#include <stdexcept>

namespace brachium::fem {
namespace {

namespace baseline {
#include "fem/material/laws.inc"

#include "fem/material/evaluate_lanes.inc"
}  // namespace baseline

#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__)
#define BRACHIUM_HAS_AVX2 1
#define BRACHIUM_LANES_AVX 1
#pragma GCC push_options
#pragma GCC target("avx2,fma")
namespace avx2 {
#include "fem/material/laws.inc"

#include "fem/material/evaluate_lanes.inc"
}  // namespace avx2
#pragma GCC pop_options
#undef BRACHIUM_LANES_AVX
#endif

}  // namespace

void evaluate(const Material& material, const MaterialPoint<double>& point,
              MaterialResponse<double>& response) {
  std::visit([&](const auto& law) { baseline::evaluate_law(law, point, response); }, material);
}

bool has_avx2() {
#ifdef BRACHIUM_HAS_AVX2
  static const bool has = __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
  return has;
#else
  return false;
#endif
}

void evaluate(const Material& material, InstructionSet set, Wanted wanted, const MaterialPoint<Lanes>& point,
              MaterialResponse<Lanes>& response) {
  if (set == InstructionSet::avx2 && !has_avx2()) throw std::logic_error("this machine has no AVX2");
  std::visit(
      [&](const auto& law) {
#ifdef BRACHIUM_HAS_AVX2
        if (set == InstructionSet::avx2) {
          avx2::evaluate_lanes(law, wanted, point, response);
          return;
        }
#endif
        baseline::evaluate_lanes(law, wanted, point, response);
      },
      material);
}

void evaluate(const Material& material, const MaterialPoint<Lanes>& point,
              MaterialResponse<Lanes>& response) {
  evaluate(material, has_avx2() ? InstructionSet::avx2 : InstructionSet::baseline, everything, point,
           response);
}

}  // namespace brachium::fem
