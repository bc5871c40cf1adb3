// Time of a material law at one quadrature point, four at once in lanes: stress and tangent as the assembly
// asks for them, with the energy as well, and by both instruction sets.
//
//   fem_material_bench --benchmark_counters_tabular=true

#include <benchmark/benchmark.h>

#include <string>

#include "fem/material/material.hpp"
#include "fem/material/parameter_sets.hpp"

namespace {

using namespace brachium::fem;

void run(benchmark::State& state, const Material& material, InstructionSet set, Wanted wanted,
         double activation, double muscle) {
  if (set == InstructionSet::avx2 && !has_avx2()) {
    state.SkipWithError("no AVX2 here");
    return;
  }
  const double C[6] = {1.21, 0.9, 0.95, 0.05, -0.03, 0.08};
  MaterialPoint<Lanes> at;
  for (int i = 0; i < 6; ++i) at.C[i] = Lanes{} + C[i] + (i == 0 ? Lanes{0.0, 0.01, 0.02, -0.1} : Lanes{});
  at.fibre[0] = Lanes{} + 0.8, at.fibre[1] = Lanes{} + 0.6, at.fibre[2] = Lanes{};
  at.activation = Lanes{} + activation, at.muscle = Lanes{} + muscle;
  at.soft_tissue = Lanes{}, at.stretch_before = Lanes{} + 1.0;
  MaterialResponse<Lanes> out;
  for (auto _ : state) {
    evaluate(material, set, wanted, at, out);
    benchmark::DoNotOptimize(out);
    benchmark::ClobberMemory();
  }
  state.counters["per_point"] = benchmark::Counter(4.0 * static_cast<double>(state.iterations()),
                                                   benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}

void add(const std::string& name, const Material& material, double activation = 0.0, double muscle = 1.0) {
  struct Way {
    const char* name;
    InstructionSet set;
    Wanted wanted;
  };
  for (const Way& way : {Way{"avx2/tangent", InstructionSet::avx2, with_tangent},
                         Way{"avx2/stress", InstructionSet::avx2, stress_only},
                         Way{"avx2/everything", InstructionSet::avx2, everything},
                         Way{"baseline/tangent", InstructionSet::baseline, with_tangent}}) {
    benchmark::RegisterBenchmark((name + "/" + way.name).c_str(), run, material, way.set, way.wanted,
                                 activation, muscle);
  }
}

const bool registered = [] {
  const MuscleTendon m = muscle_tendon_named("sprenger");
  add("muscle_passive", m);
  add("muscle_active", m, 0.5);
  add("transition_active", m, 0.5, 0.5);
  add("neo_hooke", NeoHooke{1e4, false});
  add("neo_hooke_isochoric", NeoHooke{1e4, true});
  add("mooney_rivlin", MooneyRivlin{1e4, 1e3, false});
  add("mooney_rivlin_isochoric", MooneyRivlin{1e4, 1e3, true});
  add("fung", FungGuccione{2e3, 8.0, 2.0, 4.0, false});
  add("fung_isochoric", FungGuccione{2e3, 8.0, 2.0, 4.0, true});
  add("blemker_active", BlemkerMuscle{500.0, 500.0, 0.05, 6.6, 1.0, 3e5, 1.4}, 0.5);
  return true;
}();

}  // namespace
