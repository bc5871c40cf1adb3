#include "fem/quantities/point_fields.hpp"

#include "fem/quantities/cell_state.hpp"

namespace brachium::fem {

PointFields point_fields(const Problem& problem, const Discretisation& discretisation,
                         const Configuration& configuration) {
  const CellStates states(problem, discretisation, configuration);
  const int n_q = discretisation.quadrature().size();
  const Eigen::Index n = static_cast<Eigen::Index>(n_q) * discretisation.cell_count();
  PointFields fields;
  for (Eigen::VectorXd* field : {&fields.fibre_stretch, &fields.jacobian, &fields.pressure_pa,
                                 &fields.fibre_stress_pa, &fields.active_stress_pa, &fields.von_mises_pa}) {
    field->resize(n);
  }
  fields.cauchy_pa.resize(6, n);
  fields.fibre.resize(3, n);
  for (int cell = 0; cell < discretisation.cell_count(); ++cell) {
    for (int q = 0; q < n_q; ++q) {
      const Eigen::Index i = q + static_cast<Eigen::Index>(n_q) * cell;
      const CellState state = states.at_quadrature(cell, q);
      const Eigen::Matrix3d& s = state.cauchy_pa;
      fields.fibre_stretch[i] = state.fibre_stretch;
      fields.jacobian[i] = state.jacobian;
      fields.pressure_pa[i] = pressure_of(s);
      fields.fibre_stress_pa[i] = state.fibre_stress_pa;
      fields.active_stress_pa[i] = state.active_stress_pa;
      fields.von_mises_pa[i] = von_mises_of(s);
      fields.cauchy_pa.col(i) << s(0, 0), s(1, 1), s(2, 2), s(0, 1), s(1, 2), s(0, 2);
      fields.fibre.col(i) = state.fibre_now;
    }
  }
  return fields;
}

}  // namespace brachium::fem
