#include "optimise/model_choice.hpp"

#include <fmt/format.h>

#include <charconv>

#include "data/model/error.hpp"

namespace brachium::optimise {
namespace {

double number(const std::string& key, const std::string& text) {
  double value = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size())
    throw data::InputError("bad-value", fmt::format("model entry `{}` is not a number: `{}`", key, text));
  return value;
}

}  // namespace

hill::MuscleModelOptions ModelChoice::muscle_options() const {
  hill::MuscleModelOptions options;
  options.curves = hill::CurveSet::named(curves);
  options.tendon = tendon;
  options.velocity = fibre_velocity;
  options.compatibility = compatibility;
  options.optimal_length_coupling = optimal_length_coupling;
  return options;
}

std::map<std::string, std::string> ModelChoice::to_map() const {
  return {{"curves", curves},
          {"tendon", hill::to_string(tendon)},
          {"fibre_velocity", hill::to_string(fibre_velocity)},
          {"compatibility", hill::to_string(compatibility)},
          {"optimal_length_coupling", fmt::format("{}", optimal_length_coupling)},
          {"activation_form", emg::to_string(activation.form)},
          {"start_up", emg::to_string(activation.start_up)},
          {"nonlinearity", emg::to_string(activation.nonlinearity)},
          {"recursion_rate_hz", fmt::format("{}", recursion_rate_hz)}};
}

ModelChoice ModelChoice::from_map(const std::map<std::string, std::string>& map) {
  ModelChoice choice;
  std::vector<std::string> known;
  for (const auto& [key, value] : choice.to_map()) known.push_back(key);
  for (const auto& [key, value] : map) {
    if (key == "curves")
      choice.curves = value;
    else if (key == "tendon")
      choice.tendon = hill::parse_tendon(value);
    else if (key == "fibre_velocity")
      choice.fibre_velocity = hill::parse_fibre_velocity(value);
    else if (key == "compatibility")
      choice.compatibility = hill::parse_compatibility(value);
    else if (key == "optimal_length_coupling")
      choice.optimal_length_coupling = number(key, value);
    else if (key == "activation_form")
      choice.activation.form = emg::parse_activation_form(value);
    else if (key == "start_up")
      choice.activation.start_up = emg::parse_start_up(value);
    else if (key == "nonlinearity")
      choice.activation.nonlinearity = emg::parse_nonlinearity(value);
    else if (key == "recursion_rate_hz")
      choice.recursion_rate_hz = number(key, value);
    else
      throw data::InputError("unknown-key", fmt::format("`{}` is not an entry of a subject's model", key),
                             data::suggest(key, known));
  }
  return choice;
}

}  // namespace brachium::optimise
