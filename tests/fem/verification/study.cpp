#include "tests/fem/verification/study.hpp"

#include <algorithm>
#include <cmath>

namespace brachium::fem::verification {

Eigen::Vector3d Solved::reaction(const std::string& surface) const {
  return -wrench(*discretisation, configuration, internal, external, surface, Eigen::Vector3d::Zero())
              .force_n;
}

Solved run(const Problem& problem, const SolveOptions& options, bool may_fail) {
  Solved solved;
  solved.discretisation = std::make_shared<Discretisation>(problem.mesh, problem.formulation);
  solved.summary = solve(problem, options, [&](const AcceptedState& accepted) {
    solved.configuration = accepted.state.configuration;
    solved.internal = accepted.internal_force;
    solved.external = accepted.external_force;
  });
  if (!may_fail) {
    EXPECT_TRUE(solved.summary.completed) << to_string(problem.formulation) << ": " << solved.summary.reason;
  }
  return solved;
}

SolveOptions tight(const Problem& problem) {
  const PressureSpace space = pressure_space(problem.formulation);
  const bool penalty =
      (space == PressureSpace::constant || space == PressureSpace::linear_discontinuous) &&
      std::any_of(problem.materials.begin(), problem.materials.end(),
                  [](const RegionMaterial& m) { return std::isinf(m.volumetric.bulk_modulus_pa); });
  SolveOptions options;
  options.relative_residual = penalty ? 1e-10 : 1e-11;
  options.relative_step = 1e-9;
  options.volume_tolerance = 1e-11;
  options.on_instability = "report";
  options.threads = 1;
  return options;
}

TissueField uniform_fibres(const data::Mesh& mesh, Formulation formulation,
                           const Eigen::Vector3d& direction) {
  const Eigen::Index points =
      static_cast<Eigen::Index>(cell_quadrature(formulation).size()) * mesh.cell_count();
  TissueField tissue;
  tissue.fibre = direction.normalized().replicate(1, points);
  return tissue;
}

void set_muscle_by_region(TissueField& tissue, const data::Mesh& mesh, Formulation formulation,
                          const std::string& muscle) {
  const int n_q = cell_quadrature(formulation).size();
  const int region = mesh.region(muscle);
  tissue.muscle.resize(static_cast<Eigen::Index>(n_q) * mesh.cell_count());
  for (int c = 0; c < mesh.cell_count(); ++c) {
    tissue.muscle.segment(static_cast<Eigen::Index>(n_q) * c, n_q)
        .setConstant(mesh.region_of_cell[static_cast<std::size_t>(c)] == region ? 1.0 : 0.0);
  }
}

std::string named_by_formulation(const testing::TestParamInfo<Formulation>& info) {
  std::string name = to_string(info.param);
  std::replace(name.begin(), name.end(), '_', 'X');
  return name;
}

std::vector<Formulation> mixed_formulations() {
  return {Formulation::q2_p1_discontinuous, Formulation::q2_q1_taylor_hood, Formulation::q1_p0,
          Formulation::p2_p1_taylor_hood, Formulation::p2b_p1_discontinuous};
}

std::vector<Formulation> all_formulations() {
  std::vector<Formulation> list = mixed_formulations();
  list.push_back(Formulation::q1_displacement);
  list.push_back(Formulation::q2_displacement);
  return list;
}

MuscleTendon block_muscle() {
  MuscleTendon law;
  law.muscle = {.c1_pa = 3560.0, .c2_pa = 3860.0, .c3_pa = 3.57e-2, .c4 = 42.6};
  law.tendon = law.muscle;
  law.max_stress_pa = 0.3e6;
  law.force_length = {.optimal_stretch = 1.2,
                      .ascending_width = 0.25,
                      .ascending_exponent = 3.0,
                      .descending_width = 0.15,
                      .descending_exponent = 4.0};
  return law;
}

MuscleTendon thesis_muscle_tendon() {
  MuscleTendon law;
  law.muscle = {
      .c1_pa = 3.56463903963e4, .c2_pa = 3.859558659683e3, .c3_pa = 3.05907e-4, .c4 = 47.270456264135881};
  law.tendon = {.c1_pa = 2.31e6, .c2_pa = 1.15, .c3_pa = 7.99e6, .c4 = 16.6};
  law.max_stress_pa = 0.3e6;
  law.force_length = {.optimal_stretch = 1.4,
                      .ascending_width = 0.57,
                      .ascending_exponent = 4.0,
                      .descending_width = 0.14,
                      .descending_exponent = 3.0};
  return law;
}

double force_length(const ForceLength& law, double stretch) {
  const bool ascending = stretch <= law.optimal_stretch;
  const double width = ascending ? law.ascending_width : law.descending_width;
  const double exponent = ascending ? law.ascending_exponent : law.descending_exponent;
  return std::exp(-std::pow(std::abs((stretch / law.optimal_stretch - 1.0) / width), exponent));
}

double uniaxial_stress(const MuscleTendon& law, double stretch, double activation) {
  const double l = stretch;
  const auto& [c1, c2, c3, c4] = law.muscle;
  double stress = 2.0 * (l - 1.0 / (l * l)) * (c1 + c2 / l);
  if (l >= 1.0) stress += c3 / l * (std::pow(l, c4) - 1.0);
  return stress + activation * law.max_stress_pa * force_length(law.force_length, l);
}

BoundaryCondition condition(const std::string& name, const std::string& surface,
                            decltype(BoundaryCondition::kind) kind) {
  return {name, surface, std::move(kind)};
}

Phase phase(const std::string& name, std::map<std::string, double> amplitude,
            std::map<std::string, double> activation, int steps) {
  Phase p;
  p.name = name;
  p.amplitude = std::move(amplitude);
  p.activation = std::move(activation);
  p.steps = steps;
  return p;
}

}  // namespace brachium::fem::verification
