#include "hill/muscle_tendon.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include "data/model/error.hpp"
#include "hill/parameter_check.hpp"

namespace brachium::hill {
namespace {

template <class Enum>
using Names = std::vector<std::pair<std::string, Enum>>;

const Names<TendonKind>& tendons() {
  static const Names<TendonKind> all = {{"rigid", TendonKind::rigid}, {"elastic", TendonKind::elastic}};
  return all;
}
const Names<FibreVelocity>& velocities() {
  static const Names<FibreVelocity> all = {{"zero_lag", FibreVelocity::zero_lag},
                                           {"causal", FibreVelocity::causal},
                                           {"none", FibreVelocity::none}};
  return all;
}
const Names<Compatibility>& compatibilities() {
  static const Names<Compatibility> all = {{"none", Compatibility::none}, {"ceinms", Compatibility::ceinms}};
  return all;
}

template <class Enum>
Enum parse(const Names<Enum>& all, std::string_view name, const char* what) {
  std::vector<std::string> known;
  for (const auto& [key, value] : all) {
    if (key == name) return value;
    known.push_back(key);
  }
  throw data::InputError("unknown-choice", fmt::format("`{}` is not a {}", name, what),
                         data::suggest(name, known));
}

template <class Enum>
std::string name_of(const Names<Enum>& all, Enum value) {
  for (const auto& [key, candidate] : all) {
    if (candidate == value) return key;
  }
  return {};
}

}  // namespace

TendonKind parse_tendon(std::string_view name) {
  return parse(tendons(), name, "kind of tendon");
}
FibreVelocity parse_fibre_velocity(std::string_view name) {
  return parse(velocities(), name, "fibre velocity");
}
Compatibility parse_compatibility(std::string_view name) {
  return parse(compatibilities(), name, "compatibility option");
}
std::string to_string(TendonKind kind) {
  return name_of(tendons(), kind);
}
std::string to_string(FibreVelocity kind) {
  return name_of(velocities(), kind);
}
std::string to_string(Compatibility kind) {
  return name_of(compatibilities(), kind);
}

MuscleModelOptions ceinms_options(TendonKind tendon) {
  MuscleModelOptions options;
  options.curves = Lloyd2003(Lloyd2003::Interpolant::spline);
  options.tendon = tendon;
  options.compatibility = Compatibility::ceinms;
  options.optimal_length_coupling = 0.15;
  return options;
}

MuscleTendon::MuscleTendon(std::string name, const data::MuscleParameters& parameters,
                           const MuscleModelOptions& options)
    : name_(std::move(name)), parameters_(parameters), options_(options) {
  const data::MuscleParameters& p = parameters_;
  const auto positive = [](double x) { return x > 0.0 && std::isfinite(x); };
  ParameterCheck check(fmt::format("muscle `{}`", name_));
  check.require(positive(p.max_isometric_force_N), "max_isometric_force_N", p.max_isometric_force_N,
                "positive and finite");
  check.require(positive(p.optimal_fibre_length_m), "optimal_fibre_length_m", p.optimal_fibre_length_m,
                "positive and finite");
  if (options.tendon == TendonKind::rigid) {
    check.require(p.tendon_slack_length_m >= 0.0 && std::isfinite(p.tendon_slack_length_m),
                  "tendon_slack_length_m", p.tendon_slack_length_m, "zero or positive, and finite");
  } else {
    check.require(positive(p.tendon_slack_length_m), "tendon_slack_length_m", p.tendon_slack_length_m,
                  "positive and finite for an elastic tendon");
  }
  check.require(p.pennation_at_optimal_rad >= 0.0 && p.pennation_at_optimal_rad < 0.5 * std::numbers::pi,
                "pennation_at_optimal_rad", p.pennation_at_optimal_rad, "in [0, pi/2)");
  check.require(positive(p.max_contraction_velocity), "max_contraction_velocity", p.max_contraction_velocity,
                "positive and finite, in optimal fibre lengths per second");
  check.require(p.fibre_damping >= 0.0 && std::isfinite(p.fibre_damping), "fibre_damping", p.fibre_damping,
                "zero or positive, and finite");
  check.require(positive(p.strength), "strength", p.strength, "positive and finite");
  check.require(options.optimal_length_coupling >= 0.0 && options.optimal_length_coupling <= 1.0,
                "optimal_length_coupling", options.optimal_length_coupling, "in [0, 1]");
  check.finish();
}

}  // namespace brachium::hill
