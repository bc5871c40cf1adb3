/// The conventions of CEINMS 2015 (offline), for comparison and for subjects calibrated there:
///   - fibre velocity: knot slope of one cubic spline through the trial's fibre lengths, both kinds of
///   tendon;
///   - v~ is cut to [-1, 1] (the unit's curves are flat beyond);
///   - elastic root: the fibre's rate is the backward difference of third order of the last four fibre
///   lengths
///     (lower orders in the first frames, 0 in the very first), and the tendon curve is used as it is, also
///     below slack length;
///   - the force is that of the fibres with the knot slope, not that of the tendon: the two differ.
/// Not taken over: the fallback to a rigid tendon, and the mirrored fibre of a slack path, which is a status
/// here.
///
///   F = S c N(l, v~, a),  c = √(1 - h²/l²)
#include <fmt/format.h>

#include "data/model/error.hpp"
#include "hill/chain.hpp"

namespace brachium::hill {
namespace {

enum Slot : std::size_t { kLength = 0, kSlope, kLengthTangent, kSlopeTangent, kLinear };

// Per frame: the final force's partials, and for the elastic root those of R.
struct Linear {
  bool wanted = false;
  double *F_l, *F_v, *F_a, *inverse, *R_v, *R_a;
  std::array<double*, kParameterCount> F, R;
  static constexpr std::size_t kArrays = 6 + 2 * kParameterCount;

  Linear(MuscleScratch& s, std::size_t n, std::bitset<kParameterCount> parameters, bool any)
      : wanted(any),
        F_l(s.array(kLinear, n).data()),
        F_v(s.array(kLinear + 1, n).data()),
        F_a(s.array(kLinear + 2, n).data()),
        inverse(s.array(kLinear + 3, n).data()),
        R_v(s.array(kLinear + 4, n).data()),
        R_a(s.array(kLinear + 5, n).data()),
        F{},
        R{} {
    for (std::size_t i = 0; i < kParameterCount; ++i) {
      if (!parameters[i]) continue;
      F[i] = s.array(kLinear + 6 + 2 * i, n).data();
      R[i] = s.array(kLinear + 7 + 2 * i, n).data();
    }
  }
};
static_assert(kLinear + Linear::kArrays <= MuscleScratch::kSlots);

// y'_k = alpha y_k + beta: the derivative at the end of the polynomial through the last 1 to 4 samples.
struct ThirdOrder {
  double step_s;
  double alpha(std::size_t k) const {
    constexpr double first[] = {0.0, 1.0, 1.5, 11.0 / 6.0};
    return first[std::min<std::size_t>(k, 3)] / step_s;
  }
  double beta(std::size_t k, const double* y) const {
    if (k == 0) return 0.0;
    if (k == 1) return -y[0] / step_s;
    if (k == 2) return (-2.0 * y[1] + 0.5 * y[0]) / step_s;
    return (-3.0 * y[k - 1] + 1.5 * y[k - 2] - y[k - 3] / 3.0) / step_s;
  }
};

template <class Set>
class Chain {
 public:
  Chain(const ChainInput& in, const Set& set) : in_(in), set_(set), c_(in.muscle), difference_{in.step_s} {
    c_.with_velocity = true;
  }

  void run() {
    const std::size_t n = in_.frames();
    const bool elastic = in_.muscle.options().tendon == TendonKind::elastic;
    double* l = in_.scratch.array(kLength, n).data();
    double* v = in_.scratch.array(kSlope, n).data();
    const Linear lin(in_.scratch, n, in_.wanted(), !in_.tangents.empty());
    for (std::size_t k = 0; k < n; ++k) {
      in_.out.status[k] = FrameStatus::ok;
      elastic ? elastic_length(k, l, lin) : rigid_length(k, l, lin);
    }
    in_.scratch.spline.prepare(n, in_.step_s);
    in_.scratch.spline.apply({l, n}, {v, n});
    for (std::size_t k = 0; k < n; ++k) force(k, l[k], v[k], lin);
    for (const Tangent& t : in_.tangents) differentiate(t, lin);
  }

 private:
  struct Along {
    double c, c_l, c_h;  // cos(phi) and its derivatives by fibre length and thickness
  };
  Along along(double l) const {
    if (c_.h == 0.0) return {1.0, 0.0, 0.0};
    const double sine = c_.h / l;
    const double cosine = std::sqrt(1.0 - sine * sine);
    return {cosine, sine * sine / (l * cosine), -sine / (l * cosine)};
  }
  static double cut(double vn) { return std::clamp(vn, -1.0, 1.0); }
  bool is_cut(double v) const { return !(std::abs(v / c_.V) <= 1.0); }
  double h_by(MuscleParameter p) const {
    if (p == MuscleParameter::optimal_fibre_length) return c_.sin_opt;
    return p == MuscleParameter::pennation ? c_.lo * c_.cos_opt : 0.0;
  }

