#include "fem/assembly/assembly.hpp"

#include <fmt/format.h>

#include <atomic>
#include <barrier>
#include <cmath>
#include <limits>

#include "data/model/parallel.hpp"
#include "fem/assembly/batch.hpp"
#include "fem/assembly/batches.hpp"
#include "fem/assembly/workspace.hpp"

namespace brachium::fem {
namespace {

/// A batch's share of the sums over the mesh.
struct BatchSums {
  double energy = 0.0, volume = 0.0, worst_volume = 0.0, force_squared = 0.0;
  double smallest_jacobian = std::numeric_limits<double>::infinity();
  int cell = -1;  ///< of the smallest Jacobian
  bool valid = true;
};

/// One cell's tangent, from its lane, brought to the axes of its nodes and added to the values.
class TangentScatter {
 public:
  TangentScatter(const Discretisation& d, const Unknowns& unknowns, double* values)
      : d_(d), unknowns_(unknowns), values_(values) {}

  void add(int cell, int lane, const Workspace& w) const {
    const int nodes = d_.nodes_per_cell();
    const int pressures = d_.pressure_node_count() > 0 ? d_.pressures_per_cell() : 0;
    const int* to = unknowns_.scatter.data() +
                    static_cast<std::size_t>(cell) * static_cast<std::size_t>(unknowns_.entries_per_cell);
    if (has_framed_node(cell)) {
      add_rotated(cell, lane, w, to);
      return;
    }
    const int blocks = 9 * nodes * (nodes + 1) / 2;
    add_entries(w.tangent.data(), blocks, lane, to);
    add_entries(w.coupling.data(), 3 * pressures * nodes, lane, to + blocks);
    add_pressures(lane, w, pressures, to + blocks + 3 * pressures * nodes);
  }

 private:
  bool has_framed_node(int cell) const {
    if (unknowns_.framed.empty()) return false;
    for (int a = 0; a < d_.nodes_per_cell(); ++a) {
      if (unknowns_.framed[static_cast<std::size_t>(d_.nodes_of_cell()(a, cell))]) return true;
    }
    return false;
  }

  void add_entries(const LaneBlock* from, int count, int lane, const int* to) const {
    for (int e = 0; e < count; ++e) {
      if (to[e] >= 0) values_[to[e]] += from[e].lane[lane];
    }
  }

  /// K_pp = - int phi phi / k.
  void add_pressures(int lane, const Workspace& w, int pressures, const int* to) const {
    for (int m = 0; m < pressures; ++m) {
      for (int l = 0; l <= m; ++l, ++to) {
        if (*to >= 0)
          values_[*to] -= w.constraint_mass[static_cast<std::size_t>(m * pressures + l)].lane[lane];
      }
    }
  }

  void add_rotated(int cell, int lane, const Workspace& w, const int* to) const {
    const int nodes = d_.nodes_per_cell();
    const int pressures = d_.pressure_node_count() > 0 ? d_.pressures_per_cell() : 0;
    const auto axes = [&](int a) -> Eigen::Matrix3d {
      return unknowns_.frames.middleCols<3>(3 * d_.nodes_of_cell()(a, cell));
    };
    const LaneBlock* from = w.tangent.data();
    for (int a = 0; a < nodes; ++a) {
      for (int b = 0; b <= a; ++b, from += 9, to += 9) {
        Eigen::Matrix3d K;
        for (int i = 0; i < 3; ++i) {
          for (int k = 0; k < 3; ++k) K(i, k) = from[3 * i + k].lane[lane];
        }
        const Eigen::Matrix3d turned = axes(a).transpose() * K * axes(b);
        for (int i = 0; i < 3; ++i) {
          for (int k = 0; k < 3; ++k) {
            if (to[3 * i + k] >= 0) values_[to[3 * i + k]] += turned(i, k);
          }
        }
      }
    }
    from = w.coupling.data();
    for (int m = 0; m < pressures; ++m) {
      for (int b = 0; b < nodes; ++b, from += 3, to += 3) {
        const Eigen::Vector3d turned =
            axes(b).transpose() * Eigen::Vector3d(from[0].lane[lane], from[1].lane[lane], from[2].lane[lane]);
        for (int k = 0; k < 3; ++k) {
          if (to[k] >= 0) values_[to[k]] += turned[k];
        }
      }
    }
    add_pressures(lane, w, pressures, to);
  }

