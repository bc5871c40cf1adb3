#pragma once
/// What the verification problems share: named formulations, tissues, a solve that keeps its last state,
/// closed forms.

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "fem/quantities/quantities.hpp"
#include "fem/solve/problem.hpp"
#include "fem/solve/solve.hpp"
#include "tests/fem/verification/box_mesh.hpp"

namespace brachium::fem::verification {

constexpr double incompressible = std::numeric_limits<double>::infinity();

/// A solve's outcome with all that quantities are read from.
struct Solved {
  std::shared_ptr<const Discretisation> discretisation;
  Summary summary;
  Configuration configuration;
  Eigen::VectorXd internal, external;  ///< forces by dof, global axes [N]

  /// Force that the support of a surface exerts on the body [N]: the reaction, positive in tension at x1.
  Eigen::Vector3d reaction(const std::string& surface) const;
  double energy() const { return summary.steps.back().energy; }
};

/// Solves and keeps the last accepted state. A solve that does not complete fails the test with its reason,
/// unless `may_fail`.
Solved run(const Problem& problem, const SolveOptions& options, bool may_fail = false);

/// Tolerances near rounding, states reported but not relaxed when unstable. Where a penalty stands in for
/// exact incompressibility, rounding of the volume times the penalty is what limits the residual.
SolveOptions tight(const Problem& problem);

/// One fibre direction for all quadrature points, gamma_M = 1.
TissueField uniform_fibres(const data::Mesh& mesh, Formulation formulation, const Eigen::Vector3d& direction);

/// gamma_M from the region: 1 in those named muscle, 0 in the others.
void set_muscle_by_region(TissueField& tissue, const data::Mesh& mesh, Formulation formulation,
                          const std::string& muscle);

/// Names of tests: letters and digits only.
std::string named_by_formulation(const testing::TestParamInfo<Formulation>& info);

/// Formulations that carry a pressure, and those without.
std::vector<Formulation> mixed_formulations();
std::vector<Formulation> all_formulations();

/// The clamped block's parameters (c1 3.56 kPa, optimum 1.2), nominal active stress; c3 as given there.
MuscleTendon block_muscle();
/// The thesis' muscle and tendon, optimum 1.4 (KerMor; Günther et al. 2007 for the active flanks).
MuscleTendon thesis_muscle_tendon();

/// Active force-length multiplier, written again from the theory.
double force_length(const ForceLength& law, double stretch);
/// Nominal stress [Pa] of incompressible uniaxial stretch along the fibre:
///   2 (l - l^-2)(c1 + c2/l) + c3/l (l^c4 - 1) [l >= 1] + alpha sigma_max f_l(l)
double uniaxial_stress(const MuscleTendon& law, double stretch, double activation);

/// A condition by name, and a phase that moves everything given to its value.
BoundaryCondition condition(const std::string& name, const std::string& surface,
                            decltype(BoundaryCondition::kind) kind);
Phase phase(const std::string& name, std::map<std::string, double> amplitude,
            std::map<std::string, double> activation = {}, int steps = 1);

}  // namespace brachium::fem::verification
