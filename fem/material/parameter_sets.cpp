#include "fem/material/parameter_sets.hpp"

#include "data/model/error.hpp"

namespace brachium::fem {
namespace {

template <class Values>
const Values& find(const std::vector<ParameterSet<Values>>& sets, const std::string& kind,
                   const std::string& name) {
  std::vector<std::string> names;
  for (const auto& set : sets) {
    if (set.name == name) return set.values;
    names.push_back(set.name);
  }
  throw data::InputError("unknown-parameter-set", "there is no " + kind + " named `" + name + "`",
                         data::suggest(name, names));
}

MuscleTendon sprenger(const std::string& muscle, const std::string& bell, double optimal_stretch) {
  MuscleTendon m;
  m.muscle = fibrous_tissue_named(muscle);
  m.tendon = fibrous_tissue_named("sprenger_tendon");
  m.max_stress_pa = 0.3e6;
  m.force_length = force_length_named(bell, optimal_stretch);
  m.blending = Blending::energies;
  m.active_stress = ActiveStress::nominal;
  return m;
}

}  // namespace

const std::vector<ParameterSet<FibrousTissue>>& fibrous_tissue_sets() {
  static const std::vector<ParameterSet<FibrousTissue>> sets{
      {"sprenger_muscle",
       "KerMor, configurations SprengerUnitCube8Elem and Debug, quoting the CMISS file 3Elem_sprenger: c1M, "
       "c2M, c3M in MPa, c4M",
       {3.56463903963e4, 3.859558659683e3, 3.05907e-4, 47.270456264135881}},
      {"roehrle_2017_muscle",
       "Röhrle, Sprenger & Schmitt 2017, doi:10.1007/s10237-016-0850-x, quoted at second hand: check it "
       "against the paper before relying on it",
       {3.56e4, 3.86e3, 3.57e-2, 42.6}},
      {"sprenger_tendon",
       "tendon beside sprenger_muscle in public code that names the same thesis as its source; digits as "
       "read "
       "there, the unit MPa is inferred and no published table was at hand",
       {2.31e6, 1.15, 7.99e6, 16.6}},
  };
  return sets;
}

const std::vector<ParameterSet<ForceLength>>& force_length_sets() {
  static const std::vector<ParameterSet<ForceLength>> sets{
      {"guenther_2007",
       "Günther, Schmitt & Wank 2007, doi:10.1007/s00422-007-0160-6",
       {not_given, 0.57, 4.0, 0.14, 3.0}},
      {"symmetric_wide",
       "bell with both widths .3 and exponents 4, as used by public continuum muscle codes",
       {not_given, 0.3, 4.0, 0.3, 4.0}},
      {"narrow_2017",
       "narrow bell beside roehrle_2017_muscle, quoted at second hand: check it against a publication before "
       "relying on it",
       {not_given, 0.15, 2.0, 0.16, 4.0}},
  };
  return sets;
}

const std::vector<ParameterSet<MuscleTendon>>& muscle_tendon_sets() {
  static const std::vector<ParameterSet<MuscleTendon>> sets{
      {"sprenger",
       "sprenger_muscle, sprenger_tendon; sigma_max .3 MPa, lambda_opt 1.4 and the bell of Günther 2007 as "
       "in "
       "KerMor's quotation of 3Elem_sprenger",
       sprenger("sprenger_muscle", "guenther_2007", 1.4)},
      {"sprenger_early", "sprenger with the optimum at the stretch 1.3, the other value in use",
       sprenger("sprenger_muscle", "guenther_2007", 1.3)},
      {"sprenger_wide", "sprenger with the wide symmetric bell",
       sprenger("sprenger_muscle", "symmetric_wide", 1.4)},
      {"roehrle_2017",
       "roehrle_2017_muscle, sprenger_tendon and narrow_2017; sigma_max .3 MPa and lambda_opt 1.4 as in "
       "sprenger",
       sprenger("roehrle_2017_muscle", "narrow_2017", 1.4)},
  };
  return sets;
}

FibrousTissue fibrous_tissue_named(const std::string& name) {
  return find(fibrous_tissue_sets(), "tissue", name);
}

ForceLength force_length_named(const std::string& name, double optimal_stretch) {
  ForceLength law = find(force_length_sets(), "force-length set", name);
  law.optimal_stretch = optimal_stretch;
  return law;
}

MuscleTendon muscle_tendon_named(const std::string& name) {
  return find(muscle_tendon_sets(), "muscle-tendon set", name);
}

}  // namespace brachium::fem
