// A program of somebody else's over the installed libraries: half an activation at optimal length adds half of the
// maximal force to what the muscle carries at rest.

#include <cmath>
#include <cstdio>
#include <vector>

#include "emg/activation.hpp"
#include "hill/forward.hpp"

int main() {
  using namespace brachium;
  data::MuscleParameters p;
  p.max_isometric_force_N = 600.0;
  p.optimal_fibre_length_m = 0.1;
  p.tendon_slack_length_m = 0.2;
  p.pennation_at_optimal_rad = 0.0;
  hill::MuscleModelOptions options;
  options.velocity = hill::FibreVelocity::none;
  options.curves = hill::CurveSet::named("guenther_2007");
  const hill::MuscleTendon muscle("BIC", p, options);
  const std::vector<double> excitation(50, 0.5), length(50, 0.3);
  std::vector<double> activation(50);
  emg::ActivationModel model;
  model.nonlinearity = emg::Nonlinearity::none;
  emg::activate(model, data::ActivationParameters{}, excitation, 200.0, activation);
  hill::MuscleScratch scratch;
  hill::MuscleTrace active, resting;
  hill::forward(muscle, {200.0, length, {}, {}}, activation, scratch, active);
  hill::forward(muscle, {200.0, length, {}, {}}, std::vector<double>(50, 0.0), scratch, resting);
  const double added_N = active.force_N.back() - resting.force_N.back();
  std::printf("%.6f N\n", added_N);
  return std::abs(added_N - 300.0) < 1e-9 * 300.0 ? 0 : 1;
}
