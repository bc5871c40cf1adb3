/// Elastic tendon in static equilibrium, frame after frame, z_k the projected fibre length:
///   R_k = f_t((L_k - z_k)/l_s - 1) - Q(z_k, w_k, a_k) = 0,  F_k = S f_t
///   none      w = 0
///   causal    w_k = (D z)_k, D the backward difference of second order, inside the root
///   zero_lag  a first sweep as causal gives z¹; a second one solves with w_k = (D z)_k + ((C - D) z¹)_k, C
///   the
///             central difference of fourth order: one step of deferred correction (Pereyra 1966,
///             doi:10.1007/BF02162981), whose fixed point is the symmetric scheme
/// The first frame takes w_0 = L'_0: the tendon's length is at rest there.
///
/// Tangent by the implicit function theorem, with w_k = α z_k + β_k:
///   dz_k = (R_theta - Q_a da - Q_w dβ_k)/(f_t'/l_s + Q_z + α Q_w),  dF = S (f_t,theta - f_t'/l_s dz)
#include <fmt/format.h>

#include <optional>

#include "data/model/error.hpp"
#include "hill/chain.hpp"
#include "hill/equilibrium.hpp"

namespace brachium::hill {
namespace {

enum Slot : std::size_t {
  kFirst = 0,
  kSecond,
  kShift,
  kFirstTangent,
  kSecondTangent,
  kShiftTangent,
  kLinear
};

// Per frame, what the tangents need of one sweep.
struct Linear {
  double *inverse, *Q_w, *Q_a, *stiffness, *taut_a;
  std::array<double*, kParameterCount> R;  // R_theta, null where not wanted
  static constexpr std::size_t kArrays = 5 + kParameterCount;

  Linear(MuscleScratch& scratch, std::size_t base, std::size_t n, std::bitset<kParameterCount> wanted)
      : inverse(scratch.array(base, n).data()),
        Q_w(scratch.array(base + 1, n).data()),
        Q_a(scratch.array(base + 2, n).data()),
        stiffness(scratch.array(base + 3, n).data()),
        taut_a(scratch.array(base + 4, n).data()),
        R{} {
    for (std::size_t i = 0; i < kParameterCount; ++i) {
      if (wanted[i]) R[i] = scratch.array(base + 5 + i, n).data();
    }
  }
  void set(MuscleParameter p, std::size_t k, double value) const {
    if (R[index_of(p)] != nullptr) R[index_of(p)][k] = value;
  }
};
static_assert(kLinear + 2 * Linear::kArrays <= MuscleScratch::kSlots);

// dz of a frame without a root does not depend on its neighbours: z = z_min or z = L - l_s.
void linearise_without_root(const Linear& lin, std::size_t k, Equilibrium::Kind kind, double taut_a) {
  lin.inverse[k] = 1.0;
  lin.Q_w[k] = lin.Q_a[k] = lin.stiffness[k] = 0.0;
  lin.taut_a[k] = taut_a;
  for (const MuscleParameter p : kAllParameters) lin.set(p, k, 0.0);
  if (kind == Equilibrium::Kind::slack)
    lin.set(MuscleParameter::optimal_fibre_length, k, kShortestProjection);
  if (kind == Equilibrium::Kind::untaut) lin.set(MuscleParameter::tendon_slack_length, k, -1.0);
}

template <class Set>
class Chain {
 public:
  Chain(const ChainInput& in, const Set& set)
      : in_(in),
        set_(set),
        c_(in.muscle),
        solver_(set_, c_),
        difference_{in.step_s},
        start_rate_(start_rate(in)) {}

  void run() {
    const bool corrected = in_.muscle.options().velocity == FibreVelocity::zero_lag;
    const std::size_t n = in_.frames();
    double* z1 = in_.scratch.array(kFirst, n).data();
    const std::optional<Linear> first = linear(kLinear);
    sweep(z1, nullptr, nullptr, !corrected, first);
    if (!corrected) {
      for (const Tangent& t : in_.tangents) differentiate(t, *first);
      return;
    }
    double* shift = in_.scratch.array(kShift, n).data();
    defect(z1, shift);
    const std::optional<Linear> second = linear(kLinear + Linear::kArrays);
    sweep(in_.scratch.array(kSecond, n).data(), z1, shift, true, second);
    for (const Tangent& t : in_.tangents) differentiate_corrected(t, *first, *second);
  }

