#pragma once
/// L D L' of one small dense block, without interchanges where that is safe, else by Bunch and Kaufman's
/// pivoting restricted to the block.

#include "fem/linear/dense_front.hpp"

namespace brachium::fem {

struct PivotBlock {
  int size = 0;         ///< m <= kBlock
  double* a = nullptr;  ///< m x m by columns of kBlock values, lower triangle; L on return, strictly below
  double* d = nullptr;  ///< m
  double* e = nullptr;  ///< m
  int* from = nullptr;  ///< m: row of the block that was brought to place k
  double* growth = nullptr;          ///< m, in the order given, not that of the places
  const double* diagonal = nullptr;  ///< m, |a_ii| of the whole matrix, likewise
  double zero_pivot = 0.0;
  bool pivoted = false;
  bool lost_column = false;
  double largest_multiplier = 0.0;
};

/// A pivot whose size is not above zero_pivot max(|a_ii|, g_i) becomes 0 with a column of zeros.
/// Interchanges are made when some column would have |d_k a_ii| < a_ik^2 / 100 (a definite block never has).
/// Source: Bunch & Kaufman 1977, doi:10.1090/S0025-5718-1977-0428694-0, algorithm A.
void factorise_block_with_interchanges(PivotBlock& block);

}  // namespace brachium::fem
