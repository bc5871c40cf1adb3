#pragma once
/// Which states to compute: a design names them, takes the results, and asks for more where the surrogate is
/// worst.
///
///   while (...) {
///     for (const StatePoint& s : design.wanted()) compute(s);   // in any order, in parallel, over several
///     runs design.feed(results); const Surrogate surrogate = design.surrogate(); design.refine(8);
///   }
///
/// What comes out depends on the results alone, not on their order.

#include <cstddef>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "fem/surrogate/sparse_spline.hpp"
#include "fem/surrogate/tensor.hpp"

namespace brachium::fem {

class Design {
 public:
  virtual ~Design() = default;
  /// States without a result, by increasing angle, then activation.
  virtual std::vector<StatePoint> wanted() const = 0;
  /// Results of some states. Throws InputError("not-a-grid") for one that the design cannot use.
  virtual void feed(const SampleSet& results) = 0;
  /// A state has no result. A sparse grid goes on without it and asks for nothing below it; a full grid
  /// cannot.
  virtual void fail(const StatePoint& state, const std::string& reason) = 0;
  /// Throws InputError("states-missing") while wanted() is not empty, and with a full grid for a failed
  /// state.
  virtual Surrogate surrogate() const = 0;
  /// Asks for about `states` more where they promise most, at least for one; returns how many it asks for, 0
  /// where the finest level is reached everywhere.
  virtual std::size_t refine(std::size_t states) = 0;
  virtual std::size_t size() const = 0;  ///< states with a result
};

/// A sparse grid, refined by hierarchical surplus: a child of point p in direction d promises |c_p| min(1,
/// |c_p| / |c_q|), q the parent of p in d, outputs relative to their range. A child with a parent in both
/// directions promises the geometric mean of both.
struct SparseDesignOptions {
  SparseBoundary boundary = SparseBoundary::included;
  int start_level = 2;
  int finest_level = 6;  ///< of each direction
};
std::unique_ptr<Design> sparse_design(const StateBounds& bounds, std::vector<std::string> outputs,
                                      const SparseDesignOptions& options = {});

/// A full grid, refined by whole lines of angles or activations: in the middle of the cells where the
/// surrogate and the one of the next lower degree differ most, per state that the line costs.
struct GridDesignOptions {
  std::size_t theta_states = 5, activation_states = 3;
  bool hermite = true;  ///< needs both derivatives of every state
  HermiteOptions hermite_options = {};
  TensorOptions tensor_options = {};
  double finest = 1.0 / 64.0;  ///< no cell is divided below this share of the range
};
std::unique_ptr<Design> grid_design(const StateBounds& bounds, std::vector<std::string> outputs,
                                    const GridDesignOptions& options = {});

}  // namespace brachium::fem
