#include "optimise/scenario.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "data/model/error.hpp"
#include "optimise/scenario_root.hpp"

namespace brachium::optimise {
namespace {

void check(const StaticSystem& s, const Eigen::VectorXd& activation) {
  if (s.model == nullptr) throw data::InputError("bad-parameter", "a static system needs a muscle model");
  if (s.model->traits().state_size != 0) {
    throw data::InputError(
        "not-quasi-static",
        fmt::format("a static system needs a model without internal state; `{}` has {} states",
                    s.model->traits().rung, s.model->traits().state_size));
  }
  const std::size_t n_q = s.model->coordinates().size(), n_m = s.model->muscles().size();
  if (s.coordinate >= n_q || (s.q.size() != 0 && static_cast<std::size_t>(s.q.size()) != n_q) ||
      static_cast<std::size_t>(activation.size()) != n_m) {
    throw data::InputError(
        "wrong-size",
        fmt::format(
            "{} angles, coordinate {} and {} activations for a model of {} coordinates and {} muscles",
            s.q.size(), s.coordinate + 1, activation.size(), n_q, n_m));
  }
  if (!(s.lower_rad < s.upper_rad))
    throw data::InputError(
        "bad-range", fmt::format("a static system needs a range of angles, {:.6g} to {:.6g} rad is none",
                                 s.lower_rad, s.upper_rad));
}

// Muscles' moment alone, by the model.
void evaluate(const StaticSystem& s, double angle, const Eigen::VectorXd& activation, limb::Evaluation& out) {
  const auto n_q = static_cast<Eigen::Index>(s.model->coordinates().size());
  Eigen::VectorXd q = s.q.size() == 0 ? Eigen::VectorXd::Zero(n_q) : s.q;
  q(static_cast<Eigen::Index>(s.coordinate)) = angle;
  s.model->evaluate(q, Eigen::VectorXd::Zero(n_q), activation, Eigen::VectorXd(), out);
}

}  // namespace

MomentState moment_at(const StaticSystem& s, double angle, const Eigen::VectorXd& activation, double load) {
  check(s, activation);
  if (!std::isfinite(angle) || !std::isfinite(load))
    throw data::InputError("out-of-range",
                           fmt::format("an angle of {} rad with a load of {} N", angle, load));
  const auto c = static_cast<Eigen::Index>(s.coordinate);
  limb::Evaluation e;
  evaluate(s, angle, activation, e);
  MomentState m;
  m.force_N = e.force;
  m.moment_arm_m = e.moment_arm.row(c).transpose();
  m.moment_N_m = e.moment(c);
  m.scale_N_m = m.force_N.cwiseProduct(m.moment_arm_m).cwiseAbs().sum();
  if (e.error_bound.size() > 0) m.error_bound_N_m = e.error_bound(c);

  constexpr double h = 1e-5;
  limb::Evaluation low, high;
  if (s.model->traits().gives_dmoment_dq) {
    m.dangle_N_m_per_rad = e.dmoment_dq(c, c);
  } else {
    const double left = std::max(angle - h, std::min(s.lower_rad, angle)),
                 right = std::min(angle + h, std::max(s.upper_rad, angle));
    evaluate(s, left, activation, low);
    evaluate(s, right, activation, high);
    m.dangle_N_m_per_rad = (high.moment(c) - low.moment(c)) / (right - left);
  }
  if (s.model->traits().gives_dmoment_dactivation) {
    m.dactivation_N_m = e.dmoment_dactivation.row(c).transpose();
  } else {
    m.dactivation_N_m.resize(activation.size());
    for (Eigen::Index i = 0; i < activation.size(); ++i) {
      Eigen::VectorXd less = activation, more = activation;
      less(i) = std::max(0.0, less(i) - h);
      more(i) = std::min(1.0, more(i) + h);
      evaluate(s, angle, less, low);
      evaluate(s, angle, more, high);
      m.dactivation_N_m(i) = (high.moment(c) - low.moment(c)) / (more(i) - less(i));
    }
  }
  if (s.load_arm) {
    const data::CurveValue arm = s.load_arm(angle);
    m.dload_m = arm.value;
    m.moment_N_m += arm.value * load;
    m.dangle_N_m_per_rad += arm.slope * load;
    m.scale_N_m += std::abs(arm.value * load);
  } else if (load != 0.0) {
    throw data::InputError("bad-parameter",
                           fmt::format("a load of {:.6g} N on a system without an arm for it", load));
  }
  if (s.external_moment) {
    const data::CurveValue external = s.external_moment(angle);
    m.moment_N_m += external.value;
    m.dangle_N_m_per_rad += external.slope;
    m.scale_N_m += std::abs(external.value);
  }
  if (!std::isfinite(m.moment_N_m) || !std::isfinite(m.dangle_N_m_per_rad) ||
      !m.dactivation_N_m.allFinite()) {
    throw data::ConvergenceFailure({"static system",
                                    fmt::format("the moment at {:.6g} rad is not finite", angle),
                                    0,
                                    m.moment_N_m,
                                    0.0,
                                    {}});
  }
  return m;
}

double stopping_moment(const MomentState& at, const ScenarioOptions& options) {
  return std::max(options.relative_tolerance * at.scale_N_m, 10.0 * options.propagated_tolerance_N_m);
}

HeldAngle held_angle(const StaticSystem& s, double angle, std::size_t muscle, Eigen::VectorXd activation,
                     double load, const ScenarioOptions& options, double lower, double upper) {
  if (muscle >= static_cast<std::size_t>(activation.size()) || !(lower < upper) || !(lower >= 0.0) ||
      !(upper <= 1.0)) {
    throw data::InputError("bad-parameter",
                           fmt::format("muscle {} of {} with activation sought between {:.6g} and {:.6g}",
                                       muscle + 1, activation.size(), lower, upper));
  }
  const auto k = static_cast<Eigen::Index>(muscle);
  const double start = activation(k);
  const auto at = [&](double a) {
    activation(k) = a;
    return moment_at(s, angle, activation, load);
  };
  double direction = 0.0;
  const auto watch = [&](double a, const MomentState& m) {
    const double slope = m.dactivation_N_m(k);
    if (direction * slope < 0.0 || slope == 0.0) {
      throw data::ConvergenceFailure(
          {s.model->muscles()[muscle],
           fmt::format("the moment at {:.6g} rad is not monotone in the activation, at {:.6g}", angle, a), 0,
           m.moment_N_m, slope, s.model->muscles()[muscle]});
    }
    direction = slope;
  };
  std::vector<MomentState> places;
  for (int i = 0; i < 5; ++i) {
    const double a = i == 4 ? upper : lower + (upper - lower) * i / 4.0;
    places.push_back(at(a));
    watch(a, places.back());
  }
  HeldAngle held;
  held.dactivation_dactivation = Eigen::VectorXd::Zero(activation.size());
  const double fa = places.front().moment_N_m, fb = places.back().moment_N_m;
  const auto answer = [&](double a, std::vector<ConvergenceRow> history) {
    const MomentState m = at(a);
    held.activation = held.nearest = a;
    held.remaining_moment_N_m = m.moment_N_m;
    held.history = std::move(history);
    held.dactivation_dangle = -m.dangle_N_m_per_rad / m.dactivation_N_m(k);
    held.dactivation_dload = -m.dload_m / m.dactivation_N_m(k);
    held.dactivation_dactivation = -m.dactivation_N_m / m.dactivation_N_m(k);
    held.dactivation_dactivation(k) = 0.0;
  };
  for (const auto& [a, m] : {std::pair(lower, &places.front()), std::pair(upper, &places.back())}) {
    if (std::abs(m->moment_N_m) > stopping_moment(*m, options)) continue;
    answer(a, {{0, a, m->moment_N_m, 0.0}});
    return held;
  }
  if ((fa > 0.0) == (fb > 0.0)) {
    const bool first = std::abs(fa) <= std::abs(fb);
    held.nearest = first ? lower : upper;
    const MomentState& m = first ? places.front() : places.back();
    held.remaining_moment_N_m = m.moment_N_m;
    if (std::abs(m.dload_m) >= 1e-9) held.remaining_load_N = -m.moment_N_m / m.dload_m;
    held.history = {{0, held.nearest, m.moment_N_m, 0.0}};
    return held;
  }
  Root root = root_between(
      [&](double a) {
        const MomentState m = at(a);
        watch(a, m);
        return RootPoint{m.moment_N_m, m.dactivation_N_m(k), stopping_moment(m, options)};
      },
      lower, upper, fa, start, options);
  answer(root.at, std::move(root.history));
  return held;
}

std::optional<double> load_for_angle(const StaticSystem& s, double angle, const Eigen::VectorXd& activation) {
  const MomentState m = moment_at(s, angle, activation, 0.0);
  if (std::abs(m.dload_m) < 1e-9) return std::nullopt;
  return -m.moment_N_m / m.dload_m;
}

std::vector<ActivationFrame> hold(const StaticSystem& s, const std::vector<double>& time,
                                  const Eigen::VectorXd& angle, std::size_t muscle,
                                  const Eigen::MatrixXd& activation, const Eigen::VectorXd& load,
                                  const ScenarioOptions& options) {
  const auto n = static_cast<Eigen::Index>(time.size());
  if (angle.size() != n || load.size() != n || activation.cols() != n) {
    throw data::InputError("wrong-size",
                           fmt::format("{} times, {} angles, {} loads and {} columns of activations", n,
                                       angle.size(), load.size(), activation.cols()));
  }
  std::vector<ActivationFrame> frames;
  for (Eigen::Index i = 0; i < n; ++i) {
    Eigen::VectorXd a = activation.col(i);
    if (i > 0 && muscle < static_cast<std::size_t>(a.size()))
      a(static_cast<Eigen::Index>(muscle)) = frames.back().held.nearest;
    frames.push_back(
        {time[static_cast<std::size_t>(i)], held_angle(s, angle(i), muscle, std::move(a), load(i), options)});
  }
  return frames;
}

}  // namespace brachium::optimise
