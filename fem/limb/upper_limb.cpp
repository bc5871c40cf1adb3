#include "fem/limb/upper_limb.hpp"

#include <numbers>

#include "fem/material/parameter_sets.hpp"

namespace brachium::fem {
namespace {

constexpr double degree = std::numbers::pi / 180.0;

MuscleBody muscle(const std::string& name, const LimbMesh& mesh) {
  MuscleBody m;
  m.name = name;
  m.belly_cells = mesh.belly_cells;
  m.section.core_cells = mesh.core_cells;
  m.section.ring_cells = mesh.ring_cells;
  m.material = muscle_tendon_named("sprenger");
  m.bulk_modulus_pa = 50e6;
  m.standoff_m = 0.006;
  return m;
}

}  // namespace

UpperLimb generic_arm(const LimbMesh& mesh) {
  UpperLimb arm;
  arm.range = {10.0 * degree, 150.0 * degree};
  arm.humerus = {{"humerus shaft", Capsule{{0.0, 0.03, 0.0}, {0.0, 0.32, 0.0}, 0.011}},
                 {"distal humerus", Capsule{{0.0, 0.0, -0.02}, {0.0, 0.0, 0.02}, 0.012}}};

  arm.biceps = muscle("biceps", mesh);
  arm.biceps.cable = {{0.022, 0.337}, 0.0393, -11.0 * degree, {0.0029, -0.0019}, 0.0357, true};
  arm.biceps.belly_length_m = 0.200;
  arm.biceps.profile_m = {0.0135, 0.019, 0.0205, 0.019, 0.0135};
  arm.biceps.pre_stretch = 1.08;
  arm.biceps.reference_rad = arm.range.upper_rad;

  arm.triceps = muscle("triceps", mesh);
  arm.triceps.cable = {{-0.038, 0.303}, 0.035, -49.0 * degree, {-0.0057, -0.0074}, 0.0166, false};
  arm.triceps.belly_length_m = 0.200;
  arm.triceps.profile_m = {0.016, 0.024, 0.0265, 0.023, 0.0125};
  arm.triceps.pre_stretch = 1.18;
  arm.triceps.reference_rad = arm.range.lower_rad;
  return arm;
}

}  // namespace brachium::fem
