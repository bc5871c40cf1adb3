#pragma once
/// Memory of one thread's element loop.

#include <vector>

#include "fem/assembly/batch.hpp"
#include "fem/assembly/discretisation.hpp"

namespace brachium::fem {

struct Workspace {
  explicit Workspace(const Discretisation& d) {
    const auto nodes = static_cast<std::size_t>(d.nodes_per_cell()), padded = (nodes + 3) / 4 * 4;
    const auto pressures = static_cast<std::size_t>(d.pressures_per_cell());
    displacement.resize(3 * padded);
    displacement_before.resize(3 * padded);
    pressure.resize(pressures);
    force.resize(3 * padded);
    constraint.resize(pressures);
    cell_pressure.resize(pressures);
    tangent.resize(9 * nodes * (nodes + 1) / 2);
    coupling.resize(3 * pressures * nodes);
    constraint_mass.resize(pressures * pressures);
    KernelInput sizes;
    sizes.points = d.quadrature().size();
    sizes.pressures = d.pressures_per_cell();
    sizes.padded_nodes = static_cast<int>(padded);
    scratch.resize(kernel_scratch_size(sizes));
  }

  KernelOutput output(bool with_tangent, bool with_pressures) {
    KernelOutput out;
    out.force = force.data();
    out.constraint = constraint.data();
    out.cell_pressure = cell_pressure.data();
    out.scratch = scratch.data();
    if (with_tangent) out.tangent = tangent.data();
    if (with_tangent && with_pressures) {
      out.coupling = coupling.data();
      out.constraint_mass = constraint_mass.data();
    }
    return out;
  }

  std::vector<LaneBlock> displacement, displacement_before, pressure;
  std::vector<LaneBlock> force, constraint, cell_pressure, tangent, coupling, constraint_mass, scratch;
};

}  // namespace brachium::fem
