#include "fem/linear/multifrontal.hpp"

#include <algorithm>
#include <utility>

namespace brachium::fem {

namespace {

constexpr double kUnitShare = 1.0 / 64.0;  // of all work: subtrees below it are one task
constexpr double kUnitLeast = 2e6;         // flops
constexpr double kParallelFlops = 5e6;     // a front with more is shared among threads
constexpr int kPanelsPerItem = 12;

std::size_t triangle(std::size_t u) {
  return u * (u + 1) / 2;
}

}  // namespace

struct Multifrontal::Job {
  std::span<const double> values, diagonal;
  double zero_pivot;
  TaskPool& pool;
  const DenseKernels& kernels;
  std::atomic<bool> lost_column{false};
  std::atomic<double> largest_multiplier{0.0};
};

Multifrontal::Multifrontal(AssemblyTree tree, EntryMap map) : tree_(std::move(tree)), map_(std::move(map)) {
  const std::size_t n = tree_.unknown_at.size();
  factor_.l = allocate_aligned(static_cast<std::size_t>(tree_.stored_entries));
  factor_.d.resize(n);
  factor_.e.resize(n);
  factor_.interchange.resize(n);
  factor_.growth.resize(n);
  int blocks = 0;
  for (const Front& front : tree_.fronts) {
    factor_.block_start.push_back(blocks);
    blocks += (front.pivots + kBlock - 1) / kBlock;
    largest_front_ = std::max(largest_front_, front.size());
  }
  factor_.block_pivoted.resize(static_cast<std::size_t>(blocks));
  schur_.resize(tree_.fronts.size());
  make_units();
}

void Multifrontal::make_units() {
  const int count = static_cast<int>(tree_.fronts.size());
  std::vector<double> own(count), below(count, 0.0);
  std::vector<int> first(count);
  for (int f = 0; f < count; ++f) {
    const Front& front = tree_.fronts[f];
    own[f] = front_flops(front.pivots, front.updates) + 1e3 * front.size();
    below[f] += own[f];
    first[f] = tree_.child_start[f] < tree_.child_start[f + 1] ? first[tree_.child[tree_.child_start[f]]] : f;
    if (front.parent >= 0) below[front.parent] += below[f];
  }
  const double limit = std::max(kUnitLeast, kUnitShare * tree_.flops);
  std::vector<int> unit_of(count, -1);
  for (int f = 0; f < count; ++f) {
    const int parent = tree_.fronts[f].parent;
    const bool small = below[f] <= limit;
    if (small && parent >= 0 && below[parent] <= limit) continue;  // inside a larger subtree
    unit_of[f] = static_cast<int>(unit_first_.size());
    unit_first_.push_back(small ? first[f] : f);
    unit_last_.push_back(f);
  }
  unit_parent_.assign(unit_first_.size(), -1);
  unit_priority_.assign(unit_first_.size(), 0.0);
  // Priority: work on the way to the root, so that the longest chain is never kept waiting.
  for (int unit = static_cast<int>(unit_first_.size()) - 1; unit >= 0; --unit) {
    const int f = unit_last_[unit], parent = tree_.fronts[f].parent;
    unit_priority_[unit] = unit_first_[unit] < f ? below[f] : own[f];
    if (parent >= 0) {
      unit_parent_[unit] = unit_of[parent];
      unit_priority_[unit] += unit_priority_[unit_of[parent]];
    }
  }
  std::vector<std::size_t> level(unit_first_.size(), 0);
  for (int unit = static_cast<int>(unit_first_.size()) - 1; unit >= 0; --unit) {
    if (unit_parent_[unit] >= 0) level[unit] = level[unit_parent_[unit]] + 1;
    if (unit_levels_.size() <= level[unit]) unit_levels_.resize(level[unit] + 1);
    unit_levels_[level[unit]].push_back(unit);
  }
}

long long Multifrontal::memory_bytes() const {
  return static_cast<long long>(sizeof(double)) *
             (tree_.stored_entries + 3 * static_cast<long long>(factor_.d.size())) +
         static_cast<long long>(buffers_.bytes()) +
         static_cast<long long>(sizeof(EntryRun)) * static_cast<long long>(map_.runs.size()) +
         static_cast<long long>(sizeof(int)) *
             static_cast<long long>(2 * tree_.row.size() + 4 * factor_.d.size());
}

void Multifrontal::factorise(std::span<const double> values, std::span<const double> diagonal,
                             double zero_pivot, TaskPool& pool, const DenseKernels& kernels) {
  Job job{values, diagonal, zero_pivot, pool, kernels};
  const auto clear = [&] {
    for (Buffer& s : schur_) buffers_.give(std::exchange(s, {}));
  };
  try {
    pool.run_tree(unit_parent_, unit_priority_, [&](int unit) {
      for (int f = unit_first_[unit]; f <= unit_last_[unit]; ++f) eliminate(f, job);
    });
  } catch (...) {
    clear();
    throw;
  }
  clear();
  factor_.lost_column = job.lost_column;
  factor_.largest_multiplier = job.largest_multiplier;
}

std::vector<Multifrontal::Child> Multifrontal::children_of(int f, const DenseFront& front) const {
  std::vector<Child> children;
  const auto append = [](std::vector<Run>& runs, int i, std::ptrdiff_t place) {
    if (runs.empty() || runs.back().end != i || runs.back().shift != place - i)
      runs.push_back({i, i, place - i});
    ++runs.back().end;
  };
  for (int c = tree_.child_start[f]; c < tree_.child_start[f + 1]; ++c) {
    Child child{tree_.child[c], {}, {}};
    const Front& shape = tree_.fronts[child.front];
    const int* place = tree_.row_in_parent.data() + shape.row_start;
    for (int i = 0; i < shape.updates; ++i) {
      append(child.in_w, i, front.w_offset(place[i]));
      if (place[i] >= front.pivots) append(child.in_schur, i, place[i] - front.pivots);
    }
    children.push_back(std::move(child));
  }
  return children;
}

DenseFront Multifrontal::view(int f) const {
  const Front& shape = tree_.fronts[f];
  return DenseFront{
      .pivots = shape.pivots, .updates = shape.updates, .packed_l = factor_.l.get() + shape.factor_start};
}

void Multifrontal::eliminate(int f, Job& job) {
  const Front& shape = tree_.fronts[f];
  const auto w = static_cast<std::size_t>(shape.pivots), u = static_cast<std::size_t>(shape.updates);
  const bool in_parallel = job.pool.threads() > 1 && front_flops(double(w), double(u)) > kParallelFlops;
  const auto loop = [&](int count, const std::function<void(int)>& item) {
    if (in_parallel) {
      job.pool.run_loop(count, item);
    } else {
      for (int i = 0; i < count; ++i) item(i);
    }
  };
  DenseFront front;
  front.pivots = shape.pivots;
  front.updates = shape.updates;
  front.packed_l = factor_.l.get() + shape.factor_start;
  front.d = factor_.d.data() + shape.first;
  front.e = factor_.e.data() + shape.first;
  front.interchange = factor_.interchange.data() + shape.first;
  front.block_pivoted = factor_.block_pivoted.data() + factor_.block_start[f];
  front.zero_pivot = job.zero_pivot;
  Buffer work = buffers_.take(front.w_size() + 2 * (w + u));
  front.packed_w = work.data.get();
  front.growth = front.packed_w + front.w_size();
  double* diagonal = front.growth + w + u;
  for (std::size_t k = 0; k < w; ++k) diagonal[k] = job.diagonal[static_cast<std::size_t>(shape.first) + k];
  for (std::size_t k = 0; k < u; ++k)
    diagonal[w + k] =
        job.diagonal[static_cast<std::size_t>(tree_.row[static_cast<std::size_t>(shape.row_start) + k])];
  front.diagonal = diagonal;

  const std::vector<Child> children = children_of(f, front);
  assemble(f, job, front, children, in_parallel);
  for (int b = 0; b < front.blocks(); ++b) {
    job.kernels.eliminate_diagonal(front, b);
    const int begin = std::min(front.pivot_panels(), (b + 1) * (kBlock / kRows)),
              panels = front.panels() - begin;
    loop((panels + kPanelsPerItem - 1) / kPanelsPerItem, [&](int item) {
      const int first = begin + item * kPanelsPerItem;
      job.kernels.eliminate_rows(front, b, first, std::min(first + kPanelsPerItem, front.panels()));
    });
  }
  std::copy(front.growth, front.growth + w, factor_.growth.begin() + shape.first);
  if (u > 0) {
    schur_[f] = buffers_.take(triangle(u) + u);
    front.schur = schur_[f].data.get();
    std::vector<std::pair<int, int>> tiles;
    for (int c = 0; c < front.updates; c += kStrip) {
      for (int r = c / kChunk * kChunk; r < front.updates; r += kChunk) {
        if (std::min(r + kChunk, front.updates) > c) tiles.emplace_back(c, r);
      }
    }
    loop(static_cast<int>(tiles.size()), [&](int t) {
      job.kernels.schur_tile(front, tiles[t].first, tiles[t].second);
      for (const Child& child : children) add_to_schur(child, front, tiles[t].first, tiles[t].second);
    });
    std::copy(front.growth + w, front.growth + w + u, front.schur + triangle(u));
  }
  for (const Child& child : children) buffers_.give(std::exchange(schur_[child.front], {}));
  buffers_.give(std::move(work));
  if (front.lost_column) job.lost_column = true;
  const double largest = front.largest_multiplier;
  double seen = job.largest_multiplier;
  while (largest > seen && !job.largest_multiplier.compare_exchange_weak(seen, largest)) {
  }
}

void Multifrontal::assemble(int f, Job& job, DenseFront& front, const std::vector<Child>& children,
                            bool in_parallel) {
  const std::ptrdiff_t size = front.size();
  std::fill(front.growth, front.growth + size, 0.0);
  for (const Child& child : children) {
    const Front& shape = tree_.fronts[child.front];
    const double* growth = schur_[child.front].data.get() + triangle(static_cast<std::size_t>(shape.updates));
    const int* place = tree_.row_in_parent.data() + shape.row_start;
    for (int i = 0; i < shape.updates; ++i) front.growth[place[i]] += growth[i];
  }
  std::fill(front.packed_w, front.packed_w + front.w_size(), 0.0);
  map_.scatter(f, job.values, front.packed_w);
  const auto strip = [&](int s) {
    for (const Child& child : children)
      add_to_columns(child, front, s * kStrip, std::min((s + 1) * kStrip, front.pivots));
  };
  const int strips = (front.pivots + kStrip - 1) / kStrip;
  if (in_parallel) {
    job.pool.run_loop(strips, strip);
  } else {
    for (int s = 0; s < strips; ++s) strip(s);
  }
}

// Pivot columns [begin, end) of the front.
void Multifrontal::add_to_columns(const Child& child, DenseFront& front, int begin, int end) {
  const Front& shape = tree_.fronts[child.front];
  const double* schur = schur_[child.front].data.get();
  const int* place = tree_.row_in_parent.data() + shape.row_start;
  const int from = static_cast<int>(std::lower_bound(place, place + shape.updates, begin) - place);
  std::size_t first_run = 0;
  for (int j = from; j < shape.updates && place[j] < end; ++j) {
    while (child.in_w[first_run].end <= j) ++first_run;
    const double* column = schur + DenseFront::schur_offset(j, shape.updates);
    double* to = front.packed_w + static_cast<std::ptrdiff_t>(place[j]) * kRows;
    for (std::size_t r = first_run; r < child.in_w.size(); ++r) {
      const Run& run = child.in_w[r];
      const int begin_row = std::max(run.begin, j), count = run.end - begin_row;
      const double* values = column + begin_row;
      double* rows = to + begin_row + run.shift;
      for (int i = 0; i < count; ++i) rows[i] += values[i];
    }
  }
}

// The tile of the front's Schur complement with this first column and row.
void Multifrontal::add_to_schur(const Child& child, DenseFront& front, int column, int row) {
  const Front& shape = tree_.fronts[child.front];
  const double* schur = schur_[child.front].data.get();
  const int* place = tree_.row_in_parent.data() + shape.row_start;
  const int* end = place + shape.updates;
  const int w = front.pivots;
  const int column_begin = static_cast<int>(std::lower_bound(place, end, w + column) - place);
  const int column_end =
      static_cast<int>(std::lower_bound(place + column_begin, end, w + column + kStrip) - place);
  const int row_begin = static_cast<int>(std::lower_bound(place, end, w + row) - place);
  const int row_end = static_cast<int>(std::lower_bound(place + row_begin, end, w + row + kChunk) - place);
  std::size_t first_run = 0;
  for (int j = column_begin; j < column_end; ++j) {
    const int top = std::max(row_begin, j);
    while (first_run < child.in_schur.size() && child.in_schur[first_run].end <= top) ++first_run;
    const double* from = schur + DenseFront::schur_offset(j, shape.updates);
    double* to = front.schur_column(place[j] - w);
    for (std::size_t r = first_run; r < child.in_schur.size() && child.in_schur[r].begin < row_end; ++r) {
      const Run& run = child.in_schur[r];
      const int begin_row = std::max(run.begin, top), count = std::min(run.end, row_end) - begin_row;
      const double* values = from + begin_row;
      double* rows = to + begin_row + run.shift;
      for (int i = 0; i < count; ++i) rows[i] += values[i];
    }
  }
}

}  // namespace brachium::fem
