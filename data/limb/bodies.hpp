#pragma once
/// What hangs on a hinge: rigid bodies along one axis, with how well each number is known.
///
/// | symbol | identifier    | unit   | meaning                                                       |
/// |--------|---------------|--------|---------------------------------------------------------------|
/// | m      | mass_kg       | kg     | mass of a body                                                |
/// | d      | distance_m    | m      | hinge to centre of mass, along the segment                    |
/// | I_c    | inertia_kg_m2 | kg m^2 | about the centre of mass, about the hinge axis                |
/// | S      | first_moment  | kg m   | S = sum m d: what gravity and linear acceleration act on      |
/// | I      | inertia       | kg m^2 | I = sum (I_c + m d^2): about the hinge                        |

#include <map>
#include <string>
#include <vector>

#include "data/model/scene.hpp"

namespace brachium::limb {

inline constexpr double standard_gravity_m_per_s2 = 9.80665;  ///< CGPM 1901

struct Body {
  std::string name;
  double mass_kg = 0.0;
  double distance_m = 0.0;
  double inertia_kg_m2 = 0.0;
  // Standard uncertainties.
  double mass_relative_sd = 0.0;
  double distance_sd_m = 0.0;
  double inertia_relative_sd = 0.0;
  bool from_body_mass = false;  ///< the mass is a fraction of the body mass and shares its uncertainty
};

/// All bodies that rotate together about one hinge.
struct BodySet {
  std::string coordinate;
  std::vector<Body> bodies;
  double body_mass_relative_sd = 0.0;

  double mass_kg() const;
  double first_moment_kg_m() const;
  double inertia_kg_m2() const;
};

/// Segments and loads of one coordinate. `conditions` are the trial's numbers that loads may take their mass
/// from (data::Trial::conditions); `trial` names it in messages. Throws InputError: "missing-condition",
/// "missing-coordinate", "missing-segment" (nothing hangs on the hinge), or "out-of-range" (a mass, distance
/// or inertia outside its domain).
BodySet bodies_of(const data::Scene& scene, const std::string& coordinate,
                  const std::map<std::string, double>& conditions, const std::string& trial = {});

}  // namespace brachium::limb