  const Discretisation& d_;
  const Unknowns& unknowns_;
  double* values_;
};

}  // namespace

struct Assembly::Impl {
  std::shared_ptr<const Discretisation> discretisation;
  std::vector<RegionMaterial> materials;
  TissueField tissue;
  std::vector<KernelVolume> volumes;  ///< by region
  std::size_t threads;
  Kernel kernel;
  Batches batches;

  void gather(const Configuration& c, std::size_t batch, Workspace& w) const;
  BatchSums run(const Configuration& c, std::size_t batch, Workspace& w, Wanted wanted,
                KernelOutput& out) const;
  Assembled loop(const Configuration& c, Wanted wanted, const Unknowns* unknowns, Eigen::VectorXd* force,
                 std::vector<double>* values, Eigen::MatrixXd* pressures) const;
};

void Assembly::Impl::gather(const Configuration& c, std::size_t batch, Workspace& w) const {
  const Discretisation& d = *discretisation;
  const int nodes = d.nodes_per_cell(), pressures = d.pressures_per_cell();
  const bool continuous = d.pressure_node_count() > 0;
  for (int l = 0; l < lanes; ++l) {
    const int cell = batches.cell[batch][static_cast<std::size_t>(l)];
    for (int a = 0; a < nodes; ++a) {
      const int dof = 3 * d.nodes_of_cell()(a, cell);
      for (int i = 0; i < 3; ++i) {
        w.displacement[static_cast<std::size_t>(3 * a + i)].lane[l] = c.dofs[dof + i];
        if (c.dofs_before.size() > 0)
          w.displacement_before[static_cast<std::size_t>(3 * a + i)].lane[l] = c.dofs_before[dof + i];
      }
    }
    for (int m = 0; m < pressures; ++m) {
      double value = 0.0;
      if (continuous) {
        value = c.dofs[3 * d.node_count() + d.pressure_nodes_of_cell()(m, cell)];
      } else if (c.multiplier.size() > 0) {
        value = c.multiplier(m, cell);
      }
      w.pressure[static_cast<std::size_t>(m)].lane[l] = value;
    }
  }
}

BatchSums Assembly::Impl::run(const Configuration& c, std::size_t batch, Workspace& w, Wanted wanted,
                              KernelOutput& out) const {
  const Discretisation& d = *discretisation;
  gather(c, batch, w);
  const auto region = static_cast<std::size_t>(batches.region[batch]);
  KernelInput in = batches.input(batch);
  in.displacement = w.displacement.data();
  in.displacement_before = c.dofs_before.size() > 0 ? w.displacement_before.data() : nullptr;
  in.pressure = w.pressure.data();
  in.activation = c.activation.size() > 0 ? c.activation[static_cast<Eigen::Index>(region)] : 0.0;
  in.inverse_dt = c.dofs_before.size() > 0 ? c.inverse_dt : 0.0;
  in.viscosity = c.viscosity_pa_s;
  in.material = &materials[region].material;
  in.volume = volumes[region];
  out = w.output(wanted == with_tangent, d.pressures_per_cell() > 0);
  out.with_energy = wanted == with_energy;
  kernel(in, out);

  BatchSums sums;
  for (int l = 0; l < batches.count[batch]; ++l) {
    const double jacobian = out.smallest_jacobian.lane[l];
    if (!(jacobian >= sums.smallest_jacobian)) {  // also where it is not a number
      sums.smallest_jacobian = jacobian;
      sums.cell = batches.cell[batch][static_cast<std::size_t>(l)];
    }
  }
  // The kernel stops early where any lane, padded ones included (copies of a real cell), is not admissible.
  if (!(sums.smallest_jacobian > 0.0)) {
    sums.valid = false;
    return sums;
  }
  for (int l = 0; l < batches.count[batch]; ++l) {
    sums.energy += out.energy.lane[l];
    sums.volume += out.volume.lane[l];
    sums.worst_volume = std::max(sums.worst_volume, out.worst_volume.lane[l]);
    double force = 0.0;
    for (int a = 0; a < 3 * d.nodes_per_cell(); ++a) force += out.force[a].lane[l] * out.force[a].lane[l];
    sums.force_squared += force;
    if (!std::isfinite(out.energy.lane[l]) || !std::isfinite(force)) {
      sums.valid = false;
      sums.cell = batches.cell[batch][static_cast<std::size_t>(l)];
      sums.smallest_jacobian = out.smallest_jacobian.lane[l];
    }
  }
  return sums;
}

Assembled Assembly::Impl::loop(const Configuration& c, Wanted wanted, const Unknowns* unknowns,
                               Eigen::VectorXd* force, std::vector<double>* values,
                               Eigen::MatrixXd* pressures) const {
  const Discretisation& d = *discretisation;
  const int nodes = d.nodes_per_cell(), per_cell = d.pressures_per_cell();
  const bool continuous = d.pressure_node_count() > 0;
  if (force) force->setZero(d.dof_count());
  if (values) values->assign(static_cast<std::size_t>(unknowns->pattern.entries()), 0.0);
  std::optional<TangentScatter> scatter;
  if (values) scatter.emplace(d, *unknowns, values->data());
  std::vector<BatchSums> sums(batches.size());

  const std::size_t workers =
      std::min(data::thread_count(threads), std::max<std::size_t>(1, batches.size() / 2));
  std::vector<std::atomic<std::size_t>> next(batches.colours.size());
  std::barrier barrier(static_cast<std::ptrdiff_t>(workers));
  data::parallel_for(workers, workers, [&](std::size_t) {
    Workspace workspace(d);
    KernelOutput out;
    for (std::size_t colour = 0; colour < batches.colours.size(); ++colour) {
      const std::vector<std::size_t>& list = batches.colours[colour];
      for (std::size_t i = next[colour]++; i < list.size(); i = next[colour]++) {
        const std::size_t batch = list[i];
        sums[batch] = run(c, batch, workspace, wanted, out);
        if (!sums[batch].valid) continue;
        for (int l = 0; l < batches.count[batch]; ++l) {
          const int cell = batches.cell[batch][static_cast<std::size_t>(l)];
          if (force) {
            for (int a = 0; a < nodes; ++a) {
              const int dof = 3 * d.nodes_of_cell()(a, cell);
              for (int k = 0; k < 3; ++k) (*force)[dof + k] += out.force[3 * a + k].lane[l];
            }
            for (int m = 0; continuous && m < per_cell; ++m)
              (*force)[3 * d.node_count() + d.pressure_nodes_of_cell()(m, cell)] += out.constraint[m].lane[l];
          }
          if (pressures) {
            for (int m = 0; m < per_cell; ++m) (*pressures)(m, cell) = out.cell_pressure[m].lane[l];
          }
          if (scatter) scatter->add(cell, l, workspace);
        }
      }
      barrier.arrive_and_wait();
    }
  });

  Assembled total;
  total.smallest_jacobian = std::numeric_limits<double>::infinity();
  double energy = 0.0, force_squared = 0.0;
  for (const BatchSums& s : sums) {
    if (!s.valid && !total.failure) total.failure = AssemblyFailure{s.cell, s.smallest_jacobian};
    if (!s.valid && s.smallest_jacobian < total.failure->jacobian)
      total.failure = AssemblyFailure{s.cell, s.smallest_jacobian};
    energy += s.energy;
    total.volume += s.volume;
    force_squared += s.force_squared;
    total.worst_volume = std::max(total.worst_volume, s.worst_volume);
    if (s.smallest_jacobian < total.smallest_jacobian) {
      total.smallest_jacobian = s.smallest_jacobian;
      total.smallest_jacobian_cell = s.cell;
    }
  }
  total.cell_force_norm = std::sqrt(force_squared);
  if (wanted == with_energy) total.energy = energy;
  return total;
}

Assembly::Assembly(std::shared_ptr<const Discretisation> discretisation,
                   std::vector<RegionMaterial> materials, TissueField tissue, double penalty_pa,
                   std::size_t threads)
    : impl_(std::make_unique<Impl>()) {
  const Discretisation& d = *discretisation;
  if (materials.size() != d.mesh().regions.size()) {
    throw data::InputError("missing-material",
                           fmt::format("{} materials were given for {} regions of the mesh", materials.size(),
                                       d.mesh().regions.size()),
                           "every region needs its own");
  }
  const PressureSpace space = pressure_space(d.formulation());
  std::vector<bool> fibrous;
  for (std::size_t r = 0; r < materials.size(); ++r) {
    check(materials[r].material);
    fibrous.push_back(needs_fibres(materials[r].material));
    const Volumetric& v = materials[r].volumetric;
    if (!(v.bulk_modulus_pa > 0.0)) {
      throw data::InputError(
          "parameter-range",
          fmt::format("bulk modulus of region `{}` is {} Pa", d.mesh().regions[r], v.bulk_modulus_pa),
          "it must be above 0, or infinite");
    }
    KernelVolume volume;
    volume.law = v.law;
    const bool infinite = std::isinf(v.bulk_modulus_pa);
    switch (space) {
      case PressureSpace::none:
        volume.pressure = KernelVolume::Pressure::none;
        volume.modulus = v.bulk_modulus_pa;
        if (infinite) {
          throw data::InputError(
              "incompressible-displacement",
              fmt::format("region `{}` is incompressible, element `{}` has displacements only",
                          d.mesh().regions[r], to_string(d.formulation())),
              "give a finite bulk modulus, or choose an element with a pressure");
        }
        break;
      case PressureSpace::continuous:
        volume.pressure = KernelVolume::Pressure::continuous;
        volume.inverse_modulus = infinite ? 0.0 : 1.0 / v.bulk_modulus_pa;
        if (!infinite && v.law != VolumetricLaw::quadratic) {
          throw data::InputError(
              "volumetric-law",
              fmt::format("region `{}` has a finite bulk modulus with a law that `{}` does not offer",
                          d.mesh().regions[r], to_string(d.formulation())),
              "continuous pressures take the quadratic law k/2 (J - 1)^2; choose it, a condensed element, or "
              "an infinite bulk modulus");
        }
        break;
      default:
        volume.pressure = KernelVolume::Pressure::discontinuous;
        volume.modulus = infinite ? penalty_pa : v.bulk_modulus_pa;
        if (infinite && !(penalty_pa > 0.0))
          throw data::InputError(
              "parameter-range",
              fmt::format("penalty of the augmented Lagrange iteration is {} Pa", penalty_pa),
              "it must be above 0");
    }
    impl_->volumes.push_back(volume);
  }
  impl_->batches = make_batches(d, tissue, fibrous);
  impl_->discretisation = std::move(discretisation);
  impl_->materials = std::move(materials);
  impl_->tissue = std::move(tissue);
  impl_->threads = threads;
  impl_->kernel = choose_kernel();
}

Assembly::~Assembly() = default;

const Discretisation& Assembly::discretisation() const {
  return *impl_->discretisation;
}
const std::vector<RegionMaterial>& Assembly::materials() const {
  return impl_->materials;
}
const TissueField& Assembly::tissue() const {
  return impl_->tissue;
}
std::string Assembly::kernel() const {
  return kernel_name(impl_->kernel);
}

Assembled Assembly::residual(const Configuration& configuration, Eigen::VectorXd& force, bool energy) const {
  return impl_->loop(configuration, energy ? with_energy : stress_only, nullptr, &force, nullptr, nullptr);
}

Assembled Assembly::tangent(const Configuration& configuration, const Unknowns& unknowns,
                            Eigen::VectorXd& force, std::vector<double>& values) const {
  return impl_->loop(configuration, with_tangent, &unknowns, &force, &values, nullptr);
}

Eigen::MatrixXd Assembly::pressures(const Configuration& configuration) const {
  const Discretisation& d = *impl_->discretisation;
  if (pressure_space(d.formulation()) == PressureSpace::continuous || d.pressures_per_cell() == 0) return {};
  Eigen::MatrixXd result = Eigen::MatrixXd::Zero(d.pressures_per_cell(), d.cell_count());
  impl_->loop(configuration, stress_only, nullptr, nullptr, nullptr, &result);
  return result;
}

}  // namespace brachium::fem
