#include "hill/joint_model.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "data/model/error.hpp"
#include "hill/equilibrium.hpp"

namespace brachium::hill {
namespace {

// Force of one muscle at one instant, and its derivatives by L, L' and a.
struct Instant {
  double F = 0.0, F_L = 0.0, F_rate = 0.0, F_a = 0.0;
};

template <class Set>
Instant rigid(const Set& set, const ElementConstants& c, double L, double rate, double a) {
  const double z = L - c.ls;
  if (!(z > c.z_min)) return {};
  const Projected q = project(set, c, z, c.with_velocity ? rate : 0.0, a);
  if (q.Q < 0.0) return {};
  return {c.S * q.Q, c.S * q.Q_z, c.S * q.Q_w, c.S * q.Q_a};
}

// Static: v~ = 0. F = S f_t(L - z), and with k = f_t'/l_s: dz/dL = k/(k + Q_z), dF/dL = S k Q_z/(k + Q_z),
// dF/da = S k Q_a/(k + Q_z).
template <class Set>
Instant elastic(const Set& set, ElementConstants c, double L, double a, const std::string& muscle) {
  c.with_velocity = false;
  const EquilibriumSolver<Set> solver(set, c);
  const Equilibrium e = solver.solve({L, a, 0.0, 0.0}, -1.0);
  if (e.kind == Equilibrium::Kind::slack) return {};
  if (e.kind == Equilibrium::Kind::unconverged) {
    data::ConvergenceFailure::Details d;
    d.where = fmt::format("muscle `{}` at length {:.6g} m and activation {:.6g}", muscle, L, a);
    d.reason = "the elastic equilibrium was not bracketed tightly enough";
    d.iterations = e.evaluations;
    d.worst = muscle;
    throw data::ConvergenceFailure(d);
  }
  const Projected q = project(set, c, e.z, 0.0, a);
  if (e.kind == Equilibrium::Kind::untaut || e.tendon < 0.0)
    return {0.0, 0.0, 0.0, q.Q < 0.0 ? 0.0 : c.S * q.Q_a};
  const double k = taut_tendon(set, (L - e.z) / c.ls - 1.0).slope / c.ls;
  const double series = k / (k + q.Q_z);
  return {c.S * e.tendon, c.S * series * q.Q_z, 0.0, c.S * series * q.Q_a};
}

Instant instant(const MuscleTendon& muscle, double L, double rate, double a) {
  const ElementConstants c(muscle);
  return std::visit(
      [&](const auto& set) {
        return muscle.options().tendon == TendonKind::rigid ? rigid(set, c, L, rate, a)
                                                            : elastic(set, c, L, a, muscle.name());
      },
      muscle.options().curves.variant());
}

void check_size(const char* what, Eigen::Index got, std::size_t expected) {
  if (static_cast<std::size_t>(got) == expected) return;
  throw data::InputError("size-mismatch",
                         fmt::format("`{}` has {} entries, the model {}", what, got, expected));
}

}  // namespace

JointModel::JointModel(std::string coordinate, std::vector<JointMuscle> muscles)
    : coordinates_{std::move(coordinate)}, joint_muscles_(std::move(muscles)) {
  std::vector<data::Diagnostic> mistakes;
  const auto mistake = [&mistakes](std::string code, std::string message, std::string help) {
    mistakes.push_back(
        {data::Severity::error, std::move(code), std::move(message), std::nullopt, std::move(help)});
  };
  if (joint_muscles_.empty())
    mistake("no-muscles", fmt::format("no muscle acts on `{}`", coordinates_[0]), "");
  for (const JointMuscle& m : joint_muscles_) {
    const std::string& name = m.muscle.name();
    if (std::find(names_.begin(), names_.end(), name) != names_.end()) {
      mistake("duplicate-muscle", fmt::format("muscle `{}` is given twice", name), "");
    }
    if (m.path.coordinate() != coordinates_[0]) {
      mistake("wrong-coordinate",
              fmt::format("the path of muscle `{}` depends on `{}`, the joint is `{}`", name,
                          m.path.coordinate(), coordinates_[0]),
              "");
    }
    if (m.muscle.options().tendon != joint_muscles_[0].muscle.options().tendon) {
      mistake("mixed-tendons",
              fmt::format("muscle `{}` has another kind of tendon than muscle `{}`", name,
                          joint_muscles_[0].muscle.name()),
              "all muscles of one joint model are on the same rung, rigid or elastic");
    }
    if (m.muscle.options().compatibility != Compatibility::none) {
      mistake("no-joint-compatibility", fmt::format("muscle `{}` asks for the conventions of CEINMS", name),
              "they need a whole trial: use the batch chain, or compatibility `none`");
    }
    names_.push_back(name);
  }
  if (!mistakes.empty()) throw data::InputError(mistakes);
  const bool is_rigid = joint_muscles_[0].muscle.options().tendon == TendonKind::rigid;
  traits_.rung = is_rigid ? "hill.rigid" : "hill.elastic";
  traits_.uses_qdot = is_rigid;
  traits_.gives_dmoment_dq = true;
  traits_.gives_dmoment_dactivation = true;
}

// L' = -r q', so that with r' = dr/dq:
//   dF/dq = -r F_L - r' q' F_rate,  dM/dq = sum r' F + r dF/dq,  dM/da = r F_a
void JointModel::evaluate(const Eigen::VectorXd& q, const Eigen::VectorXd& qdot,
                          const Eigen::VectorXd& activation, const Eigen::VectorXd& state,
                          limb::Evaluation& out) const {
  const std::size_t n = joint_muscles_.size();
  check_size("q", q.size(), 1);
  if (traits_.uses_qdot || qdot.size() != 0) check_size("qdot", qdot.size(), 1);
  check_size("activation", activation.size(), n);
  check_size("state", state.size(), 0);
  const double rate = traits_.uses_qdot ? qdot[0] : 0.0;
  if (!std::isfinite(rate))
    throw data::InputError("not-finite", fmt::format("the velocity of `{}` is {}", coordinates_[0], rate));
  const auto m = static_cast<Eigen::Index>(n);
  out.force.resize(m);
  out.moment_arm.resize(1, m);
  out.moment.setZero(1);
  out.dmoment_dq.setZero(1, 1);
  out.dmoment_dactivation.resize(1, m);
  out.state_rate.resize(0);
  out.error_bound.resize(0);
  for (Eigen::Index i = 0; i < m; ++i) {
    const JointMuscle& joint = joint_muscles_[static_cast<std::size_t>(i)];
    const double a = activation[i];
    if (!(a >= 0.0 && a <= 1.0)) {
      throw data::InputError("activation-range",
                             fmt::format("the activation of muscle `{}` is {}", joint.muscle.name(), a),
                             "it must lie in [0, 1]");
    }
    const limb::MusclePath::Value path = joint.path(q[0]);
    const double r = path.moment_arm_m, slope = path.dmoment_arm_dq_m;
    const Instant f = instant(joint.muscle, path.length_m, -r * rate, a);
    out.force[i] = f.F;
    out.moment_arm(0, i) = r;
    out.moment[0] += r * f.F;
    out.dmoment_dq(0, 0) += slope * f.F - r * (r * f.F_L + slope * rate * f.F_rate);
    out.dmoment_dactivation(0, i) = r * f.F_a;
  }
}

}  // namespace brachium::hill
