#pragma once
/// Which chain a subject's parameters are valid with: the choices of emg/ and hill/ in one value, and as the
/// texts that definitions and subject files hold.

#include <map>
#include <string>

#include "emg/activation.hpp"
#include "hill/muscle_tendon.hpp"

namespace brachium::optimise {

using emg::parse_activation_form;
using emg::parse_start_up;
using emg::to_string;

struct ModelChoice {
  std::string curves = "degroote_fregly_2016";  ///< curve set of hill/
  hill::TendonKind tendon = hill::TendonKind::rigid;
  hill::FibreVelocity fibre_velocity = hill::FibreVelocity::zero_lag;
  hill::Compatibility compatibility = hill::Compatibility::none;
  double optimal_length_coupling = 0.0;  ///< p of l_opt(a) = l_opt (1 + p (1 - a)); CEINMS: 0.15
  emg::ActivationModel activation;       ///< continuous or recursive; no exact derivatives for first_order
  double recursion_rate_hz = 0.0;        ///< recursive form: the rate its coefficients are valid at

  hill::MuscleModelOptions muscle_options() const;
  /// As Subject::model keeps it: "curves", "tendon", "fibre_velocity", "compatibility",
  /// "optimal_length_coupling", "activation_form", "start_up", "nonlinearity", "recursion_rate_hz".
  std::map<std::string, std::string> to_map() const;
  /// Absent keys keep their defaults. Throws InputError("unknown-key") or as the parsers of emg/ and hill/
  /// do.
  static ModelChoice from_map(const std::map<std::string, std::string>& map);
};

}  // namespace brachium::optimise
