#include "emg/biquad.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <cstring>

namespace brachium::emg {
namespace {

typedef double Lane4 __attribute__((vector_size(32)));        // four channels at one instant
typedef std::int64_t Mask4 __attribute__((vector_size(32)));

constexpr std::size_t tile_rows = 128;  // a tile of 16 lanes is 16 KiB: it stays in the first-level cache
constexpr std::size_t max_lanes = 16;

// A group of up to 4 V channels. Lanes without a channel read channel 0 and are not written.
struct Group {
  double* channel[max_lanes] = {};
  std::size_t lanes = 0;
  double subtract[max_lanes] = {};
  bool prepare = false, rectify = false;
};

// What one sweep needs beside the group: sections, their steady state, memory for state and odd extension.
struct Work {
  const Biquad* sections;
  const std::array<double, 2>* steady;
  std::size_t section_count;
  std::size_t samples;
  std::size_t pad;  // 0: causal
  Lane4* state;     // 2 V section_count
  Lane4* left;      // V pad
  Lane4* right;     // V pad
};

namespace baseline {
#include "emg/biquad_lanes.inc"
}  // namespace baseline

// Neither version has fused multiply-add, so that both give the same bits.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__)
#define BRACHIUM_HAS_AVX2 1
#pragma GCC push_options
#pragma GCC target("avx2")
namespace avx2 {
#include "emg/biquad_lanes.inc"
}  // namespace avx2
#pragma GCC pop_options
#endif

using Run = void (*)(Group&, const Work&);

// The loops for 4, 8 or 16 lanes that this machine runs best.
Run choose(std::size_t vectors) {
#ifdef BRACHIUM_HAS_AVX2
  if (__builtin_cpu_supports("avx2")) {
    return vectors == 1 ? avx2::run_4_lanes : vectors == 2 ? avx2::run_8_lanes : avx2::run_16_lanes;
  }
#endif
  return vectors == 1 ? baseline::run_4_lanes : vectors == 2 ? baseline::run_8_lanes : baseline::run_16_lanes;
}

struct alignas(32) Block {  // a Lane4 that a vector may hold
  Lane4 lanes;
};

void filter(std::span<const Biquad> sections, std::span<const std::span<double>> channels,
            const Preparation& preparation, std::size_t pad) {
  if (channels.empty() || channels.front().empty()) return;
  const std::size_t n = channels.front().size();
  assert(n > pad);
  const std::vector<std::array<double, 2>> steady = steady_state(sections);

  for (std::size_t first = 0; first < channels.size(); first += max_lanes) {
    Group g;
    g.lanes = std::min(max_lanes, channels.size() - first);
    g.prepare = !preparation.subtract.empty();
    g.rectify = preparation.rectify;
    for (std::size_t lane = 0; lane < max_lanes; ++lane) {
      const std::size_t c = lane < g.lanes ? first + lane : first;
      assert(channels[c].size() == n);
      g.channel[lane] = channels[c].data();
      g.subtract[lane] = preparation.subtract.empty() ? 0.0 : preparation.subtract[c];
    }
    const std::size_t V = g.lanes <= 4 ? 1 : g.lanes <= 8 ? 2 : 4;
    std::vector<Block> memory(V * (2 * sections.size() + 2 * pad));
    Lane4* const base = memory.empty() ? nullptr : &memory.front().lanes;
    const Work w{sections.data(), steady.data(),           sections.size(),
                 n,               pad,                     base,
                 base + V * 2 * sections.size(), base + V * (2 * sections.size() + pad)};
    choose(V)(g, w);
  }
}

}  // namespace

std::vector<std::array<double, 2>> steady_state(std::span<const Biquad> sections) {
  std::vector<std::array<double, 2>> state;
  double input = 1.0;
  for (const Biquad& s : sections) {
    const double output = input * (s.b0 + s.b1 + s.b2) / (1.0 + s.a1 + s.a2);
    const double z2 = s.b2 * input - s.a2 * output;
    state.push_back({s.b1 * input - s.a1 * output + z2, z2});
    input = output;
  }
  return state;
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
