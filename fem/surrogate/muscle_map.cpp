#include "fem/surrogate/muscle_map.hpp"

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "data/model/error.hpp"

namespace brachium::fem {
namespace {

constexpr double degrees = 180.0 / std::numbers::pi;

std::string place(const StatePoint& s) {
  return fmt::format("{:.6g} deg, activation {:.6g}", s.theta_rad * degrees, s.activation);
}

std::optional<double> value_of(const MuscleState& s, MapOutput output) {
  switch (output) {
    case MapOutput::force:
      return s.force_n;
    case MapOutput::moment:
      return s.moment_n_m;
    case MapOutput::tdm:
      return s.tdm_m;
    case MapOutput::vrla:
      return s.vrla_m;
    case MapOutput::vrla_plus:
      return s.vrla_plus_m;
    case MapOutput::contact_force:
      return s.contact_force_n;
    case MapOutput::mean_fibre_stretch:
      return s.fibre_stretch ? std::optional(s.fibre_stretch->mean) : std::nullopt;
  }
  return std::nullopt;
}

std::optional<Gradient> gradient_of(const MuscleState& s, MapOutput output) {
  if (output == MapOutput::force) return s.force_gradient;
  if (output == MapOutput::moment) return s.moment_gradient;
  return std::nullopt;
}

const char* text(StateStability stability) {
  return stability == StateStability::stable     ? "stable"
         : stability == StateStability::unstable ? "unstable"
                                                 : "unknown";
}

}  // namespace

const MuscleState* MuscleMap::find(const StatePoint& at) const {
  for (const MuscleState& s : states) {
    if (std::abs(s.at.theta_rad - at.theta_rad) <= 1e-9 * bounds.theta_span() &&
        std::abs(s.at.activation - at.activation) <= 1e-9 * bounds.activation_span())
      return &s;
  }
  return nullptr;
}

void MuscleMap::check() const {
  bounds.check();
  for (const MuscleState& s : states) {
    if (!bounds.contains(s.at))
      throw data::InputError("bad-sample", fmt::format("muscle `{}`: the state at {} lies outside the map",
                                                       muscle, place(s.at)));
    const bool finite = std::isfinite(s.force_n) && std::isfinite(s.moment_n_m) &&
                        s.wrench_force_n.allFinite() && s.wrench_moment_n_m.allFinite();
    if (!finite)
      throw data::InputError("bad-sample",
                             fmt::format("muscle `{}`: the state at {} is not finite", muscle, place(s.at)));
    if (find(s.at) != &s)
      throw data::InputError("bad-sample",
                             fmt::format("muscle `{}`: the state at {} is there twice", muscle, place(s.at)));
  }
}

data::Table MuscleMap::table() const {
  const double none = std::numeric_limits<double>::quiet_NaN();
  data::Table table{muscle + ": states", {}};
  const auto column = [&](const std::string& name, const std::string& unit, const auto& of) {
    std::vector<double> values;
    for (const MuscleState& s : states) values.push_back(of(s));
    values.resize(values.size() + failed.size(), none);
    table.columns.push_back({name, unit, std::move(values)});
  };
  const auto or_none = [none](const std::optional<double>& v) { return v.value_or(none); };
  std::vector<double> theta, activation;
  std::vector<std::string> outcome;
  for (const MuscleState& s : states)
    theta.push_back(s.at.theta_rad * degrees), activation.push_back(s.at.activation),
        outcome.emplace_back(text(s.stability));
  for (const FailedState& f : failed)
    theta.push_back(f.at.theta_rad * degrees), activation.push_back(f.at.activation),
        outcome.push_back("failed: " + f.reason);
  table.columns.push_back({"angle_deg", "deg", std::move(theta)});
  table.columns.push_back({"activation", "1", std::move(activation)});
  column("force_N", "N", [](const MuscleState& s) { return s.force_n; });
  column("dforce_dangle_N_per_rad", "N/rad",
         [&](const MuscleState& s) { return s.force_gradient ? s.force_gradient->dtheta : none; });
  column("dforce_dactivation_N", "N",
         [&](const MuscleState& s) { return s.force_gradient ? s.force_gradient->dalpha : none; });
  column("moment_N_m", "N m", [](const MuscleState& s) { return s.moment_n_m; });
  column("tdm_m", "m", [&](const MuscleState& s) { return or_none(s.tdm_m); });
  column("vrla_m", "m", [&](const MuscleState& s) { return or_none(s.vrla_m); });
  column("vrla_plus_m", "m", [&](const MuscleState& s) { return or_none(s.vrla_plus_m); });
  column("contact_force_N", "N", [&](const MuscleState& s) { return or_none(s.contact_force_n); });
  column("least_fibre_stretch", "1",
         [&](const MuscleState& s) { return s.fibre_stretch ? s.fibre_stretch->least : none; });
  column("mean_fibre_stretch", "1",
         [&](const MuscleState& s) { return s.fibre_stretch ? s.fibre_stretch->mean : none; });
  column("greatest_fibre_stretch", "1",
         [&](const MuscleState& s) { return s.fibre_stretch ? s.fibre_stretch->greatest : none; });
  table.columns.push_back({"outcome", "", std::move(outcome)});
  return table;
}

std::string name_of(MapOutput output) {
  switch (output) {
    case MapOutput::force:
      return "force_n";
    case MapOutput::moment:
      return "moment_n_m";
    case MapOutput::tdm:
      return "tdm_m";
    case MapOutput::vrla:
      return "vrla_m";
    case MapOutput::vrla_plus:
      return "vrla_plus_m";
    case MapOutput::contact_force:
      return "contact_force_n";
    case MapOutput::mean_fibre_stretch:
      return "mean_fibre_stretch";
  }
  return {};
}

MapSamples samples_of(const MuscleMap& map, const std::vector<MapOutput>& outputs) {
  map.check();
  MapSamples out;
  out.left_out = map.failed;
  for (const MapOutput o : outputs) out.set.outputs.push_back(name_of(o));
  const auto n = static_cast<Eigen::Index>(outputs.size());
  bool gradients = true;
  for (const MuscleState& s : map.states) {
    if (s.stability == StateStability::unstable) {
      out.left_out.push_back({s.at, "unstable"});
      continue;
    }
    Sample sample{s.at, Eigen::VectorXd(n), Eigen::VectorXd(n), Eigen::VectorXd(n)};
    for (Eigen::Index i = 0; i < n; ++i) {
      const MapOutput output = outputs[static_cast<std::size_t>(i)];
      const auto value = value_of(s, output);
      if (!value)
        throw data::InputError("missing-output", fmt::format("muscle `{}`: the state at {} has no `{}`",
                                                             map.muscle, place(s.at), name_of(output)));
      const auto gradient = gradient_of(s, output);
      gradients = gradients && gradient.has_value();
      sample.value(i) = *value;
      sample.dtheta(i) = gradient ? gradient->dtheta : 0.0;
      sample.dalpha(i) = gradient ? gradient->dalpha : 0.0;
    }
    out.set.samples.push_back(std::move(sample));
  }
  if (!gradients) {
    for (Sample& s : out.set.samples) s.dtheta.resize(0), s.dalpha.resize(0);
  }
  return out;
}

}  // namespace brachium::fem
