#pragma once
/// Published parameters of the muscle-tendon law by name, each with where the numbers were read. There is no
/// default set: a study says which one it takes.
///
/// | set            | muscle              | tendon          | active                               |
/// |----------------|---------------------|-----------------|--------------------------------------|
/// | sprenger       | sprenger_muscle     | sprenger_tendon | guenther_2007, lambda_opt 1.4        |
/// | sprenger_early | sprenger_muscle     | sprenger_tendon | guenther_2007, lambda_opt 1.3        |
/// | sprenger_wide  | sprenger_muscle     | sprenger_tendon | symmetric_wide, lambda_opt 1.4       |
/// | roehrle_2017   | roehrle_2017_muscle | sprenger_tendon | narrow_2017, lambda_opt 1.4          |
///
/// All with sigma_max .3 MPa, nominal, and tissues blended by their energies.

#include <string>
#include <vector>

#include "fem/material/laws.hpp"

namespace brachium::fem {

template <class Values>
struct ParameterSet {
  std::string name;
  std::string source;
  Values values;
};

const std::vector<ParameterSet<FibrousTissue>>& fibrous_tissue_sets();
/// Widths and exponents; the optimal stretch belongs to the muscle and is not given here.
const std::vector<ParameterSet<ForceLength>>& force_length_sets();
const std::vector<ParameterSet<MuscleTendon>>& muscle_tendon_sets();

/// Throw InputError("unknown-parameter-set") with the nearest name.
FibrousTissue fibrous_tissue_named(const std::string& name);
ForceLength force_length_named(const std::string& name, double optimal_stretch);
MuscleTendon muscle_tendon_named(const std::string& name);

}  // namespace brachium::fem