  // dN/dparameter at constant l and v [m/s].
  double N_by(const FibreForce& f, double v, double vn, MuscleParameter p) const {
    const double N_v = is_cut(v) ? 0.0 : f.N_v;
    switch (p) {
      case MuscleParameter::optimal_fibre_length:
        return f.N_lo(c_.lo) - N_v * vn / c_.lo;
      case MuscleParameter::max_contraction_velocity:
        return -N_v * vn / c_.vmax;
      case MuscleParameter::fibre_damping:
        return vn;
      default:
        return 0.0;
    }
  }

  // Slack: l is constant but for l_opt.
  void slack_length(std::size_t k, double* l, const Linear& lin) const {
    in_.out.status[k] = FrameStatus::slack;
    l[k] = std::sqrt(c_.h * c_.h + c_.z_min * c_.z_min);
    if (!lin.wanted) return;
    lin.inverse[k] = 1.0;
    lin.R_v[k] = lin.R_a[k] = 0.0;
    for (const MuscleParameter p : kAllParameters) {
      double* R = lin.R[index_of(p)];
      if (R == nullptr) continue;
      const double z_by = p == MuscleParameter::optimal_fibre_length ? kShortestProjection : 0.0;
      R[k] = (c_.h * h_by(p) + c_.z_min * z_by) / l[k];
    }
  }

  void rigid_length(std::size_t k, double* l, const Linear& lin) const {
    const double z = in_.L[k] - c_.ls;
    if (!(z > c_.z_min)) return slack_length(k, l, lin);
    l[k] = std::sqrt(c_.h * c_.h + z * z);
    if (!lin.wanted) return;
    lin.inverse[k] = 1.0;
    lin.R_v[k] = lin.R_a[k] = 0.0;
    for (const MuscleParameter p : kAllParameters) {
      double* R = lin.R[index_of(p)];
      if (R != nullptr)
        R[k] = (c_.h * h_by(p) - z * (p == MuscleParameter::tendon_slack_length ? 1.0 : 0.0)) / l[k];
    }
  }

  struct Residual {
    double R, R_l;  // and its total derivative by l, difference in time included
    Along g;
    data::CurveValue tendon;
    FibreForce f;
    double v, vn;
  };
  Residual residual(double L, double a, double alpha, double beta, double l) const {
    Residual r;
    r.g = along(l);
    r.v = alpha * l + beta;
    r.vn = cut(r.v / c_.V);
    r.f = fibre_force(set_, c_, l, r.vn, a);
    r.tendon = set_.tendon((L - l * r.g.c - c_.ls) / c_.ls);
    const double N_v = is_cut(r.v) ? 0.0 : r.f.N_v / c_.V;
    r.R = r.tendon.value - r.g.c * r.f.N;
    r.R_l = -r.tendon.slope / (c_.ls * r.g.c) - r.g.c_l * r.f.N - r.g.c * (r.f.N_l + N_v * alpha);
    return r;
  }

  double guess(std::size_t k, const double* l) const {
    if (k == 0) return c_.lo;
    if (k < 3) return l[k - 1];
    return 3.0 * (l[k - 1] - l[k - 2]) + l[k - 3];
  }

  // CEINMS looks between 0.2 and 2 optimal lengths with Brent's method to 1e-6 m; we solve to rounding, and
  // take a path without a sign change there as slack (too short) or as a failure (too long).
  void elastic_length(std::size_t k, double* l, const Linear& lin) const {
    const double L = in_.L[k], a = in_.a[k];
    const double alpha = difference_.alpha(k), beta = difference_.beta(k, l);
    const auto at = [&](double x) { return residual(L, a, alpha, beta, x); };
    double lower = std::max(0.2 * c_.lo, c_.h * (1.0 + 1e-9)), upper = 2.0 * c_.lo;
    if (!(L - c_.ls > c_.z_min) || !(at(lower).R > 0.0)) return slack_length(k, l, lin);
    if (!(at(upper).R < 0.0))
      fail(k, "no equilibrium below twice the optimal fibre length: the path is too long", 0);
    double x = std::clamp(guess(k, l), lower, upper);
    for (int i = 0; i < 200; ++i) {
      const Residual r = at(x);
      (r.R > 0.0 ? lower : upper) = x;
      const double step = -r.R / r.R_l;
      const bool close = r.R_l < 0.0 && std::abs(step) <= 1e-10 * c_.lo;
      double next = x + step;
      if (close || !(upper - lower > 4e-16 * upper)) {
        l[k] = close ? next : x;
        return linearise_root(k, r, lin);
      }
      if (!(r.R_l < 0.0 && next > lower && next < upper)) next = 0.5 * (lower + upper);
      x = next;
    }
    fail(k, "the root did not settle", 200);
  }

