#include "tests/fem/verification/extremes.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <chrono>
#include <functional>
#include <limits>
#include <stdexcept>

#include "fem/element/shape.hpp"
#include "tests/fem/verification/study.hpp"

namespace brachium::fem::verification {
namespace {

using Eigen::Vector3d;
constexpr double mm = 1e-3;

/// A body between two clamped ends that are drawn apart, then activated in one phase.
Problem clamped(std::shared_ptr<const data::Mesh> mesh, Formulation formulation, const MuscleTendon& law,
                double stretch, double activation) {
  Problem problem;
  problem.mesh = std::move(mesh);
  problem.formulation = formulation;
  problem.materials.assign(problem.mesh->regions.size(), {law, {VolumetricLaw::quadratic, incompressible}});
  problem.tissue = uniform_fibres(*problem.mesh, formulation, Vector3d::UnitX());
  const double length = problem.mesh->points.row(0).maxCoeff() - problem.mesh->points.row(0).minCoeff();
  problem.conditions = {
      condition("left", "x0", Fixed{}),
      condition("right", "x1", RigidMotion{.translation_m = Vector3d((stretch - 1.0) * length, 0.0, 0.0)})};
  if (stretch != 1.0) problem.programme.push_back(phase("stretch", {{"right", 1.0}}));
  if (activation > 0.0) problem.programme.push_back(phase("activate", {}, {{"body", activation}}));
  return problem;
}

/// The same with free sides: homogeneous as long as it is stable.
Problem free_sides(Formulation formulation, const MuscleTendon& law, double stretch, double activation) {
  Problem problem = clamped(
      box_mesh(
          {.type = cell_type(formulation), .cells = {2, 1, 1}, .size_m = Vector3d(20.0, 10.0, 10.0) * mm}),
      formulation, law, stretch, activation);
  PrescribedDisplacement pull;
  pull.displacement_m[0] = (stretch - 1.0) * 20.0 * mm;
  problem.conditions = {condition("left", "x0", SymmetryPlane{}), condition("y", "y0", SymmetryPlane{}),
                        condition("z", "z0", SymmetryPlane{}), condition("right", "x1", pull)};
  return problem;
}

std::shared_ptr<data::Mesh> bar(Formulation formulation) {
  return box_mesh(
      {.type = cell_type(formulation), .cells = {8, 2, 2}, .size_m = Vector3d(40.0, 10.0, 10.0) * mm});
}

Problem complex_with_stiff_tendon(Formulation formulation) {
  auto mesh = bar(formulation);
  split_region(*mesh, "tendon", [](const Vector3d& x) { return x[0] < 10.0 * mm || x[0] > 30.0 * mm; });
  MuscleTendon law = thesis_muscle_tendon();
  law.tendon = {
      .c1_pa = 1e4 * law.muscle.c1_pa, .c2_pa = 1e4 * law.muscle.c2_pa, .c3_pa = 7.99e6, .c4 = 16.6};
  Problem problem = clamped(mesh, formulation, law, 1.05, 0.5);
  set_muscle_by_region(problem.tissue, *mesh, formulation, "body");
  return problem;
}

SolveOptions ordinary() {
  SolveOptions options;
  options.threads = 1;
  options.volume_tolerance = 1e-6;
  return options;
}

}  // namespace

double jacobian_ratio(const data::Mesh& mesh) {
  double worst = 1.0;
  const Eigen::Matrix3Xd& local = node_coordinates(mesh.type);
  for (int c = 0; c < mesh.cell_count(); ++c) {
    double low = std::numeric_limits<double>::infinity(), high = -low;
    for (int corner = 0; corner < data::corners_per_cell(mesh.type); ++corner) {
      const Shape shape = cell_shape(mesh.type, local.col(corner));
      Eigen::Matrix3d jacobian = Eigen::Matrix3d::Zero();
      for (Eigen::Index a = 0; a < shape.value.size(); ++a)
        jacobian += mesh.points.col(mesh.cells(a, c)) * shape.derivative.row(a);
      low = std::min(low, jacobian.determinant());
      high = std::max(high, jacobian.determinant());
    }
    worst = std::min(worst, low / high);
  }
  return worst;
}

std::shared_ptr<data::Mesh> distorted_box(data::CellType type, double ratio) {
  const auto mesh = [type](double shift) {
    return box_mesh({.type = type,
                     .cells = {2, 2, 2},
                     .size_m = Vector3d::Constant(20.0 * mm),
                     .map = [shift](const Vector3d& x) -> Vector3d {
                       return (x - Vector3d::Constant(10.0 * mm)).norm() < mm
                                  ? Vector3d(x + Vector3d::Constant(shift))
                                  : x;
                     }});
  };
  double low = 0.0, high = 6.6 * mm;  // at a third of the cell's side beyond its middle the corner is flat
  for (int k = 0; k < 60; ++k) {
    const double middle = 0.5 * (low + high);
    (jacobian_ratio(*mesh(middle)) > ratio ? low : high) = middle;
  }
  return mesh(low);
}

namespace {

/// Rows by name, or the only one asked for: some meshes take a while to find.
std::vector<Extreme> rows_of(Formulation f, const std::string& only) {
  const MuscleTendon thesis = thesis_muscle_tendon(), block = block_muscle();
  MuscleTendon steep = thesis, strong = thesis;
  steep.muscle.c4 = 60.0;
  strong.max_stress_pa *= 10.0;
  std::vector<Extreme> rows;
  const auto add = [&](const std::string& name, const std::function<Problem()>& make) {
    if (only.empty() || only == name) rows.push_back({name, make(), ordinary()});
  };
  add("aspect ratio 50, stretch 1.1, alpha 0.5", [&] {
    return clamped(
        box_mesh({.type = cell_type(f), .cells = {4, 4, 1}, .size_m = Vector3d(40.0, 10.0, 0.2) * mm}), f,
        block, 1.1, 0.5);
  });
  for (const double ratio : {0.5, 0.2, 0.05}) {
    const bool hexahedral = data::corners_per_cell(cell_type(f)) == 8;
    if (hexahedral)
      add("Jacobian ratio " + std::to_string(ratio).substr(0, 4) + ", stretch 1.2, alpha 0.5",
          [&] { return clamped(distorted_box(cell_type(f), ratio), f, thesis, 1.2, 0.5); });
  }
  add("stretch 0.5, passive, free sides", [&] { return free_sides(f, thesis, 0.5, 0.0); });
  add("stretch 0.5, alpha 1, free sides", [&] { return free_sides(f, thesis, 0.5, 1.0); });
  add("stretch 2, passive, free sides", [&] { return free_sides(f, thesis, 2.0, 0.0); });
  add("stretch 2, alpha 1, free sides", [&] { return free_sides(f, thesis, 2.0, 1.0); });
  add("stretch 0.5, passive, clamped", [&] { return clamped(bar(f), f, thesis, 0.5, 0.0); });
  add("stretch 2, passive, clamped", [&] { return clamped(bar(f), f, thesis, 2.0, 0.0); });
  add("stretch 1.1 then alpha 0 to 1 at once", [&] { return clamped(bar(f), f, block, 1.1, 1.0); });
  add("alpha 0 to 1 at once, rest length", [&] { return clamped(bar(f), f, thesis, 1.0, 1.0); });
  add("stretch 1.2 then alpha 1: past the optimum, clamped",
      [&] { return clamped(bar(f), f, block, 1.2, 1.0); });
  add("c4 = 60, stretch 1.5, alpha 0.5", [&] { return clamped(bar(f), f, steep, 1.5, 0.5); });
  add("sigma_max x 10, stretch 1.1, alpha 1", [&] { return clamped(bar(f), f, strong, 1.1, 1.0); });
  add("tendon 1e4 times as stiff, stretch 1.05, alpha 0.5", [&] { return complex_with_stiff_tendon(f); });
  return rows;
}

}  // namespace

std::vector<Extreme> extremes(Formulation formulation) {
  return rows_of(formulation, "");
}

Extreme extreme(const std::string& name, Formulation formulation) {
  std::vector<Extreme> rows = rows_of(formulation, name);
  if (rows.size() != 1) throw std::logic_error("no extreme problem is called " + name);
  return rows.front();
}

Outcome outcome_of(const Extreme& extreme) {
  Outcome outcome;
  const auto start = std::chrono::steady_clock::now();
  try {
    const Discretisation discretisation(extreme.problem.mesh, extreme.problem.formulation);
    const Summary summary = solve(extreme.problem, extreme.options, [&](const AcceptedState& accepted) {
      outcome.force_n = -wrench(discretisation, accepted.state.configuration, accepted.internal_force,
                                accepted.external_force, "x1", Vector3d::Zero())
                             .force_n[0];
    });
    outcome.solved = summary.completed;
    outcome.reason = summary.reason;
    outcome.newton = summary.newton_iterations;
    outcome.chord = summary.chord_iterations;
    outcome.augmentations = summary.augmentations;
    outcome.relaxation = summary.relaxation_steps;
    outcome.steps = static_cast<int>(summary.steps.size());
    for (const StepRecord& step : summary.steps) {
      outcome.cut_backs += step.cut_backs;
      outcome.smallest_jacobian = std::min(outcome.smallest_jacobian, step.smallest_jacobian);
    }
    if (!summary.steps.empty()) {
      outcome.stability = summary.steps.back().stability.verdict;
      outcome.negative_modes = summary.steps.back().stability.negative_modes;
    }
  } catch (const data::InputError& e) {
    outcome.reason = "refused: " + e.diagnostics().front().code + ": " + e.diagnostics().front().message;
  } catch (const data::ConvergenceFailure& e) {
    outcome.reason = e.what();
  }
  outcome.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return outcome;
}

}  // namespace brachium::fem::verification
