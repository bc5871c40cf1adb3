#pragma once
/// Cells of one region in groups of four, with what the kernel reads that does not change; and colours:
/// batches of one colour share no node, so that they may be summed at the same time, and colour after colour
/// in a fixed order.

#include <array>
#include <vector>

#include "fem/assembly/batch.hpp"
#include "fem/assembly/discretisation.hpp"
#include "fem/fibre/field.hpp"

namespace brachium::fem {

struct Batches {
  std::vector<std::array<int, lanes>> cell;  ///< lanes beyond `count` repeat the last cell
  std::vector<int> count;                    ///< cells in use, 1 to 4
  std::vector<int> region;
  std::vector<std::vector<std::size_t>> colours;

  std::size_t size() const { return cell.size(); }
  /// Sizes and constant fields of a batch.
  KernelInput input(std::size_t batch) const;

  int nodes = 0, padded_nodes = 0, points = 0, pressures = 0;
  bool shared_pressure_shape = false;  ///< continuous: the same in every cell
  std::vector<LaneBlock> gradient, weight, fibre, muscle, soft_tissue, pressure_shape, mass_inverse;
};

/// `fibrous`: by region, whether its law has fibres; elsewhere the fibre field is not looked at. Throws
/// InputError("fibre-field-size") where the tissue field does not fit the mesh, ("zero-fibre") or
/// ("blending-range") naming cell and point where a value is not admissible.
Batches make_batches(const Discretisation& discretisation, const TissueField& tissue,
                     const std::vector<bool>& fibrous);

}  // namespace brachium::fem
