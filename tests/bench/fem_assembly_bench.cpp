/// CPU time of the element loops: residual, tangent (with the sum into the global matrix) and the kernel
/// alone, on the clamped block of 24 x 6 x 6 hexahedra with 27 nodes.  fem_assembly_bench [threads] [nx ny
/// nz]

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <ctime>
#include <vector>

#include "fem/assembly/assembly.hpp"
#include "fem/mesh/block.hpp"

namespace {

using namespace brachium;

template <class F>
double best_cpu_seconds(const F& f) {
  double best = 1e300;
  for (int repeat = 0; repeat < 15; ++repeat) {
    const std::clock_t start = std::clock();
    f();
    best = std::min(best, static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC);
  }
  return best;
}

}  // namespace

int main(int argc, char** argv) {
  const std::size_t threads = argc > 1 ? static_cast<std::size_t>(std::atoi(argv[1])) : 1;
  const int nx = argc > 4 ? std::atoi(argv[2]) : 24, ny = argc > 4 ? std::atoi(argv[3]) : 6,
            nz = argc > 4 ? std::atoi(argv[4]) : 6;
  fem::MuscleTendon muscle;
  muscle.muscle = {3560.0, 3860.0, 0.0357, 42.6};
  muscle.tendon = muscle.muscle;
  muscle.max_stress_pa = 0.3e6;
  muscle.force_length = {1.2, 0.25, 3.0, 0.15, 4.0};
  const auto mesh =
      std::make_shared<const data::Mesh>(fem::block(Eigen::Vector3d(0.04, 0.01, 0.01), nx, ny, nz));
  const auto d = std::make_shared<const fem::Discretisation>(mesh, fem::Formulation::q2_p1_discontinuous);
  fem::TissueField tissue;
  tissue.fibre = Eigen::Vector3d::UnitX().replicate(
      1, static_cast<Eigen::Index>(d->cell_count()) * d->quadrature().size());
  const fem::Assembly assembly(d, {{muscle, {fem::VolumetricLaw::quadratic, 1e8}}}, tissue, 0.0, threads);
  fem::Configuration state;
  state.dofs = Eigen::VectorXd::Zero(d->dof_count());
  for (int n = 0; n < d->node_count(); ++n) state.dofs[3 * n] = 0.1 * mesh->points(0, n);
  state.activation = Eigen::VectorXd::Constant(1, 0.5);
  const fem::Unknowns unknowns =
      fem::number_unknowns(*d, std::vector<char>(static_cast<std::size_t>(d->dof_count()), 0), {});
  Eigen::VectorXd force;
  std::vector<double> values;
  const double residual_s = best_cpu_seconds([&] { assembly.residual(state, force); });
  const double tangent_s = best_cpu_seconds([&] { assembly.tangent(state, unknowns, force, values); });
  // Additions and multiplications of the tangent's inner products alone: per point and pair of nodes 27
  // multiply-adds, half the pairs, and 81 multiply-adds per point and node.
  const double flops = d->cell_count() * 27.0 * 2.0 * (27.0 * 28.0 / 2.0 * 27.0 + 27.0 * 81.0);
  fmt::print("{} cells, {} dofs, {} threads, kernel {}\n", d->cell_count(), d->dof_count(), threads,
             assembly.kernel());
  fmt::print("residual            {:8.2f} ms  {:7.2f} us a cell\n", 1e3 * residual_s,
             1e6 * residual_s / d->cell_count());
  fmt::print("residual + tangent  {:8.2f} ms  {:7.2f} us a cell  {:.1f} GFlop/s\n", 1e3 * tangent_s,
             1e6 * tangent_s / d->cell_count(), 1e-9 * flops / tangent_s);
}
