#include "emg/biquad.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <cstring>

namespace brachium::emg {
namespace {

typedef double Lane4 __attribute__((vector_size(32)));  // four channels at one instant
typedef double LooseLane4 __attribute__((vector_size(32), aligned(8), may_alias));  // ... anywhere in memory
typedef std::int64_t Mask4 __attribute__((vector_size(32)));

constexpr std::size_t max_lanes = channels_at_once;

// A group of up to 4 V channels. Lanes without a channel of their own share that of lane 0: they do with it
// what lane 0 does and write the same values.
struct Group {
  double* channel[max_lanes] = {};
  alignas(32) double subtract[max_lanes] = {};
  bool prepare = false, rectify = false;
};

// What one sweep needs beside the group: sections, their levels, memory for histories and odd extension.
struct Work {
  const Biquad* sections;
  const double* levels;
  std::size_t section_count;
  std::size_t samples;
  std::size_t pad;   // 0: causal
  Lane4* history;    // 2 V (section_count + 1)
  Lane4* extension;  // V pad
};

namespace baseline {
#include "emg/biquad_lanes.inc"
}  // namespace baseline

// Neither version has fused multiply-add, so that both give the same bits.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__)
#define BRACHIUM_HAS_AVX2 1
#pragma GCC push_options
#pragma GCC target("avx2,tune=haswell")  // tune: unaligned loads are not split in two
namespace avx2 {
#include "emg/biquad_lanes.inc"
}  // namespace avx2
#pragma GCC pop_options
#endif

using Run = void (*)(const Group&, const Work&);

// The loops for 4 or 8 lanes that this machine runs best.
Run choose(std::size_t vectors) {
#ifdef BRACHIUM_HAS_AVX2
  if (__builtin_cpu_supports("avx2")) return vectors == 1 ? avx2::run_4_lanes : avx2::run_8_lanes;
#endif
  return vectors == 1 ? baseline::run_4_lanes : baseline::run_8_lanes;
}

struct alignas(32) Block {  // a Lane4 that a vector may hold
  Lane4 lanes;
};

void filter(std::span<const Biquad> sections, std::span<const std::span<double>> channels,
            const Preparation& preparation, std::size_t pad) {
  if (channels.empty() || channels.front().empty()) return;
  const std::size_t n = channels.front().size();
  assert(n > pad);
  const std::vector<double> levels = steady_levels(sections);

  for (std::size_t first = 0; first < channels.size(); first += max_lanes) {
    Group g;
    const std::size_t lanes = std::min(max_lanes, channels.size() - first);
    g.prepare = !preparation.subtract.empty() || preparation.rectify;
    g.rectify = preparation.rectify;
    for (std::size_t lane = 0; lane < max_lanes; ++lane) {
      const std::size_t c = lane < lanes ? first + lane : first;
      assert(channels[c].size() == n);
      g.channel[lane] = channels[c].data();
      g.subtract[lane] = preparation.subtract.empty() ? 0.0 : preparation.subtract[c];
    }
    const std::size_t V = lanes <= 4 ? 1 : 2;
    std::vector<Block> memory(V * (2 * (sections.size() + 1) + pad));
    Lane4* const base = &memory.front().lanes;
    const Work w{
        sections.data(), levels.data(), sections.size(), n, pad, base, base + V * 2 * (sections.size() + 1)};
    choose(V)(g, w);
  }
}

}  // namespace

std::vector<double> steady_levels(std::span<const Biquad> sections) {
  std::vector<double> levels{1.0};
  for (const Biquad& s : sections)
    levels.push_back(levels.back() * ((s.b0 + s.b1 + s.b2) / (1.0 + s.a1 + s.a2)));
  return levels;
}

std::size_t padding(std::span<const Biquad> sections) {
  std::size_t poles = 0;
  for (const Biquad& s : sections) poles += s.a2 != 0.0 ? 2 : 1;
  return 3 * (poles + 1);
}

void filter_zero_lag(std::span<const Biquad> sections, std::span<const std::span<double>> channels,
                     const Preparation& preparation) {
  filter(sections, channels, preparation, padding(sections));
}

void filter_causal(std::span<const Biquad> sections, std::span<const std::span<double>> channels,
                   const Preparation& preparation) {
  filter(sections, channels, preparation, 0);
}

}  // namespace brachium::emg