  // dl = (R_theta + R_a da + R_v dβ) inverse, with inverse = -1/R_l.
  void linearise_root(std::size_t k, const Residual& r, const Linear& lin) const {
    if (!lin.wanted) return;
    const double l = in_.scratch.array(kLength, in_.frames())[k];
    lin.inverse[k] = -1.0 / r.R_l;
    lin.R_v[k] = -r.g.c * (is_cut(r.v) ? 0.0 : r.f.N_v / c_.V);
    lin.R_a[k] = -r.g.c * r.f.N_a;
    for (const MuscleParameter p : kAllParameters) {
      double* R = lin.R[index_of(p)];
      if (R == nullptr) continue;
      // Tendon strain falls with l_s, and with z = l cos(phi), which the thickness shortens.
      double tendon = -r.tendon.slope / c_.ls * l * r.g.c_h * h_by(p);
      if (p == MuscleParameter::tendon_slack_length) {
        tendon -= r.tendon.slope * (in_.L[k] - l * r.g.c) / (c_.ls * c_.ls);
      }
      R[k] = tendon - r.g.c_h * h_by(p) * r.f.N - r.g.c * N_by(r.f, r.v, r.vn, p);
    }
  }

  void force(std::size_t k, double l, double v, const Linear& lin) const {
    if (in_.out.status[k] == FrameStatus::slack) {
      record_slack(in_.out, k, c_);
      if (!lin.wanted) return;
      lin.F_l[k] = lin.F_v[k] = lin.F_a[k] = 0.0;
      for (double* F : lin.F) {
        if (F != nullptr) F[k] = 0.0;
      }
      return;
    }
    const Along g = along(l);
    Projected q;
    q.l = l;
    q.c = g.c;
    q.vn = cut(v / c_.V);
    q.fibre = fibre_force(set_, c_, l, q.vn, in_.a[k]);
    const FibreForce& f = q.fibre;
    in_.out.force_N[k] = c_.S * g.c * f.N;
    record(in_.out, k, q, v, c_.damping);
    if (!lin.wanted) return;
    lin.F_l[k] = c_.S * (g.c_l * f.N + g.c * f.N_l);
    lin.F_v[k] = is_cut(v) ? 0.0 : c_.S * g.c * f.N_v / c_.V;
    lin.F_a[k] = c_.S * g.c * f.N_a;
    for (const MuscleParameter p : kAllParameters) {
      double* F = lin.F[index_of(p)];
      if (F == nullptr) continue;
      F[k] = c_.S * (g.c_h * h_by(p) * f.N + g.c * N_by(f, v, q.vn, p)) +
             relative_dS(in_.muscle, p) * in_.out.force_N[k];
    }
  }

  void differentiate(const Tangent& t, const Linear& lin) const {
    const std::size_t n = in_.frames();
    double* dl = in_.scratch.array(kLengthTangent, n).data();
    double* dv = in_.scratch.array(kSlopeTangent, n).data();
    const double* R = t.parameter ? lin.R[index_of(*t.parameter)] : nullptr;
    const double* F = t.parameter ? lin.F[index_of(*t.parameter)] : nullptr;
    for (std::size_t k = 0; k < n; ++k) {
      double rhs = R != nullptr ? R[k] : 0.0;
      if (!t.dactivation.empty()) rhs += lin.R_a[k] * t.dactivation[k];
      rhs += lin.R_v[k] * difference_.beta(k, dl);
      dl[k] = rhs * lin.inverse[k];
    }
    in_.scratch.spline.apply({dl, n}, {dv, n});
    for (std::size_t k = 0; k < n; ++k) {
      double d = lin.F_l[k] * dl[k] + lin.F_v[k] * dv[k];
      if (!t.dactivation.empty()) d += lin.F_a[k] * t.dactivation[k];
      t.dforce[k] = d + (F != nullptr ? F[k] : 0.0);
    }
  }

  [[noreturn]] void fail(std::size_t k, const char* reason, int iterations) const {
    data::ConvergenceFailure::Details d;
    d.where = fmt::format("muscle `{}`, frame {} (t = {:.6g} s)", in_.muscle.name(), k,
                          static_cast<double>(k) * in_.step_s);
    d.reason = reason;
    d.iterations = iterations;
    d.worst = in_.muscle.name();
    throw data::ConvergenceFailure(d);
  }

  const ChainInput& in_;
  const Set& set_;
  ElementConstants c_;
  ThirdOrder difference_;
};

}  // namespace

void ceinms_chain(const ChainInput& in) {
  with_curves(in.muscle.options().curves, [&in]<class Set>(const Set& set) { Chain<Set>(in, set).run(); });
}

}  // namespace brachium::hill
