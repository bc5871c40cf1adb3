#include "fem/surrogate/surrogate_model.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "data/model/error.hpp"

namespace brachium::fem {

SurrogateModel::SurrogateModel(std::string coordinate, std::vector<SurrogateMuscle> muscles)
    : coordinates_{std::move(coordinate)}, muscles_(std::move(muscles)) {
  if (muscles_.empty())
    throw data::InputError("bad-parameter", "a model of surrogates needs at least one muscle");
  bool errors = true;
  for (const SurrogateMuscle& m : muscles_) {
    const auto* angle = std::get_if<ArmOfAngle>(&m.arm);
    if (m.surrogate == nullptr || (angle && !angle->arm) ||
        std::count(names_.begin(), names_.end(), m.name) > 0) {
      throw data::InputError(
          "bad-parameter",
          fmt::format("muscle `{}` lacks its surrogate or its moment arm, or is there twice", m.name));
    }
    names_.push_back(m.name);
    force_.push_back(m.surrogate->output(m.force_output));
    const auto* arm = std::get_if<ArmOutput>(&m.arm);
    const auto* moment = std::get_if<MomentOutput>(&m.arm);
    other_.push_back(arm      ? m.surrogate->output(arm->output)
                     : moment ? m.surrogate->output(moment->output)
                              : 0);
    errors = errors && m.surrogate->error().has_value();
  }
  if (!(angles().lower < angles().upper))
    throw data::InputError("bad-parameter", "the surrogates of the muscles share no range of angles");
  traits_.rung = "fem.surrogate";
  traits_.gives_dmoment_dq = traits_.gives_dmoment_dactivation = true;
  traits_.gives_error_bound = errors;
}

data::Domain SurrogateModel::angles() const {
  data::Domain d{-HUGE_VAL, HUGE_VAL};
  for (const SurrogateMuscle& m : muscles_) {
    d.lower = std::max(d.lower, m.surrogate->bounds().theta_lower_rad);
    d.upper = std::min(d.upper, m.surrogate->bounds().theta_upper_rad);
  }
  return d;
}

void SurrogateModel::evaluate(const Eigen::VectorXd& q, const Eigen::VectorXd&,
                              const Eigen::VectorXd& activation, const Eigen::VectorXd& state,
                              limb::Evaluation& out) const {
  const auto n = static_cast<Eigen::Index>(muscles_.size());
  if (q.size() != 1 || activation.size() != n || state.size() != 0) {
    throw data::InputError(
        "wrong-size",
        fmt::format(
            "{} angles, {} activations and {} states for a model of one angle and {} muscles without state",
            q.size(), activation.size(), state.size(), n));
  }
  out.force.resize(n);
  out.moment_arm.resize(1, n);
  out.moment.setZero(1);
  out.dmoment_dq.setZero(1, 1);
  out.dmoment_dactivation.setZero(1, n);
  out.state_rate.resize(0);
  out.error_bound.setZero(traits_.gives_error_bound ? 1 : 0);
  std::array<OutputValue, 16> few;
  std::vector<OutputValue> many;
  for (Eigen::Index i = 0; i < n; ++i) {
    const auto k = static_cast<std::size_t>(i);
    const SurrogateMuscle& m = muscles_[k];
    const std::size_t outputs = m.surrogate->outputs().size();
    std::span<OutputValue> values(few.data(), std::min(outputs, few.size()));
    if (outputs > few.size()) {
      many.resize(outputs);
      values = many;
    }
    if (!m.surrogate->bounds().contains({q(0), activation(i)})) {
      try {
        m.surrogate->evaluate(q(0), activation(i), values);
      } catch (const data::InputError& e) {
        data::Diagnostic d = e.diagnostics().front();
        d.message = fmt::format("muscle `{}`: {}", m.name, d.message);
        throw data::InputError(d);
      }
    }
    m.surrogate->evaluate(q(0), activation(i), values);
    const OutputValue F = values[force_[k]];
    OutputValue M, r;  // moment and arm with their derivatives
    double bound = 0.0;
    const auto error_of = [&](std::size_t output) {
      return m.surrogate->error() ? m.surrogate->error()->outputs[output].greatest : 0.0;
    };
    if (std::holds_alternative<MomentOutput>(m.arm)) {
      M = values[other_[k]];
      r.value = F.value != 0.0 ? M.value / F.value : 0.0;
      bound = error_of(other_[k]);
    } else {
      if (const auto* arm = std::get_if<ArmOutput>(&m.arm)) {
        const OutputValue l = values[other_[k]];
        r = {arm->sign * l.value, arm->sign * l.dtheta, arm->sign * l.dalpha};
      } else {
        const data::CurveValue a = std::get<ArmOfAngle>(m.arm).arm(q(0));
        r = {a.value, a.slope, 0.0};
      }
      M = {r.value * F.value, r.dtheta * F.value + r.value * F.dtheta,
           r.dalpha * F.value + r.value * F.dalpha};
      bound = std::abs(r.value) * error_of(force_[k]);
      if (std::holds_alternative<ArmOutput>(m.arm)) bound += std::abs(F.value) * error_of(other_[k]);
    }
    out.force(i) = F.value;
    out.moment_arm(0, i) = r.value;
    out.moment(0) += M.value;
    out.dmoment_dq(0, 0) += M.dtheta;
    out.dmoment_dactivation(0, i) = M.dalpha;
    if (traits_.gives_error_bound) out.error_bound(0) += bound;
  }
}

}  // namespace brachium::fem
