#include "fem/limb/body_parameters.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "data/model/error.hpp"
#include "fem/limb/strap.hpp"

namespace brachium::fem {
namespace {

constexpr double passive_reference_pa = 1e5;
constexpr double longest_passive_stretch = 10.0;

double greatest_radius(const MuscleBody& body) {
  return *std::max_element(body.profile_m.begin(), body.profile_m.end());
}

double least_radius(const MuscleBody& body) {
  return *std::min_element(body.profile_m.begin(), body.profile_m.end());
}

void scale_profile(MuscleBody& body, double factor) {
  for (double& r : body.profile_m) r *= factor;
}

double volume(const MuscleBody& body) {
  return mean_area_m2(body) * body.belly_length_m;
}

double passive_stress(const FibrousTissue& t, double stretch) {
  return t.c3_pa / stretch * std::expm1(t.c4 * std::log(stretch));
}

double passive_stretch(const MuscleBody& body) {
  const FibrousTissue& t = body.material.muscle;
  double low = 1.0, high = longest_passive_stretch;
  if (!(passive_stress(t, high) > passive_reference_pa)) {
    throw data::InputError("limb-geometry",
                           fmt::format("{}: passive fibres of c3 {:.4g} Pa, c4 {:.4g} never bear 0.1 MPa",
                                       body.name, t.c3_pa, t.c4),
                           "give passive fibres by c3 and c4");
  }
  while (high - low > 1e-15 * high) {
    const double middle = 0.5 * (low + high);
    if (middle == low || middle == high) break;
    (passive_stress(t, middle) < passive_reference_pa ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

void set_passive(MuscleBody& body, double stretch, double c4) {
  FibrousTissue& t = body.material.muscle;
  t.c4 = c4;
  t.c3_pa = passive_reference_pa * stretch / std::expm1(c4 * std::log(stretch));
}

struct Access {
  BodyParameter parameter;
  double (*get)(const MuscleBody&);
  void (*set)(MuscleBody&, double);
};

#define BRACHIUM_MEMBER(member) \
  [](const MuscleBody& b) -> double { return b.member; }, [](MuscleBody& b, double v) { b.member = v; }

const std::vector<Access>& accesses() {
  static const std::vector<Access> all{
      {{"belly_length_m", "m", "stress-free length of the belly", 0.05, 0.26},
       BRACHIUM_MEMBER(belly_length_m)},
      {{"greatest_radius_m", "m", "of the profile, which is scaled as a whole", 0.008, 0.06},
       greatest_radius,
       [](MuscleBody& b, double v) { scale_profile(b, v / greatest_radius(b)); }},
      {{"volume_m3", "m3", "of the belly, by the profile as a whole at the length it has", 2e-5, 1e-3},
       volume,
       [](MuscleBody& b, double v) { scale_profile(b, std::sqrt(v / volume(b))); }},
      {{"end_radius_norm", "1", "the profile's least radius over its greatest, which stays", 0.3, 1.0},
       [](const MuscleBody& b) { return least_radius(b) / greatest_radius(b); },
       [](MuscleBody& b, double v) {
         const double most = greatest_radius(b), flank = most - least_radius(b);
         if (!(flank > 0.0))
           throw data::InputError("limb-geometry", b.name + ": a cylinder has no end_radius_norm",
                                  "give profile_m");
         const double factor = (1.0 - v) * most / flank;
         for (double& r : b.profile_m) r = most - factor * (most - r);
       }},
      {{"pre_stretch", "1",
        "length at the reference angle over the stress-free one; sets the rigid tendon's slack", 0.85, 1.4},
       BRACHIUM_MEMBER(pre_stretch)},
      {{"tendon_origin_m", "m", "meshed tendon at the origin", 0.0, 0.15}, BRACHIUM_MEMBER(tendon_origin_m)},
      {{"tendon_insertion_m", "m", "meshed tendon at the insertion", 0.0, 0.15},
       BRACHIUM_MEMBER(tendon_insertion_m)},
      {{"insertion_distance_m", "m", "of the tendon's insertion from the hinge", 0.015, 0.08},
       BRACHIUM_MEMBER(cable.distance_m)},
      {{"insertion_offset_rad", "rad", "of the insertion ahead of the forearm's long axis", -1.5, 0.5},
       BRACHIUM_MEMBER(cable.offset_rad)},
      {{"max_stress_pa", "Pa", "sigma_max", 5e4, 1e6, true}, BRACHIUM_MEMBER(material.max_stress_pa)},
      {{"optimal_stretch", "1", "lambda_opt", 1.0, 1.8, true},
       BRACHIUM_MEMBER(material.force_length.optimal_stretch)},
      {{"ascending_width", "1", "dW of the active bell below its top", 0.1, 1.0, true},
       BRACHIUM_MEMBER(material.force_length.ascending_width)},
      {{"ascending_exponent", "1", "nu there", 1.5, 8.0, true},
       BRACHIUM_MEMBER(material.force_length.ascending_exponent)},
      {{"descending_width", "1", "dW of the active bell above its top", 0.1, 1.0, true},
       BRACHIUM_MEMBER(material.force_length.descending_width)},
      {{"descending_exponent", "1", "nu there", 1.5, 8.0, true},
       BRACHIUM_MEMBER(material.force_length.descending_exponent)},
      {{"ground_c1_pa", "Pa", "c1 of the isotropic ground", 1e3, 3e5, true},
       BRACHIUM_MEMBER(material.muscle.c1_pa)},
      {{"ground_c2_pa", "Pa", "c2 of the isotropic ground", 1e2, 1e5, true},
       BRACHIUM_MEMBER(material.muscle.c2_pa)},
      {{"passive_stretch", "1", "fibre stretch at which passive fibres bear 0.1 MPa (nominal)", 1.05, 2.0,
        true},
       passive_stretch,
       [](MuscleBody& b, double v) { set_passive(b, v, b.material.muscle.c4); }},
      {{"passive_exponent", "1", "c4 of passive fibres, at the same passive_stretch", 1.0, 60.0, true},
       BRACHIUM_MEMBER(material.muscle.c4)},
  };
  return all;
}

#undef BRACHIUM_MEMBER

const Access& find(const std::string& name) {
  std::vector<std::string> names;
  for (const Access& a : accesses()) {
    if (a.parameter.name == name) return a;
    names.push_back(a.parameter.name);
  }
  throw data::InputError("unknown-body-parameter", "a muscle has no parameter `" + name + "`",
                         data::suggest(name, names));
}

}  // namespace

const std::vector<BodyParameter>& body_parameters() {
  static const std::vector<BodyParameter> all = [] {
    std::vector<BodyParameter> out;
    for (const Access& a : accesses()) out.push_back(a.parameter);
    return out;
  }();
  return all;
}

double body_value(const MuscleBody& body, const std::string& name) {
  return find(name).get(body);
}

void set_body_value(MuscleBody& body, const std::string& name, double value) {
  if (body.shape && (name == "end_radius_norm" || name == "tendon_origin_m" || name == "tendon_insertion_m"))
    throw data::InputError("limb-geometry",
                           fmt::format("{}: an imported mesh has no parameter `{}`", body.name, name),
                           "its length and greatest radius stretch it as a whole");
  if (name == "passive_exponent") return set_passive(body, passive_stretch(body), value);
  find(name).set(body, value);
}

void set_body_values(MuscleBody& body, const std::vector<std::pair<std::string, double>>& values) {
  const auto given = [&](const std::string& name) {
    return std::any_of(values.begin(), values.end(), [&](const auto& v) { return v.first == name; });
  };
  if (given("volume_m3") && given("greatest_radius_m"))
    throw data::InputError("contradiction",
                           fmt::format("{}: greatest_radius_m and volume_m3 are both given", body.name),
                           "at a given length one sets the other: take one of them");
  for (const auto& [name, value] : values)
    if (name != "volume_m3") set_body_value(body, name, value);
  for (const auto& [name, value] : values)  // at the length and the ends' share that the others leave
    if (name == "volume_m3") set_body_value(body, name, value);
}

}  // namespace brachium::fem
