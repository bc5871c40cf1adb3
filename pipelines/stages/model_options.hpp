#pragma once
/// Options that say which muscle model is meant, shared by the stages that run or calibrate one, and how such stages
/// read their inputs.

#include <string>
#include <vector>

#include "optimise/calibration.hpp"
#include "optimise/model_choice.hpp"
#include "pipelines/stage.hpp"

namespace brachium::pipelines {

std::vector<OptionSpec> activation_option_specs();  ///< activation_form, nonlinearity, start_up
std::vector<OptionSpec>
muscle_option_specs();  ///< curves, tendon, fibre_velocity, compatibility, optimal_length_coupling
optimise::ModelChoice activation_choice(const Options& options);
optimise::ModelChoice model_choice(const Options& options);  ///< both groups

/// The subject a stage's output carries; InputError("missing-subject") if it carries none.
const data::Subject& subject_of(const StageData& data);

/// An excitation of a trial: where it stands, its header (unit "1") and the factor to its samples.
struct ExcitationChannel {
  std::size_t signal = 0;
  data::SignalInfo info;
  double gain = 1.0;
};

/// A trial's excitations, with the subject's gains where it has some; samples are not read. Throws InputError:
/// "missing-signal", "rate-mismatch" (channels on different grids), "not-normalised" (an envelope in V without a
/// subject's gain).
std::vector<ExcitationChannel> excitation_channels(const StageData& excitation, const std::string& trial,
                                                   const data::Subject* subject);

/// Which samples of a reference moment are to be compared: its stage's signal `use`; empty where there is none.
std::vector<bool> use_of(const StageData& moment, const std::string& trial);

/// What a calibration is given of each trial: excitations, kinematics and reference moment of three inputs.
std::vector<optimise::CalibrationTrial> calibration_trials(const StageContext& context,
                                                           const data::Coordinate& coordinate,
                                                           const std::vector<std::string>& trials);

}  // namespace brachium::pipelines
