#pragma once
/// Numbers of a muscle by name: what fits and studies vary.
///
/// Passive fibres are named by the stretch λ_p at which they bear 0.1 MPa, c3 (λ_p^c4 - 1)/λ_p = 0.1 MPa: c3
/// alone spans ten decades at the exponents in use. Setting the exponent keeps λ_p.

#include <string>
#include <utility>
#include <vector>

#include "fem/limb/muscle_body.hpp"

namespace brachium::fem {

struct BodyParameter {
  std::string name, unit, meaning;
  double lower = 0.0, upper = 0.0;  ///< of what a muscle may plausibly be; fits take these bounds unless told
  bool material = false;            ///< of the law; else of the geometry
};

/// belly_length_m, greatest_radius_m, volume_m3, pre_stretch, tendon lengths, the insertion's place, max_stress_pa, the active
/// bell, ground and passive fibres.
const std::vector<BodyParameter>& body_parameters();

/// Throw InputError("unknown-body-parameter") with the nearest name; `body_value` of passive_stretch also
/// InputError("limb-geometry") where passive fibres never bear 0.1 MPa.
double body_value(const MuscleBody& body, const std::string& name);
void set_body_value(MuscleBody& body, const std::string& name, double value);

/// Several at once, whatever their order: all of them are what was asked for afterwards. Throws
/// InputError("contradiction") for radius and volume together: the length being given, they are one.
void set_body_values(MuscleBody& body, const std::vector<std::pair<std::string, double>>& values);

}  // namespace brachium::fem
