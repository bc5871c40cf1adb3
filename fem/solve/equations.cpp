#include "fem/solve/equations.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "fem/linear/stopwatch.hpp"

namespace brachium::fem {
namespace {

constexpr double penalty_over_stiffness = 100.0;

MaterialPoint<double> stretched(double stretch, double activation, double muscle) {
  MaterialPoint<double> point{};
  point.C[0] = stretch * stretch;
  point.C[1] = point.C[2] = 1.0 / stretch;
  point.fibre[0] = 1.0;
  point.activation = activation;
  point.muscle = muscle;
  point.stretch_before = stretch;
  return point;
}

}  // namespace

double stiffness_scale(const Problem& problem) {
  double scale = 0.0;
  MaterialResponse<double> rest{}, passive{}, active{};
  for (const RegionMaterial& region : problem.materials) {
    for (const double muscle : {1.0, 0.0}) {
      if (muscle == 0.0 && (problem.tissue.muscle.size() == 0 || problem.tissue.muscle.minCoeff() > 0.0))
        continue;
      evaluate(region.material, stretched(1.0, 0.0, muscle), rest);
      for (const double c : rest.CC) scale = std::max(scale, std::abs(c));
      for (const double stretch : {0.8, 1.0, 1.2, 1.4}) {
        evaluate(region.material, stretched(stretch, 0.0, muscle), passive);
        evaluate(region.material, stretched(stretch, 1.0, muscle), active);
        scale = std::max(scale, 10.0 * std::abs(active.S[0] - passive.S[0]));
      }
    }
  }
  return scale;
}

Equations::Equations(const Problem& problem, const SolveOptions& options)
    : problem_(&problem),
      discretisation_(std::make_shared<Discretisation>(problem.mesh, problem.formulation)) {
  stiffness_pa_ = stiffness_scale(problem);
  const PressureSpace space = pressure_space(problem.formulation);
  condensed_ = space == PressureSpace::constant || space == PressureSpace::linear_discontinuous;
  for (const RegionMaterial& region : problem.materials) {
    if (condensed_ && std::isinf(region.volumetric.bulk_modulus_pa)) {
      penalty_pa_ = options.penalty_pa > 0.0 ? options.penalty_pa : penalty_over_stiffness * stiffness_pa_;
    }
    if (space != PressureSpace::continuous && std::isfinite(region.volumetric.bulk_modulus_pa)) {
      stiffest_pa_ = std::max(stiffest_pa_, region.volumetric.bulk_modulus_pa);
    }
    rate_dependent_ = rate_dependent_ || is_rate_dependent(region.material);
  }
  stiffest_pa_ = std::max({stiffest_pa_, penalty_pa_, stiffness_pa_});
  volume_ = discretisation_->volume();
  cell_size_m_ = std::cbrt(volume_ / discretisation_->cell_count());
  assembly_ = std::make_unique<Assembly>(discretisation_, problem.materials, problem.tissue, penalty_pa_,
                                         options.threads);
  loads_ = std::make_unique<Loads>(problem, *discretisation_, stiffness_pa_, cell_size_m_);
}

bool Equations::constrain(const std::vector<std::string>& released) {
  auto next = std::make_unique<Constraints>(*problem_, discretisation_->node_count(),
                                            discretisation_->dof_count(), released);
  const bool same = constraints_ && next->held() == constraints_->held() &&
                    next->frames().cols() == constraints_->frames().cols() &&
                    next->frames() == constraints_->frames();
  constraints_ = std::move(next);
  if (same) return false;
  unknowns_ = number_unknowns(*discretisation_, constraints_->held(), constraints_->frames());
  displacement_unknowns_ = std::count_if(unknowns_.dof_of_unknown.begin(), unknowns_.dof_of_unknown.end(),
                                         [this](int dof) { return dof < 3 * discretisation_->node_count(); });
  unsymmetric_ = loads_->has_pressure() && find_unsymmetry();
  return true;
}

void Equations::add(const Eigen::VectorXd& increment, double scale, Eigen::VectorXd& dofs) const {
  dofs += scale * unknowns_.extend(increment);
}

double Equations::displacement_norm(const Eigen::VectorXd& by_unknown) const {
  return by_unknown.head(displacement_unknowns_).norm();
}

void Equations::finish(Evaluation& e, const Configuration& configuration, const LoadPoint& load) const {
  if (e.sums.failure) return;
  e.external = loads_->force(load.amplitude, configuration);
  if (released_force_.size() > 0) e.external += load.released * released_force_;
  e.residual = unknowns_.restrict(e.internal - e.external);
  const Eigen::Index displacements = 3 * static_cast<Eigen::Index>(discretisation_->node_count());
  const double area =
      cell_size_m_ * cell_size_m_ * std::sqrt(static_cast<double>(discretisation_->cell_count()));
  const double floor = 1e-6 * stiffness_pa_ * area;
  e.reference = std::max({e.internal.head(displacements).norm(), e.external.head(displacements).norm(),
                          1e-3 * e.sums.cell_force_norm, floor});
  e.residual_norm = displacement_norm(e.residual);
  e.relative = e.residual_norm / e.reference;
  e.rounding = 50.0 * std::numeric_limits<double>::epsilon() * stiffest_pa_ * area / e.reference;
  if (saddle_point()) {
    const Eigen::Index n = discretisation_->pressure_node_count();
    e.relative =
        std::max(e.relative, e.internal.tail(n).norm() * std::sqrt(static_cast<double>(n)) / volume_);
  }
  if (!std::isfinite(e.relative))
    e.sums.failure = AssemblyFailure{e.sums.smallest_jacobian_cell, e.sums.smallest_jacobian};
}

Eigen::MatrixXd Equations::volumetric_pressure(const Configuration& configuration) {
  const Stopwatch watch;
  Configuration bare = configuration;
  bare.multiplier.resize(0, 0);
  Eigen::MatrixXd pressure = assembly_->pressures(bare);
  ++pressure_evaluations;
  seconds += watch.seconds();
  return pressure;
}

Eigen::VectorXd Equations::internal_force(const Configuration& configuration) {
  const Stopwatch watch;
  Eigen::VectorXd force;
  assembly_->residual(configuration, force);
  ++residual_evaluations;
  seconds += watch.seconds();
  return force;
}

Evaluation Equations::evaluate(Configuration& configuration, const LoadPoint& load) {
  const Stopwatch watch;
  Evaluation e;
  configuration.activation = load.activation;
  e.sums = assembly_->residual(configuration, e.internal);
  ++residual_evaluations;
  finish(e, configuration, load);
  seconds += watch.seconds();
  return e;
}

Evaluation Equations::linearise(Configuration& configuration, const LoadPoint& load, TangentValues& tangent) {
  const Stopwatch watch;
  Evaluation e;
  configuration.activation = load.activation;
  e.sums = assembly_->tangent(configuration, unknowns_, e.internal, tangent.lower);
  ++tangent_evaluations;
  finish(e, configuration, load);
  tangent.loads = loads_->tangent(load.amplitude, configuration);
  seconds += watch.seconds();
  return e;
}

/// Asymmetry of the pressures' tangent over the free components, at rest and in a state without symmetry.
bool Equations::find_unsymmetry() const {
  const Eigen::VectorXd full = Eigen::VectorXd::Ones(static_cast<Eigen::Index>(problem_->conditions.size()));
  const int n = discretisation_->node_count();
  for (const double bend : {0.0, 0.1}) {
    Eigen::VectorXd dofs = Eigen::VectorXd::Zero(discretisation_->dof_count());
    for (int a = 0; a < discretisation_->mesh().point_count(); ++a) {
      for (int i = 0; i < 3; ++i) dofs[3 * a + i] = bend * cell_size_m_ * std::sin(1.0 + 1.7 * a + 2.3 * i);
    }
    Eigen::VectorXd amplitude = Eigen::VectorXd::Zero(full.size());
    constraints_->impose(amplitude, dofs);
    // One pressure may hide in another's asymmetry only by accident: all act at once.
    Eigen::VectorXd probe = Eigen::VectorXd::Zero(3 * n), other = probe;
    for (Eigen::Index k = 0; k < probe.size(); ++k) {
      probe[k] = std::sin(0.7 + 1.3 * static_cast<double>(k));
      other[k] = std::cos(0.2 + 2.9 * static_cast<double>(k));
    }
    const auto free_part = [&](Eigen::VectorXd& v) {
      Eigen::VectorXd by_dof = Eigen::VectorXd::Zero(discretisation_->dof_count());
      by_dof.head(v.size()) = v;
      v = unknowns_.extend(unknowns_.restrict(by_dof)).head(v.size());
    };
    free_part(probe);
    free_part(other);
    Configuration here;
    here.dofs = dofs;
    double one = 0.0, two = 0.0, size = 0.0;
    for (const FaceTangent& face : loads_->tangent(full, here)) {
      const auto m = static_cast<Eigen::Index>(face.nodes.size());
      Eigen::VectorXd p(3 * m), o(3 * m);
      for (Eigen::Index a = 0; a < m; ++a) {
        p.segment<3>(3 * a) = probe.segment<3>(3 * face.nodes[static_cast<std::size_t>(a)]);
        o.segment<3>(3 * a) = other.segment<3>(3 * face.nodes[static_cast<std::size_t>(a)]);
      }
      one += p.dot(face.values * o);
      two += o.dot(face.values * p);
      size += face.values.norm() * p.norm() * o.norm();
    }
    if (std::abs(one - two) > 1e-11 * size) return true;
  }
  return false;
}

}  // namespace brachium::fem
