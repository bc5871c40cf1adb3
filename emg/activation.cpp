#include "emg/activation.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "data/model/error.hpp"
#include "emg/activation_response.hpp"
#include "emg/names.hpp"

namespace brachium::emg {
namespace {

constexpr std::array<std::pair<ActivationForm, const char*>, 3> forms{
    {{ActivationForm::continuous, "continuous"},
     {ActivationForm::recursive, "recursive"},
     {ActivationForm::first_order, "first_order"}}};
constexpr std::array<std::pair<StartUp, const char*>, 3> start_ups{
    {{StartUp::steady_state, "steady_state"}, {StartUp::rest, "rest"}, {StartUp::ceinms, "ceinms"}}};

std::string of_muscle(const std::string& muscle) {
  return muscle.empty() ? std::string{} : fmt::format(" of muscle `{}`", muscle);
}

void add(std::vector<data::Diagnostic>& list, std::string message) {
  list.push_back({data::Severity::error, "out-of-range", std::move(message), std::nullopt, {}});
}

void check_delay_and_shape(std::vector<data::Diagnostic>& list, const ActivationModel& model, double delay_s,
                           double shape, const std::string& muscle) {
  if (!(delay_s >= 0.0) || !std::isfinite(delay_s)) {
    add(list, fmt::format("`delay_s`{} = {} s must be >= 0", of_muscle(muscle), delay_s));
  }
  const ShapeRange range = shape_range(model.nonlinearity);
  if (!(shape >= range.lower && shape <= range.upper)) {
    add(list, fmt::format("`shape`{} = {} is outside [{}, {}], the range of the {} nonlinearity",
                          of_muscle(muscle), shape, range.lower, range.upper, to_string(model.nonlinearity)));
  }
  if (model.start_up == StartUp::ceinms && model.form != ActivationForm::recursive) {
    add(list, "start-up `ceinms` belongs to the `recursive` form only");
  }
}

std::vector<data::Diagnostic> mistakes(const ActivationModel& model, const data::ActivationParameters& p,
                                       const std::string& muscle) {
  std::vector<data::Diagnostic> list;
  check_delay_and_shape(list, model, p.delay_s, p.shape, muscle);
  for (const auto& [name, value] : {std::pair{"time_constant_1_s", p.time_constant_1_s},
                                    std::pair{"time_constant_2_s", p.time_constant_2_s}}) {
    if (!(value > 0.0) || !std::isfinite(value)) {
      add(list, fmt::format("`{}`{} = {} s must be > 0", name, of_muscle(muscle), value));
    }
  }
  return list;
}

std::vector<data::Diagnostic> mistakes(const ActivationModel& model, const RecursionParameters& p,
                                       const std::string& muscle) {
  std::vector<data::Diagnostic> list;
  check_delay_and_shape(list, model, p.delay_s, p.shape, muscle);
  for (const auto& [name, value] : {std::pair{"g1", p.g1}, std::pair{"g2", p.g2}}) {
    if (!(std::abs(value) < 1.0)) {
      add(list, fmt::format("`{}`{} = {} must lie in (-1, 1): the recursion would not be stable", name,
                            of_muscle(muscle), value));
    }
  }
  if (model.form != ActivationForm::recursive) add(list, "`g1`, `g2` belong to the `recursive` form only");
  return list;
}

void raise(std::vector<data::Diagnostic> list) {
  if (!list.empty()) throw data::InputError(std::move(list));
}

void check_samples(std::span<const double> e, double rate_hz) {
  if (!(rate_hz > 0.0) || !std::isfinite(rate_hz)) {
    throw data::InputError("out-of-range", fmt::format("`rate_hz` = {} must be > 0", rate_hz));
  }
  double zero = 0.0;  // stays 0 unless a sample is NaN or Inf
  for (const double x : e) zero += 0.0 * x;
  if (zero == 0.0) return;
  for (std::size_t k = 0; k < e.size(); ++k) {
    if (!std::isfinite(e[k])) {
      throw data::InputError("not-finite", fmt::format("the excitation is `{}` at sample {} ({:.6g} s)", e[k],
                                                       k, static_cast<double>(k) / rate_hz));
    }
  }
}

// Beyond these the matrix exponential loses digits or the recursion's steps vanish.
void check_time_constants(const data::ActivationParameters& p, double rate_hz) {
  std::vector<data::Diagnostic> list;
  for (const auto& [name, value] : {std::pair{"time_constant_1_s", p.time_constant_1_s},
                                    std::pair{"time_constant_2_s", p.time_constant_2_s}}) {
    const double ratio = value * rate_hz;
    if (!(ratio >= 1e-3 && ratio <= 1e7)) {
      add(list, fmt::format("`{}` = {} s must lie between 1e-3 and 1e7 sample periods at {} Hz", name, value,
                            rate_hz));
    }
  }
  raise(std::move(list));
}

RecursionParameters as_recursion(const data::ActivationParameters& p, double rate_hz) {
  return {recursion_coefficient(p.time_constant_1_s, rate_hz),
          recursion_coefficient(p.time_constant_2_s, rate_hz), p.delay_s, p.shape, rate_hz};
}

void scale(std::span<double> values, double factor) {
  for (double& v : values) v *= factor;
}

// u in `activation` and du/dp in the tangents become a and da/dp.
void apply_nonlinearity(Nonlinearity kind, double shape, std::span<double> activation,
                        const ActivationTangents* t) {
  const ShapedNonlinearity nonlinearity(kind, shape);
  if (!t) {
    if (kind == Nonlinearity::none) return;
    for (double& a : activation) a = nonlinearity(a);
    return;
  }
  const std::array<std::span<double>, 4> linear{t->gain, t->delay, t->dynamics_1, t->dynamics_2};
  for (std::size_t k = 0; k < activation.size(); ++k) {
    if (!t->neural.empty()) t->neural[k] = activation[k];
    const NonlinearityValue a = nonlinearity.with_derivatives(activation[k]);
    activation[k] = a.value;
    if (!t->shape.empty()) t->shape[k] = a.dshape;
    for (const std::span<double>& tangent : linear) {
      if (!tangent.empty()) tangent[k] *= a.slope;
    }
  }
}

// What is linear in e is computed for a gain of 1 and scaled.
void finish_linear(const ActivationModel& model, double shape, double gain, std::span<double> activation,
                   const ActivationTangents* t) {
  if (t) {
    if (!t->gain.empty()) std::copy(activation.begin(), activation.end(), t->gain.begin());
    for (const std::span<double>& tangent : {t->delay, t->dynamics_1, t->dynamics_2}) scale(tangent, gain);
  }
  scale(activation, gain);
  apply_nonlinearity(model.nonlinearity, shape, activation, t);
}

void run(const ActivationModel& model, const data::ActivationParameters& p, std::span<const double> e,
         double rate_hz, std::span<double> activation, double gain, const ActivationTangents* t) {
  raise(mistakes(model, p, {}));
  check_samples(e, rate_hz);
  check_time_constants(p, rate_hz);
  const ResponseTangents response =
      t ? ResponseTangents{t->delay, t->dynamics_1, t->dynamics_2} : ResponseTangents{};
  switch (model.form) {
    case ActivationForm::continuous:
      continuous_response(model.start_up, p, e, rate_hz, activation, response);
      break;
    case ActivationForm::recursive: {
      const RecursionParameters recursion = as_recursion(p, rate_hz);
      recursive_response(model.start_up, recursion, e, activation, response);
      // g = -exp(-dt/τ):  dg/dτ = g dt/τ^2
      const double dt = 1.0 / rate_hz;
      scale(response.dynamics_1, recursion.g1 * dt / (p.time_constant_1_s * p.time_constant_1_s));
      scale(response.dynamics_2, recursion.g2 * dt / (p.time_constant_2_s * p.time_constant_2_s));
      break;
    }
    case ActivationForm::first_order: {
      const double lowest = e.empty() ? 0.0 : gain * *std::min_element(e.begin(), e.end());
      if (!(lowest > -0.3)) {
        throw data::InputError(
            "out-of-range",
            fmt::format("the excitation falls to `{}`; the first-order form needs > -0.3", lowest));
      }
      first_order_response(model.start_up, p, e, rate_hz, gain, activation, t ? t->gain : std::span<double>{},
                           response);
      apply_nonlinearity(model.nonlinearity, p.shape, activation, t);
      return;
    }
  }
  finish_linear(model, p.shape, gain, activation, t);
}

void check_rate(const RecursionParameters& p, double rate_hz) {
  if (!(std::abs(p.rate_hz - rate_hz) <= 1e-9 * rate_hz)) {
    throw data::InputError(
        "rate-mismatch",
        fmt::format("`g1`, `g2` were given for {} Hz, the excitation has {} Hz", p.rate_hz, rate_hz),
        "resample the excitation, or give time constants, which do not depend on the rate");
  }
}

void run(const ActivationModel& model, const RecursionParameters& p, std::span<const double> e,
         double rate_hz, std::span<double> activation, double gain, const ActivationTangents* t) {
  raise(mistakes(model, p, {}));
  check_samples(e, rate_hz);
  check_rate(p, rate_hz);
  recursive_response(model.start_up, p, e, activation,
                     t ? ResponseTangents{t->delay, t->dynamics_1, t->dynamics_2} : ResponseTangents{});
  finish_linear(model, p.shape, gain, activation, t);
}

}  // namespace

std::string to_string(ActivationForm form) {
  return name_of(forms, form);
}
std::string to_string(StartUp start_up) {
  return name_of(start_ups, start_up);
}
ActivationForm parse_activation_form(const std::string& name) {
  return parse_name(forms, name, "unknown-activation-form", "a form of activation dynamics");
}
StartUp parse_start_up(const std::string& name) {
  return parse_name(start_ups, name, "unknown-start-up", "a start-up of activation dynamics");
}

SplitDelay split_delay(double delay_s, double rate_hz) {
  const double samples = delay_s * rate_hz;
  // A delay of whole samples up to rounding is one of whole samples.
  const double nearest = std::round(samples);
  if (std::abs(samples - nearest) <= 1e-12 * std::max(1.0, nearest)) {
    return {static_cast<std::size_t>(std::min(nearest, 1e15)), 0.0};
  }
  const double whole = std::floor(samples);
  return {static_cast<std::size_t>(std::min(whole, 1e15)), samples - whole};
}

void activate(const ActivationModel& model, const data::ActivationParameters& parameters,
              std::span<const double> excitation, double rate_hz, std::span<double> activation, double gain) {
  run(model, parameters, excitation, rate_hz, activation, gain, nullptr);
}

void activate(const ActivationModel& model, const RecursionParameters& parameters,
              std::span<const double> excitation, double rate_hz, std::span<double> activation, double gain) {
  run(model, parameters, excitation, rate_hz, activation, gain, nullptr);
}

void activate_with_tangents(const ActivationModel& model, const data::ActivationParameters& parameters,
                            std::span<const double> excitation, double rate_hz, std::span<double> activation,
                            const ActivationTangents& tangents, double gain) {
  run(model, parameters, excitation, rate_hz, activation, gain, &tangents);
}

void activate_with_tangents(const ActivationModel& model, const RecursionParameters& parameters,
                            std::span<const double> excitation, double rate_hz, std::span<double> activation,
                            const ActivationTangents& tangents, double gain) {
  run(model, parameters, excitation, rate_hz, activation, gain, &tangents);
}

void neural_response(const ActivationModel& model, const data::ActivationParameters& parameters,
                     std::span<const double> excitation, double rate_hz, std::span<double> neural) {
  if (model.form == ActivationForm::first_order) {
    throw data::InputError("not-linear", "the `first_order` form is not linear in the excitation");
  }
  ActivationModel linear = model;
  linear.nonlinearity = Nonlinearity::none;
  run(linear, parameters, excitation, rate_hz, neural, 1.0, nullptr);
}

void neural_response(const ActivationModel& model, const RecursionParameters& parameters,
                     std::span<const double> excitation, double rate_hz, std::span<double> neural) {
  ActivationModel linear = model;
  linear.nonlinearity = Nonlinearity::none;
  run(linear, parameters, excitation, rate_hz, neural, 1.0, nullptr);
}

double recursion_coefficient(double time_constant_s, double rate_hz) {
  return -std::exp(-1.0 / (rate_hz * time_constant_s));
}

double time_constant(double g, double rate_hz) {
  if (!(g < 0.0 && g > -1.0)) {
    throw data::InputError("no-time-constant",
                           fmt::format("g = `{}` has no time constant: it must lie in (-1, 0)", g),
                           "use it in the recursive form, with the rate it was fitted at");
  }
  return -1.0 / (rate_hz * std::log(-g));
}

double equivalent_continuous_delay(double recursion_delay_s, double rate_hz) {
  return recursion_delay_s - 1.0 / rate_hz;
}

std::array<double, 2> neural_state_rate(const data::ActivationParameters& p, double delayed_excitation,
                                        const std::array<double, 2>& state) {
  return {(delayed_excitation - state[0]) / p.time_constant_1_s, (state[0] - state[1]) / p.time_constant_2_s};
}

double first_order_rate(const data::ActivationParameters& p, double delayed_excitation, double activation) {
  const double s = 0.5 + 1.5 * activation;
  const double gap = delayed_excitation - activation;
  return gap > 0.0 ? gap / (p.time_constant_1_s * s) : gap * s / p.time_constant_2_s;
}

void check_parameters(const ActivationModel& model, const data::ActivationParameters& parameters,
                      const std::string& muscle) {
  raise(mistakes(model, parameters, muscle));
}

void check_parameters(const ActivationModel& model, const RecursionParameters& parameters,
                      const std::string& muscle) {
  raise(mistakes(model, parameters, muscle));
}

}  // namespace brachium::emg