 private:
  // Only tangents need it: an hour's trial is long.
  std::optional<Linear> linear(std::size_t base) const {
    if (in_.tangents.empty()) return std::nullopt;
    return Linear(in_.scratch, base, in_.frames(), in_.wanted());
  }

  // w_0 = L'_0: as given, else by differences; a causal chain does not know it and starts from rest.
  static double start_rate(const ChainInput& in) {
    if (in.muscle.options().velocity == FibreVelocity::none) return 0.0;
    if (!in.V.empty()) return in.V[0];
    if (in.muscle.options().velocity == FibreVelocity::causal) return 0.0;
    const std::span<const double> L = in.L;
    return (-25.0 * L[0] + 48.0 * L[1] - 36.0 * L[2] + 16.0 * L[3] - 3.0 * L[4]) / (12.0 * in.step_s);
  }

  // (C - D) z for k >= 1.
  void defect(const double* z, double* shift) const {
    const std::size_t n = in_.frames();
    central_differences({z, n}, in_.step_s, {shift, n});
    shift[0] = 0.0;
    for (std::size_t k = 1; k < n; ++k) shift[k] -= difference_.alpha(k) * z[k] + difference_.beta(k, z);
  }

  double guess(std::size_t k, const double* z, const double* known) const {
    if (known != nullptr) {
      if (k < 2) return known[k];
      return known[k] + 2.0 * (z[k - 1] - known[k - 1]) - (z[k - 2] - known[k - 2]);
    }
    if (k == 0) return -1.0;
    if (k == 1) return z[0] + (in_.L[1] - in_.L[0]);
    if (k == 2) return 2.0 * z[1] - z[0];
    return 3.0 * (z[k - 1] - z[k - 2]) + z[k - 3];
  }

  void sweep(double* z, const double* known, const double* shift, bool last,
             const std::optional<Linear>& lin) {
    const std::size_t n = in_.frames();
    for (std::size_t k = 0; k < n; ++k) {
      EquilibriumProblem p{in_.L[k], in_.a[k], 0.0, 0.0};
      if (c_.with_velocity) {
        p.alpha = k == 0 ? 0.0 : difference_.alpha(k);
        p.beta = k == 0 ? start_rate_ : difference_.beta(k, z) + (shift != nullptr ? shift[k] : 0.0);
      }
      const Equilibrium e = solver_.solve(p, guess(k, z, known));
      if (e.kind == Equilibrium::Kind::unconverged) fail(k, e);
      z[k] = e.z;
      if (!last && !lin) continue;
      if (e.kind == Equilibrium::Kind::slack) {
        if (last) record_slack(in_.out, k, c_);
        if (lin) linearise_without_root(*lin, k, e.kind, 0.0);
        continue;
      }
      const double w = p.alpha * e.z + p.beta;
      // Tangents and parts want everything at z itself; the rest follows from the last iterate.
      const bool again = lin || in_.out.parts || e.kind == Equilibrium::Kind::untaut;
      Projected q = again ? project(set_, c_, e.z, w, p.a) : e.fibres;
      if (!again) q.l += q.c * e.step;
      if (last) {
        const bool untaut = e.kind == Equilibrium::Kind::untaut;
        const bool pushes = (untaut && q.Q < 0.0) || e.z > p.L - c_.ls || e.tendon < 0.0;
        in_.out.force_N[k] = untaut || pushes ? 0.0 : c_.S * e.tendon;
        in_.out.status[k] = pushes ? FrameStatus::unloaded : FrameStatus::ok;
        record(in_.out, k, q, q.c * w, c_.with_velocity ? c_.damping : 0.0);
      }
      if (lin) linearise(*lin, k, p, e, q, w);
    }
  }

