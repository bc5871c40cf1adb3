#pragma once
/// The seven muscles of the reference elbow (arm26 and a brachioradialis) and its trial.

#include <string>
#include <vector>

#include "hill/forward.hpp"
#include "tests/hill/storage_table.hpp"
#include "tests/support/paths.hpp"

namespace brachium::tests {

struct ElbowMuscle {
  std::string name;
  data::MuscleParameters parameters;
};

inline const std::vector<ElbowMuscle>& elbow_muscles() {
  const auto make = [](const char* name, double f0, double lo, double ls, double phi) {
    data::MuscleParameters p;
    p.max_isometric_force_N = f0;
    p.optimal_fibre_length_m = lo;
    p.tendon_slack_length_m = ls;
    p.pennation_at_optimal_rad = phi;
    return ElbowMuscle{name, p};
  };
  static const std::vector<ElbowMuscle> all = {
      make("TRIlong", 798.52, 0.134, 0.143, 0.20944), make("TRIlat", 624.3, 0.1138, 0.098, 0.15708),
      make("TRImed", 624.3, 0.1138, 0.0908, 0.15708), make("BIClong", 624.3, 0.1157, 0.2723, 0.0),
      make("BICshort", 435.56, 0.1321, 0.1923, 0.0),  make("BRA", 987.26, 0.0858, 0.0535, 0.0),
      make("BRD", 261.33, 0.1726, 0.133, 0.0)};
  return all;
}

/// Lengths, moment arms, activations and what CEINMS made of them.
struct ElbowReference {
  static constexpr double kRate = 200.0;
  std::map<std::string, std::vector<double>> length, arm, activation, fibre, force, torque;

  explicit ElbowReference(const std::string& tendon) {
    const std::string root = (reference_dir() / "ceinms_elbow").string();
    const std::string outputs = root + "/outputs/" + tendon + "_offline/";
    length = read_storage(root + "/trial/lmt.sto");
    arm = read_storage(root + "/trial/ma_elbow_flexion.sto");
    activation = read_storage(outputs + "Activations.sto");
    fibre = read_storage(outputs + "FiberLenghts.sto");
    force = read_storage(outputs + "MuscleForces.sto");
    torque = read_storage(outputs + "Torques.sto");
  }

  std::size_t frames() const { return torque.at("elbow_flexion").size(); }

  /// Elbow torque of all muscles with the given options.
  std::vector<double> moment(const hill::MuscleModelOptions& options) const {
    std::vector<double> sum(frames(), 0.0);
    hill::MuscleScratch scratch;
    hill::MuscleTrace out;
    for (const ElbowMuscle& m : elbow_muscles()) {
      const hill::MuscleTendon muscle(m.name, m.parameters, options);
      hill::forward(muscle, {kRate, length.at(m.name), {}, arm.at(m.name)}, activation.at(m.name), scratch,
                    out);
      for (std::size_t k = 0; k < sum.size(); ++k) sum[k] += out.moment_N_m[k];
    }
    return sum;
  }
};

/// Largest |a - b| over [from, end).
inline double largest_difference(const std::vector<double>& a, const std::vector<double>& b,
                                 std::size_t from = 0) {
  double worst = 0.0;
  for (std::size_t k = from; k < a.size(); ++k) worst = std::max(worst, std::abs(a[k] - b[k]));
  return worst;
}

}  // namespace brachium::tests
