/// Rigid tendon: z = L - l_s, so that every frame stands alone, and w = L'.
///   F = S Q(L - l_s, L', a),  dF/dtheta = S (Q_a da/dtheta + Q_theta) with Q_theta = -Q_z for l_s
#include "hill/chain.hpp"

namespace brachium::hill {
namespace {

enum Slot : std::size_t { kRate = 0, kByActivation = 1, kDirect = 2 };

// The muscle-tendon rate: as given, or by differences of the lengths, which depend on no parameter.
std::span<const double> path_rate(const ChainInput& in) {
  if (!in.V.empty()) return in.V;
  const std::size_t n = in.frames();
  std::vector<double>& rate = in.scratch.array(kRate, n);
  switch (in.muscle.options().velocity) {
    case FibreVelocity::none:
      std::fill(rate.begin(), rate.end(), 0.0);
      break;
    case FibreVelocity::zero_lag:
      central_differences(in.L, in.step_s, rate);
      break;
    case FibreVelocity::causal: {
      const BackwardDifference d{in.step_s};
      rate[0] = 0.0;
      for (std::size_t k = 1; k < n; ++k) rate[k] = d.alpha(k) * in.L[k] + d.beta(k, in.L.data());
    }
  }
  return rate;
}

template <bool kTangents, class Set>
void run(const ChainInput& in, const Set& set) {
  const ElementConstants c(in.muscle);
  const std::size_t n = in.frames();
  const std::span<const double> rate = path_rate(in);
  const auto wanted = in.wanted();
  MuscleTrace& out = in.out;
  double* by_activation = nullptr;
  std::array<double*, kParameterCount> direct{};
  if constexpr (kTangents) {
    by_activation = in.scratch.array(kByActivation, n).data();
    for (std::size_t i = 0; i < kParameterCount; ++i) {
      if (wanted[i]) direct[i] = in.scratch.array(kDirect + i, n).data();
    }
  }
  for (std::size_t k = 0; k < n; ++k) {
    const double z = in.L[k] - c.ls;
    if (!(z > c.z_min)) {
      record_slack(out, k, c);
      if constexpr (kTangents) {
        by_activation[k] = 0.0;
        for (double* d : direct) {
          if (d != nullptr) d[k] = 0.0;
        }
      }
      continue;
    }
    const double w = c.with_velocity ? rate[k] : 0.0;
    const Projected q = project(set, c, z, w, in.a[k]);
    const bool pushes = q.Q < 0.0;
    out.force_N[k] = pushes ? 0.0 : c.S * q.Q;
    out.status[k] = pushes ? FrameStatus::unloaded : FrameStatus::ok;
    record(out, k, q, q.c * rate[k], c.with_velocity ? c.damping : 0.0);
    if constexpr (kTangents) {
      const double scale = pushes ? 0.0 : c.S;
      by_activation[k] = scale * q.Q_a;
      for (std::size_t i = 0; i < kParameterCount; ++i) {
        if (direct[i] == nullptr) continue;
        const MuscleParameter p = kAllParameters[i];
        const double Q_p = p == MuscleParameter::tendon_slack_length
                               ? -q.Q_z
                               : dQ(q, c, w, p) + relative_dS(in.muscle, p) * q.Q;
        direct[i][k] = scale * Q_p;
      }
    }
  }
  if constexpr (kTangents) {
    for (const Tangent& t : in.tangents) {
      const double* p = t.parameter ? direct[index_of(*t.parameter)] : nullptr;
      for (std::size_t k = 0; k < n; ++k) {
        t.dforce[k] =
            (t.dactivation.empty() ? 0.0 : by_activation[k] * t.dactivation[k]) + (p != nullptr ? p[k] : 0.0);
      }
    }
  }
}

}  // namespace

void rigid_chain(const ChainInput& in) {
  with_curves(in.muscle.options().curves,
              [&in](const auto& set) { in.tangents.empty() ? run<false>(in, set) : run<true>(in, set); });
}

}  // namespace brachium::hill