  void linearise(const Linear& lin, std::size_t k, const EquilibriumProblem& p, const Equilibrium& e,
                 const Projected& q, double w) const {
    if (e.kind == Equilibrium::Kind::untaut) {
      // Nothing pushes: as the activation rises from zero, so does the force, F = S Q to first order.
      linearise_without_root(lin, k, e.kind, q.Q < 0.0 ? 0.0 : q.Q_a);
      return;
    }
    const data::CurveValue t = taut_tendon(set_, (p.L - e.z) / c_.ls - 1.0);
    const double stiffness = t.slope / c_.ls;
    lin.inverse[k] = 1.0 / (stiffness + q.Q_z + p.alpha * q.Q_w);
    lin.Q_w[k] = q.Q_w;
    lin.Q_a[k] = q.Q_a;
    lin.stiffness[k] = stiffness;
    lin.taut_a[k] = 0.0;
    for (const MuscleParameter parameter : kAllParameters) {
      if (lin.R[index_of(parameter)] == nullptr) continue;
      lin.set(parameter, k,
              parameter == MuscleParameter::tendon_slack_length ? tendon_by_slack(p.L, e.z, stiffness)
                                                                : -dQ(q, c_, w, parameter));
    }
  }

  // df_t/dl_s at constant z.
  double tendon_by_slack(double L, double z, double stiffness) const { return -stiffness * (L - z) / c_.ls; }

  // The recursion of dz; `shift` is d((C - D) z¹) or null.
  void recur(const Tangent& t, const Linear& lin, const double* shift, double* dz) const {
    const double* R = t.parameter ? lin.R[index_of(*t.parameter)] : nullptr;
    for (std::size_t k = 0; k < in_.frames(); ++k) {
      double rhs = R != nullptr ? R[k] : 0.0;
      if (!t.dactivation.empty()) rhs -= lin.Q_a[k] * t.dactivation[k];
      if (k > 0) rhs -= lin.Q_w[k] * (difference_.beta(k, dz) + (shift != nullptr ? shift[k] : 0.0));
      dz[k] = rhs * lin.inverse[k];
    }
  }

  void force_tangent(const Tangent& t, const Linear& lin, const double* z, const double* dz) const {
    const bool by_slack = t.parameter == MuscleParameter::tendon_slack_length;
    const double scale = t.parameter ? relative_dS(in_.muscle, *t.parameter) : 0.0;
    for (std::size_t k = 0; k < in_.frames(); ++k) {
      double d = -lin.stiffness[k] * dz[k];
      if (by_slack) d += tendon_by_slack(in_.L[k], z[k], lin.stiffness[k]);
      if (!t.dactivation.empty()) d += lin.taut_a[k] * t.dactivation[k];
      t.dforce[k] = c_.S * d + scale * in_.out.force_N[k];
    }
  }

  void differentiate(const Tangent& t, const Linear& lin) const {
    double* dz = in_.scratch.array(kFirstTangent, in_.frames()).data();
    recur(t, lin, nullptr, dz);
    force_tangent(t, lin, in_.scratch.array(kFirst, in_.frames()).data(), dz);
  }

  void differentiate_corrected(const Tangent& t, const Linear& first, const Linear& second) const {
    const std::size_t n = in_.frames();
    double* dz1 = in_.scratch.array(kFirstTangent, n).data();
    double* dz2 = in_.scratch.array(kSecondTangent, n).data();
    double* dshift = in_.scratch.array(kShiftTangent, n).data();
    recur(t, first, nullptr, dz1);
    defect(dz1, dshift);
    recur(t, second, dshift, dz2);
    force_tangent(t, second, in_.scratch.array(kSecond, n).data(), dz2);
  }

  [[noreturn]] void fail(std::size_t k, const Equilibrium& e) const {
    data::ConvergenceFailure::Details d;
    d.where = fmt::format("muscle `{}`, frame {} (t = {:.6g} s)", in_.muscle.name(), k,
                          static_cast<double>(k) * in_.step_s);
    d.reason = "the elastic equilibrium was not bracketed tightly enough";
    d.iterations = e.evaluations;
    d.worst = in_.muscle.name();
    throw data::ConvergenceFailure(d);
  }

  const ChainInput& in_;
  const Set& set_;
  ElementConstants c_;
  EquilibriumSolver<Set> solver_;
  BackwardDifference difference_;
  double start_rate_;
};

}  // namespace

void elastic_chain(const ChainInput& in) {
  with_curves(in.muscle.options().curves, [&in]<class Set>(const Set& set) { Chain<Set>(in, set).run(); });
}

}  // namespace brachium::hill
