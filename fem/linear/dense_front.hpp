#pragma once
/// The dense part of one front: its pivot columns are eliminated, block of columns by block, and the rest
/// gets its Schur complement.
///
///     F = | F11      |   F11 = L11 D L11',   W = F21 L11'^-1 = L21 D,   S = F22 - W L21'
///         | F21  F22 |
///
/// symbol | identifier | meaning
/// w, u   | pivots, updates | columns eliminated; rows of the Schur complement
/// W      | packed_w   | F on entry; in panels of 12 rows, each by columns of 12 values; rows filled up with
/// zeros L      | packed_l   | in groups of 4 rows, each by columns of 4 values; strictly below the diagonal,
/// which is 1 D      | d, e       | diagonal; entries (k + 1, k), not 0 where k and k + 1 are a 2 x 2 pivot
/// S      | schur      | lower triangle by columns without gaps, u (u + 1) / 2 values
/// g      | growth     | (|L| |D| |L'|)_ii of every row of the front
///
/// Pivot rows and update rows start panels of their own. A block of 48 columns takes the former blocks'
/// columns at once (left-looking): a row of W needs the rows of W and L of former blocks only, so that row
/// panels are independent. Every value is computed by the same operations in the same order whoever does it.

#include <atomic>
#include <cstddef>

namespace brachium::fem {

constexpr int kRows = 12;    ///< rows of a packed panel of W, and of a register tile
constexpr int kColumns = 4;  ///< rows of a packed group of L, columns of a register tile
constexpr int kBlock = 48;   ///< columns eliminated at a time
constexpr int kStrip = 96;   ///< columns of a tile of the Schur complement
constexpr int kChunk = 192;  ///< rows of a tile of the Schur complement
constexpr int kDepth = 128;  ///< columns of W and L multiplied at a time: what the first cache holds

struct DenseFront {
  int pivots = 0, updates = 0;
  double* d = nullptr;               // w
  double* e = nullptr;               // w
  int* interchange = nullptr;        // w: place within its block that an unknown comes from
  char* block_pivoted = nullptr;     // per block of columns
  double* growth = nullptr;          // w + u
  const double* diagonal = nullptr;  // w + u: |a_ii|
  double* packed_w = nullptr;        // w_size()
  double* packed_l = nullptr;        // l_size()
  double* schur = nullptr;
  double zero_pivot = 0.0;

  // What went wrong, from any thread.
  std::atomic<bool> lost_column{false};  // a pivot vanished though its column did not
  std::atomic<double> largest_multiplier{0.0};

  int size() const { return pivots + updates; }
  int pivot_panels() const { return (pivots + kRows - 1) / kRows; }
  int panels() const { return pivot_panels() + (updates + kRows - 1) / kRows; }
  int first_row(int p) const {
    return p < pivot_panels() ? p * kRows : pivots + (p - pivot_panels()) * kRows;
  }
  int blocks() const { return (pivots + kBlock - 1) / kBlock; }
  static std::size_t packed_rows(int pivots, int updates) {
    const auto panels_of = [](int rows) { return static_cast<std::size_t>((rows + kRows - 1) / kRows); };
    return kRows * (panels_of(pivots) + panels_of(updates));
  }
  static std::size_t l_size(int pivots, int updates) {
    return packed_rows(pivots, updates) * static_cast<std::size_t>(pivots);
  }
  /// Columns of a panel of W: whole register tiles.
  static int w_columns(int pivots) { return (pivots + kColumns - 1) / kColumns * kColumns; }
  std::size_t w_size() const {
    return packed_rows(pivots, updates) * static_cast<std::size_t>(w_columns(pivots));
  }
  double* w_panel(int p) const {
    return packed_w + static_cast<std::ptrdiff_t>(p) * kRows * w_columns(pivots);
  }
  double* l_group(int g) const { return packed_l + static_cast<std::ptrdiff_t>(g) * kColumns * pivots; }
  /// Place of a row of the front in its first column: column k stands kRows k values behind.
  std::ptrdiff_t w_offset(int row) const {
    const int padded = row < pivots ? row : pivot_panels() * kRows + row - pivots;
    return static_cast<std::ptrdiff_t>(padded / kRows) * kRows * w_columns(pivots) + padded % kRows;
  }

  /// First value of column j of the Schur complement, so that row i stands at [i]: column j starts at its
  /// diagonal.
  double* schur_column(int j) const { return schur + schur_offset(j, updates); }
  static std::ptrdiff_t schur_offset(std::ptrdiff_t j, std::ptrdiff_t u) { return j * u - j * (j + 1) / 2; }

  void note_multiplier(double value) {
    double seen = largest_multiplier.load(std::memory_order_relaxed);
    while (value > seen && !largest_multiplier.compare_exchange_weak(seen, value)) {
    }
  }
};

/// The parts, compiled for AVX2 with fused multiply-add and for any machine.
struct DenseKernels {
  const char* name;
  /// Eliminates the diagonal block of block column b (0, 1, ...): all former blocks are done.
  void (*eliminate_diagonal)(DenseFront& front, int b);
  /// Rows of panels [begin, end), all below the diagonal block, of block column b.
  void (*eliminate_rows)(DenseFront& front, int b, int begin, int end);
  /// Schur complement's columns [c, c + kStrip) and rows [r, r + kChunk), the lower triangle: S = -W L21'.
  void (*schur_tile)(const DenseFront& front, int c, int r);
};

/// The fastest that this machine runs.
const DenseKernels& dense_kernels();

const DenseKernels& dense_kernels_portable();
const DenseKernels* dense_kernels_avx2();  ///< null where not compiled in

}  // namespace brachium::fem
