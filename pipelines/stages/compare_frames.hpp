#pragma once
/// What pipelines.compare holds against each other, frame by frame, and the tables it makes of that.
///
/// | table              | rows                                                                                       |
/// |--------------------|--------------------------------------------------------------------------------------------|
/// | scores             | models by trial, and pooled                                                                |
/// | bias_by_angle      | models by interval of the joint angle (with `kinematics`)                                  |
/// | bias_by_activation | models by interval of the mean activation of all muscles (with `activation`)               |
/// | parts              | models by part, active and passive, each against that of the first model                   |
/// | muscles            | muscles of the models that tell them: their moment, and whether the continuum model has it |
/// | same_muscles       | a model that lacks muscles against another one's moment of the muscles it has              |

#include <map>
#include <string>
#include <vector>

#include "data/model/table.hpp"
#include "pipelines/stage.hpp"

namespace brachium::pipelines {

inline constexpr const char* reference_name = "reference";

/// One model on one trial: the reference's samples inside the span of both, and everything else there.
struct CompareFrames {
  std::string trial;
  bool seen = false;  ///< by the calibration
  std::vector<double> time_s, reference_n_m, modelled_n_m;
  std::vector<double> passive_n_m;                        ///< empty: not told apart
  std::vector<double> angle_rad, activation;              ///< empty: not wired
  std::map<std::string, std::vector<double>> muscle_n_m;  ///< force times moment arm; empty: not told
};

struct CompareModel {
  std::string name;
  std::vector<std::string> lacks;  ///< muscles of the scene that it has not
  std::vector<CompareFrames> trials;
  /// Trials that the calibration has not seen; all where it has seen all.
  std::vector<const CompareFrames*> judged() const;
};

/// Throws InputError: "no-common-window" naming model and trial, and as signal_of.
std::vector<CompareModel> compare_models(const StageContext& context, const std::string& coordinate,
                                         const std::vector<std::string>& learnt);

data::Table score_rows(const std::vector<CompareModel>& models);
/// `of_angle`: else of activation. Equal intervals over what the judged trials span; those without frames
/// have no row.
data::Table bias_rows(const std::vector<CompareModel>& models, bool of_angle, int intervals);
data::Table part_rows(const std::vector<CompareModel>& models);
data::Table muscle_rows(const std::vector<CompareModel>& models);
data::Table same_muscle_rows(const std::vector<CompareModel>& models);

}  // namespace brachium::pipelines
