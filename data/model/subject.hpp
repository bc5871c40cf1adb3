#pragma once
/// A calibrated subject: the parameters a calibration found, how far each is to be believed, and where they come from.

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "data/model/muscle.hpp"

namespace brachium::data {

/// What a calibration says of one free parameter.
struct ParameterVerdict {
  std::string muscle;     ///< muscle, group or "*" (global) it belongs to; channel for gains
  std::string parameter;  ///< e.g. "tendon_slack_length_m"
  std::string unit;
  double start = 0.0;
  double fitted = 0.0;
  double lower = 0.0;
  double upper = 0.0;
  double standard_error = 0.0;  ///< of the fit; infinite values are written as the text "not identified"
  double interval_lower = 0.0;  ///< 95 % interval
  double interval_upper = 0.0;
  double bias = 0.0;    ///< estimated bias from errors in the excitation, already removed where corrected
  std::string verdict;  ///< "identified", "AT LOWER BOUND", "AT UPPER BOUND", "NOT IDENTIFIED"
  std::string remark;   ///< e.g. "correlated 0.98 with BRA strength"
};

struct SubjectMuscle {
  std::string name;
  std::string group;
  MuscleParameters parameters;
  ActivationParameters activation;
};

struct Subject {
  std::string name;
  std::vector<SubjectMuscle> muscles;
  std::map<std::string, double> channel_gains;  ///< factor on the normalised excitation of a channel
  /// Model choices the parameters are valid with: "curves", "tendon", "activation_form", "nonlinearity",
  /// "recursion_rate_hz" (recursive form only), ...
  std::map<std::string, std::string> model;
  std::vector<ParameterVerdict> verdicts;
  std::map<std::string, double> statistics;       ///< unit in the name: "training_rmse_N_m", ...
  std::map<std::string, std::string> provenance;  ///< session, scene, trials, program version, options

  const SubjectMuscle& muscle(const std::string& name) const;  ///< throws InputError("missing-muscle")
};

}  // namespace brachium::data
