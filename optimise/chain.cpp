#include "optimise/chain.hpp"

#include <algorithm>
#include <cmath>

#include "emg/activation.hpp"

namespace brachium::optimise {
namespace {

hill::MuscleParameter hill_parameter(Quantity quantity) {
  switch (quantity) {
    case Quantity::optimal_fibre_length:
      return hill::MuscleParameter::optimal_fibre_length;
    case Quantity::tendon_slack_length:
      return hill::MuscleParameter::tendon_slack_length;
    case Quantity::pennation:
      return hill::MuscleParameter::pennation;
    case Quantity::max_contraction_velocity:
      return hill::MuscleParameter::max_contraction_velocity;
    default:
      return hill::MuscleParameter::strength;
  }
}

bool acts_on_activation(const Slot& slot) {
  return is_activation(slot.quantity) || slot.quantity == Quantity::gain;
}

emg::RecursionParameters recursion(const ChainValues::Muscle& values, const ModelChoice& model) {
  return {values.recursion_1, values.recursion_2, values.activation.delay_s, values.activation.shape,
          model.recursion_rate_hz};
}

}  // namespace

void MuscleRun::activate(const Chain& chain, std::size_t muscle, const PreparedTrial& trial,
                         const std::vector<std::vector<double>>& channel_samples, const ChainValues& values,
                         bool tangents) {
  const std::size_t n = trial.excitation_count, frames = trial.frame_time_s.size();
  const auto& slots = chain.slots[muscle];
  activation_.assign(frames, 0.0);
  dactivation_.resize(slots.size());
  if (!chain.driven[muscle]) {
    activation_tangents_ = true;
    return;
  }
  excitation_.assign(n, 0.0);
  for (std::size_t k = 0; k < channel_samples.size(); ++k) {
    const double w =
        chain.weights(static_cast<Eigen::Index>(muscle), static_cast<Eigen::Index>(k)) * values.gains[k];
    if (w == 0.0) continue;
    for (std::size_t i = 0; i < n; ++i) excitation_[i] += w * channel_samples[k][i];
  }
  fine_.resize(n);
  fine_tangent_.resize(slots.size());
  emg::ActivationTangents wanted;
  bool any_gain = false;
  if (tangents) {
    for (std::size_t s = 0; s < slots.size(); ++s) {
      if (!acts_on_activation(slots[s])) continue;
      fine_tangent_[s].resize(n);
      switch (slots[s].quantity) {
        case Quantity::delay:
          wanted.delay = fine_tangent_[s];
          break;
        case Quantity::time_constant_1:
        case Quantity::recursion_1:
          wanted.dynamics_1 = fine_tangent_[s];
          break;
        case Quantity::time_constant_2:
        case Quantity::recursion_2:
          wanted.dynamics_2 = fine_tangent_[s];
          break;
        case Quantity::shape:
          wanted.shape = fine_tangent_[s];
          break;
        default:
          any_gain = true;
      }
    }
    if (any_gain) {
      neural_.resize(n);
      wanted.neural = neural_;
    }
  }
  const ModelChoice& model = chain.options.model;
  const auto& own = values.muscles[muscle];
  const bool recursive = model.activation.form == emg::ActivationForm::recursive;
  if (recursive)
    emg::activate_with_tangents(model.activation, recursion(own, model), excitation_,
                                trial.excitation_rate_hz, fine_, wanted);
  else
    emg::activate_with_tangents(model.activation, own.activation, excitation_, trial.excitation_rate_hz,
                                fine_, wanted);
  if (any_gain) {
    // da/dg_k = a'(u) w_k L e_k
    const emg::ShapedNonlinearity shaped(model.activation.nonlinearity, own.activation.shape);
    work_.resize(n);
    for (std::size_t i = 0; i < n; ++i) work_[i] = shaped.with_derivatives(neural_[i]).slope;
    for (std::size_t s = 0; s < slots.size(); ++s) {
      if (slots[s].quantity != Quantity::gain) continue;
      const std::size_t k = slots[s].channel;
      const double w = chain.weights(static_cast<Eigen::Index>(muscle), static_cast<Eigen::Index>(k));
      auto& out = fine_tangent_[s];
      if (recursive)
        emg::neural_response(model.activation, recursion(own, model), channel_samples[k],
                             trial.excitation_rate_hz, out);
      else
        emg::neural_response(model.activation, own.activation, channel_samples[k], trial.excitation_rate_hz,
                             out);
      for (std::size_t i = 0; i < n; ++i) out[i] *= w * work_[i];
    }
  }
  trial.to_frames.apply(fine_, activation_);
  for (std::size_t s = 0; s < slots.size(); ++s) {
    if (!tangents || !acts_on_activation(slots[s])) continue;
    dactivation_[s].resize(frames);
    trial.to_frames.apply(fine_tangent_[s], dactivation_[s]);
  }
  // The muscle model's domain is [0, 1]; excitations beyond are counted in the trial's window.
  for (std::size_t i = 0; i < frames; ++i) {
    if (activation_[i] >= 0.0 && activation_[i] <= 1.0) continue;
    activation_[i] = activation_[i] < 0.0 ? 0.0 : 1.0;
    for (std::size_t s = 0; s < slots.size(); ++s)
      if (tangents && acts_on_activation(slots[s])) dactivation_[s][i] = 0.0;
  }
  activation_tangents_ = tangents;
}

bool MuscleRun::update(const Chain& chain, std::size_t muscle, const PreparedTrial& trial,
                       const std::vector<std::vector<double>>& channel_samples, const ChainValues& values,
                       bool tangents) {
  const auto& own = values.muscles[muscle];
  std::vector<double> activation_key = {own.activation.delay_s,
                                        own.activation.time_constant_1_s,
                                        own.activation.time_constant_2_s,
                                        own.recursion_1,
                                        own.recursion_2,
                                        own.activation.shape};
  for (std::size_t k = 0; k < values.gains.size(); ++k)
    if (chain.weights(static_cast<Eigen::Index>(muscle), static_cast<Eigen::Index>(k)) != 0.0)
      activation_key.push_back(values.gains[k]);
  const auto& p = own.parameters;
  std::vector<double> hill_key = {p.optimal_fibre_length_m, p.tendon_slack_length_m,
                                  p.pennation_at_optimal_rad, p.max_contraction_velocity};
  const bool activation_stands =
      valid_ && activation_key == activation_key_ && (activation_tangents_ || !tangents);
  const bool force_stands = activation_stands && hill_key == hill_key_ && (force_tangents_ || !tangents);
  if (force_stands) return false;
  valid_ = false;  // until all of it has been computed
  const auto& slots = chain.slots[muscle];
  if (!activation_stands) activate(chain, muscle, trial, channel_samples, values, tangents);

  data::MuscleParameters parameters = p;
  parameters.strength = 1.0;  // the force is linear in it: applied when moments are summed
  const hill::MuscleTendon model(chain.muscles[muscle].name, parameters, chain.muscle_options);
  const hill::PathTrace path{trial.frame_rate_hz, trial.length_m[muscle], trial.velocity_m_s[muscle], {}};
  std::vector<hill::Tangent> wanted;
  if (tangents) {
    dforce_.resize(slots.size());
    for (std::size_t s = 0; s < slots.size(); ++s) {
      dforce_[s].resize(trial.frame_time_s.size());
      hill::Tangent tangent;
      tangent.dforce = dforce_[s];
      if (acts_on_activation(slots[s]))
        tangent.dactivation = dactivation_[s];
      else
        tangent.parameter = hill_parameter(slots[s].quantity);
      wanted.push_back(tangent);
    }
  }
  hill::forward(model, path, activation_, scratch_, trace_, wanted);
  activation_key_ = std::move(activation_key);
  hill_key_ = std::move(hill_key);
  force_tangents_ = tangents;
  valid_ = true;
  return true;
}

}  // namespace brachium::optimise
