#pragma once
/// Numerical L D L' over an assembly tree. Source of the method: Duff & Reid 1983, doi:10.1145/356044.356047.

#include <span>
#include <vector>

#include "fem/linear/assembly_tree.hpp"
#include "fem/linear/buffer_pool.hpp"
#include "fem/linear/dense_front.hpp"
#include "fem/linear/entry_map.hpp"
#include "fem/linear/task_pool.hpp"

namespace brachium::fem {

/// Factor P A P' = L D L', where each front has its own interchanges inside blocks of 48 pivots.
struct LdlFactor {
  AlignedArray l;                ///< AssemblyTree::stored_entries
  std::vector<double> d, e;      ///< by position: diagonal and subdiagonal of D; 0 for a pivot that vanished
  std::vector<int> interchange;  ///< by position: place within its block of pivots
  std::vector<char> block_pivoted;  ///< by blocks of all fronts, see block_start
  std::vector<int> block_start;     ///< of a front
  std::vector<double> growth;       ///< by position: (|L| |D| |L'|)_ii
  bool lost_column = false;         ///< a pivot vanished whose column did not: the factor is not one of A
  double largest_multiplier = 0.0;
};

class Multifrontal {
 public:
  Multifrontal(AssemblyTree tree, EntryMap map);

  const AssemblyTree& tree() const { return tree_; }
  const LdlFactor& factor() const { return factor_; }
  long long memory_bytes() const;

  /// `diagonal`: |a_ii| by position.
  void factorise(std::span<const double> values, std::span<const double> diagonal, double zero_pivot,
                 TaskPool& pool, const DenseKernels& kernels);

  /// y := (L D L')^-1 y, y by position; the same bits for any number of threads.
  void solve(double* y, TaskPool& pool) const;

 private:
  struct Job;  // of one factorisation
  // Update rows [begin, end) of a child whose places in the parent are consecutive: row i stands `shift` + i
  // values behind the first row of a column of S, or of a column of W, where runs end with the panels.
  struct Run {
    int begin, end;
    std::ptrdiff_t shift;
  };
  struct Child {
    int front;
    std::vector<Run> in_w, in_schur;
  };

  void make_units();
  void eliminate(int f, Job& job);
  void assemble(int f, Job& job, DenseFront& front, const std::vector<Child>& children, bool in_parallel);
  void add_to_columns(const Child& child, DenseFront& front, int begin, int end);
  void add_to_schur(const Child& child, DenseFront& front, int column, int row);
  std::vector<Child> children_of(int f, const DenseFront& front) const;
  DenseFront view(int f) const;  // shape and factor
  struct Scratch;
  void forward(int f, double* y, double* carried, Scratch& scratch, TaskPool& pool) const;
  void backward(int f, double* y, Scratch& scratch, TaskPool& pool) const;

  AssemblyTree tree_;
  EntryMap map_;
  LdlFactor factor_;
  BufferPool buffers_;
  std::vector<Buffer> schur_;  // of fronts whose parent is not done: S, then the growth of its rows
  int largest_front_ = 0;

  // Units of the task tree: whole subtrees with little work, single fronts above them.
  std::vector<int> unit_first_, unit_last_, unit_parent_;
  std::vector<double> unit_priority_;
  std::vector<std::vector<int>> unit_levels_;  // by distance from a root
};

}  // namespace brachium::fem
