#include "data/limb/bodies.hpp"

#include <fmt/format.h>

#include <cmath>

#include "data/model/error.hpp"

namespace brachium::limb {
namespace {

void check(const Body& b) {
  const auto refuse = [&b](const char* what, double value, const char* domain) {
    throw data::InputError("out-of-range",
                           fmt::format("the {} of `{}` must be {}, not {}", what, b.name, domain, value));
  };
  if (!(b.mass_kg >= 0.0) || !std::isfinite(b.mass_kg)) refuse("mass", b.mass_kg, "0 kg or greater");
  if (!(b.distance_m >= 0.0) || !std::isfinite(b.distance_m))
    refuse("distance", b.distance_m, "0 m or greater");
  if (!(b.inertia_kg_m2 >= 0.0) || !std::isfinite(b.inertia_kg_m2))
    refuse("inertia", b.inertia_kg_m2, "0 kg m^2 or greater");
  for (const double sd : {b.mass_relative_sd, b.distance_sd_m, b.inertia_relative_sd}) {
    if (!(sd >= 0.0) || !std::isfinite(sd)) refuse("uncertainty", sd, "0 or greater");
  }
}

}  // namespace

double BodySet::mass_kg() const {
  double sum = 0.0;
  for (const Body& b : bodies) sum += b.mass_kg;
  return sum;
}

double BodySet::first_moment_kg_m() const {
  double sum = 0.0;
  for (const Body& b : bodies) sum += b.mass_kg * b.distance_m;
  return sum;
}

double BodySet::inertia_kg_m2() const {
  double sum = 0.0;
  for (const Body& b : bodies) sum += b.inertia_kg_m2 + b.mass_kg * b.distance_m * b.distance_m;
  return sum;
}

BodySet bodies_of(const data::Scene& scene, const std::string& coordinate,
                  const std::map<std::string, double>& conditions, const std::string& trial) {
  BodySet set;
  set.coordinate = scene.coordinate(coordinate).name;
  set.body_mass_relative_sd = scene.body_mass_relative_sd;
  for (const data::Segment& s : scene.segments) {
    if (s.coordinate != coordinate) continue;
    set.bodies.push_back({s.name, s.mass_kg, s.centre_of_mass_m, s.inertia_kg_m2, s.mass_relative_sd,
                          s.centre_of_mass_sd_m, s.inertia_relative_sd, s.body_mass_fraction > 0.0});
  }
  if (set.bodies.empty()) {
    throw data::InputError("missing-segment",
                           fmt::format("the scene has no segment on coordinate `{}`", coordinate),
                           "add a [[segment]] with mass, centre of mass and inertia");
  }
  for (const data::Load& l : scene.loads) {
    if (l.coordinate != coordinate) continue;
    double mass = l.mass_kg;
    if (!l.mass_condition.empty()) {
      const auto at = conditions.find(l.mass_condition);
      if (at == conditions.end()) {
        std::vector<std::string> known;
        for (const auto& [name, value] : conditions) known.push_back(name);
        throw data::InputError(
            "missing-condition",
            fmt::format("load `{}` takes its mass from the condition `{}`, which {} does not give", l.name,
                        l.mass_condition, trial.empty() ? "the trial" : fmt::format("trial `{}`", trial)),
            known.empty() ? "state it in the session description" : data::suggest(l.mass_condition, known));
      }
      mass = at->second;
    }
    // A held load is a point mass: its own inertia about its centre is not known and small beside m d^2.
    set.bodies.push_back({l.name, mass, l.distance_m, 0.0, l.mass_relative_sd, l.distance_sd_m, 0.0, false});
  }
  for (const Body& b : set.bodies) check(b);
  return set;
}

}  // namespace brachium::limb
