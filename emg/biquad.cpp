#include "emg/biquad.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <cstring>

// Compiled twice, chosen when the program is loaded. Neither version has fused multiply-add, so both give the same bits.
#if defined(__x86_64__) && defined(__gnu_linux__) && !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define BRACHIUM_CLONES __attribute__((target_clones("avx2", "default")))
#else
#define BRACHIUM_CLONES
#endif
#define BRACHIUM_INLINE inline __attribute__((always_inline))

namespace brachium::emg {
namespace {

typedef double Lane4 __attribute__((vector_size(32)));        // four channels at one instant
typedef std::int64_t Mask4 __attribute__((vector_size(32)));

constexpr std::size_t tile_rows = 128;  // a tile of 16 lanes is 16 KiB: it stays in the first-level cache
constexpr std::size_t max_lanes = 16;

BRACHIUM_INLINE void broadcast(double x, Lane4& out) { out = Lane4{x, x, x, x}; }

// All sections over `rows` rows of V x 4 lanes, the state of section s in z[2 V s ...].
template <std::size_t V>
BRACHIUM_INLINE void run_sections(const Biquad* sections, std::size_t count, Lane4* z, Lane4* rows, std::size_t n) {
  for (std::size_t s = 0; s < count; ++s) {
    Lane4 b0, b1, b2, a1, a2;
    broadcast(sections[s].b0, b0);
    broadcast(sections[s].b1, b1);
    broadcast(sections[s].b2, b2);
    broadcast(sections[s].a1, a1);
    broadcast(sections[s].a2, a2);
    Lane4 z1[V], z2[V];
    for (std::size_t v = 0; v < V; ++v) {
      z1[v] = z[(2 * s) * V + v];
      z2[v] = z[(2 * s + 1) * V + v];
    }
    for (std::size_t r = 0; r < n; ++r) {
      for (std::size_t v = 0; v < V; ++v) {
        const Lane4 x = rows[r * V + v];
        const Lane4 y = b0 * x + z1[v];
        z1[v] = (b1 * x - a1 * y) + z2[v];
        z2[v] = b2 * x - a2 * y;
        rows[r * V + v] = y;
      }
    }
    for (std::size_t v = 0; v < V; ++v) {
      z[(2 * s) * V + v] = z1[v];
      z[(2 * s + 1) * V + v] = z2[v];
    }
  }
}

BRACHIUM_INLINE void transpose(Lane4& a, Lane4& b, Lane4& c, Lane4& d) {
  const Lane4 ab_even = __builtin_shuffle(a, b, Mask4{0, 4, 2, 6});
  const Lane4 ab_odd = __builtin_shuffle(a, b, Mask4{1, 5, 3, 7});
  const Lane4 cd_even = __builtin_shuffle(c, d, Mask4{0, 4, 2, 6});
  const Lane4 cd_odd = __builtin_shuffle(c, d, Mask4{1, 5, 3, 7});
  a = __builtin_shuffle(ab_even, cd_even, Mask4{0, 1, 4, 5});
  b = __builtin_shuffle(ab_odd, cd_odd, Mask4{0, 1, 4, 5});
  c = __builtin_shuffle(ab_even, cd_even, Mask4{2, 3, 6, 7});
  d = __builtin_shuffle(ab_odd, cd_odd, Mask4{2, 3, 6, 7});
}

BRACHIUM_INLINE void load(const double* from, Lane4& out) { std::memcpy(&out, from, sizeof out); }
BRACHIUM_INLINE void store(double* to, const Lane4& in) { std::memcpy(to, &in, sizeof in); }

// A group of up to 4 V channels. Lanes without a channel read channel 0 and are not written.
struct Group {
  double* channel[max_lanes] = {};
  std::size_t lanes = 0;
  double subtract[max_lanes] = {};
  bool prepare = false, rectify = false;
};

// Samples [first, first + n) of every lane, n a multiple of 4 or not, to rows in order of time; prepared if wanted.
template <std::size_t V>
BRACHIUM_INLINE void gather(const Group& g, std::size_t first, std::size_t n, Lane4* rows) {
  const Mask4 magnitude = {INT64_MAX, INT64_MAX, INT64_MAX, INT64_MAX};
  for (std::size_t v = 0; v < V; ++v) {
    const double* const* c = g.channel + 4 * v;
    const Lane4 offset = {g.subtract[4 * v], g.subtract[4 * v + 1], g.subtract[4 * v + 2], g.subtract[4 * v + 3]};
    std::size_t r = 0;
    for (; r + 4 <= n; r += 4) {
      Lane4 t[4];
      for (std::size_t i = 0; i < 4; ++i) load(c[i] + first + r, t[i]);
      transpose(t[0], t[1], t[2], t[3]);
      for (std::size_t i = 0; i < 4; ++i) {
        if (g.prepare) t[i] = t[i] - offset;
        if (g.rectify) t[i] = reinterpret_cast<Lane4>(reinterpret_cast<Mask4>(t[i]) & magnitude);
        rows[(r + i) * V + v] = t[i];
      }
    }
    for (; r < n; ++r) {
      Lane4 t = {c[0][first + r], c[1][first + r], c[2][first + r], c[3][first + r]};
      if (g.prepare) t = t - offset;
      if (g.rectify) t = reinterpret_cast<Lane4>(reinterpret_cast<Mask4>(t) & magnitude);
      rows[r * V + v] = t;
    }
  }
}

template <std::size_t V>
BRACHIUM_INLINE void scatter(const Group& g, std::size_t first, std::size_t n, const Lane4* rows) {
  for (std::size_t v = 0; v < V && 4 * v < g.lanes; ++v) {
    const std::size_t used = std::min<std::size_t>(4, g.lanes - 4 * v);
    std::size_t r = 0;
    for (; r + 4 <= n; r += 4) {
      Lane4 t[4];
      for (std::size_t i = 0; i < 4; ++i) t[i] = rows[(r + i) * V + v];
      transpose(t[0], t[1], t[2], t[3]);
      for (std::size_t i = 0; i < used; ++i) store(g.channel[4 * v + i] + first + r, t[i]);
    }
    for (; r < n; ++r) {
      for (std::size_t i = 0; i < used; ++i) g.channel[4 * v + i][first + r] = rows[r * V + v][i];
    }
  }
}

template <std::size_t V>
BRACHIUM_INLINE void reverse_rows(Lane4* rows, std::size_t n) {
  for (std::size_t i = 0, j = n; i + 1 < j; ++i) {
    --j;
    for (std::size_t v = 0; v < V; ++v) {
      const Lane4 t = rows[i * V + v];
      rows[i * V + v] = rows[j * V + v];
      rows[j * V + v] = t;
    }
  }
}

// State of all sections that has settled on the values of one row.
template <std::size_t V>
BRACHIUM_INLINE void settle(const std::array<double, 2>* steady, std::size_t count, const Lane4* row, Lane4* z) {
  for (std::size_t s = 0; s < count; ++s) {
    for (std::size_t v = 0; v < V; ++v) {
      z[(2 * s) * V + v] = steady[s][0] * row[v];
      z[(2 * s + 1) * V + v] = steady[s][1] * row[v];
    }
  }
}

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

template <std::size_t V>
BRACHIUM_INLINE void run(Group& g, const Work& w) {
  alignas(64) Lane4 tile[tile_rows * V];
  const std::size_t n = w.samples;

  if (w.pad > 0) {  // 2 x(0) - x(pad - i) on the left, 2 x(n - 1) - x(n - 2 - i) on the right
    Lane4 end[V];
    gather<V>(g, 1, w.pad, w.left);
    gather<V>(g, 0, 1, end);
    reverse_rows<V>(w.left, w.pad);
    for (std::size_t i = 0; i < w.pad; ++i) {
      for (std::size_t v = 0; v < V; ++v) w.left[i * V + v] = 2.0 * end[v] - w.left[i * V + v];
    }
    gather<V>(g, n - 1 - w.pad, w.pad, w.right);
    gather<V>(g, n - 1, 1, end);
    reverse_rows<V>(w.right, w.pad);
    for (std::size_t i = 0; i < w.pad; ++i) {
      for (std::size_t v = 0; v < V; ++v) w.right[i * V + v] = 2.0 * end[v] - w.right[i * V + v];
    }
    settle<V>(w.steady, w.section_count, w.left, w.state);
    run_sections<V>(w.sections, w.section_count, w.state, w.left, w.pad);
  } else {
    gather<V>(g, 0, 1, tile);
    settle<V>(w.steady, w.section_count, tile, w.state);
  }

  for (std::size_t first = 0; first < n; first += tile_rows) {
    const std::size_t rows = std::min(tile_rows, n - first);
    gather<V>(g, first, rows, tile);
    run_sections<V>(w.sections, w.section_count, w.state, tile, rows);
    scatter<V>(g, first, rows, tile);
  }
  if (w.pad == 0) return;

  run_sections<V>(w.sections, w.section_count, w.state, w.right, w.pad);
  reverse_rows<V>(w.right, w.pad);
  settle<V>(w.steady, w.section_count, w.right, w.state);
  run_sections<V>(w.sections, w.section_count, w.state, w.right, w.pad);
  g.prepare = g.rectify = false;  // done on the way forward
  for (std::size_t end = n; end > 0;) {
    const std::size_t rows = end % tile_rows == 0 ? tile_rows : end % tile_rows;
    end -= rows;
    gather<V>(g, end, rows, tile);
    reverse_rows<V>(tile, rows);
    run_sections<V>(w.sections, w.section_count, w.state, tile, rows);
    reverse_rows<V>(tile, rows);
    scatter<V>(g, end, rows, tile);
  }
}

BRACHIUM_CLONES void run_4_lanes(Group& g, const Work& w) { run<1>(g, w); }
BRACHIUM_CLONES void run_8_lanes(Group& g, const Work& w) { run<2>(g, w); }
BRACHIUM_CLONES void run_16_lanes(Group& g, const Work& w) { run<4>(g, w); }

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
    if (V == 1) run_4_lanes(g, w);
    if (V == 2) run_8_lanes(g, w);
    if (V == 4) run_16_lanes(g, w);
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
