#pragma once
/// Calibration as a least-squares problem: excitations and angle in, moment out, parameters free by muscle,
/// by group or for all.
///
///     r_i = (M_model(t_i; x) - M_reference(t_i)) / sigma,      t_i the reference's own time stamps
///
/// | symbol | identifier | unit | meaning                                                              |
/// |--------|------------|------|----------------------------------------------------------------------|
/// | e_k    | excitations| 1    | channel excitations                                                  |
/// | g_k    | gain       | 1    | factor on channel k                                                  |
/// | s_m    | strength   | 1    | factor on muscle m's maximum force; the moment is linear in it       |
/// | sigma  | scale      | N m  | one scale for the whole set of trials: pooled SD, or a given torque  |
///
/// One scale for the set, not one a trial: an isometric hold has no variance of its own, and a weight of
/// 1 / variance (as in CEINMS) would let it outweigh all other trials.

#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "data/model/scene.hpp"
#include "data/model/session.hpp"
#include "data/model/subject.hpp"
#include "optimise/model_choice.hpp"
#include "optimise/problem.hpp"
#include "optimise/statistics.hpp"

namespace brachium::optimise {

/// What a calibration is given of one trial. All on the trial's clock; rates may differ.
struct CalibrationTrial {
  std::string name;
  std::vector<data::Signal> excitations;  ///< one a channel, info.name the channel [1]; all on one grid
  data::Signal angle;                     ///< [rad]
  std::optional<data::Signal> velocity;   ///< [rad/s]; from the angle (cubic spline) if absent
  data::Signal moment;                    ///< reference moment at the joint [N m]
  /// Which of the moment's samples are to be compared (a dynamometer's constant velocity, a hinge axis that
  /// is known); as long as the moment, or empty: all.
  std::vector<bool> use;
};

/// A trial's first signals of quantity excitation, joint_angle, joint_velocity and joint_moment (of the given
/// coordinate where signals name one). Throws InputError("missing-signal") naming trial and quantity: an
/// absent reference moment is named "missing-moment".
CalibrationTrial calibration_trial(const data::Trial& trial, const std::string& coordinate);

enum class Quantity {
  strength,                  ///< [1]
  optimal_fibre_length,      ///< [m]
  tendon_slack_length,       ///< [m]
  pennation,                 ///< at optimal length [rad]
  max_contraction_velocity,  ///< [optimal fibre lengths / s]
  delay,                     ///< [s]
  time_constant_1,           ///< [s], continuous form
  time_constant_2,           ///< [s], continuous form
  recursion_1,               ///< g1 [1], recursive form
  recursion_2,               ///< g2 [1], recursive form
  shape,                     ///< A [1]
  gain                       ///< of a channel [1]
};
std::string to_string(Quantity quantity);  ///< "tendon_slack_length"
Quantity parse_quantity(
    const std::string& name);  ///< throws InputError("unknown-parameter") with the nearest

enum class Scope { each, group, global };  ///< one value a muscle (channel), a group, or for all
std::string to_string(Scope scope);
Scope parse_scope(const std::string& name);  ///< "muscle" (or "channel"), "group", "global"

/// One kind of parameter set free. Lengths, pennation and v_max that are shared by a group or by all are
/// shared as a factor on each muscle's own start (parameter "..._factor"); other quantities as a value.
struct FreeQuantity {
  Quantity quantity = Quantity::strength;
  Scope scope = Scope::each;
  std::vector<std::string> only;  ///< muscles, groups or channels it is restricted to (patterns); empty: all
  std::optional<double> lower, upper;
  bool relative = false;             ///< bounds, and a prior, are factors on the start
  std::optional<double> prior_mean;  ///< default: the start
  std::optional<double> prior_sd;    ///< none: no prior
};
/// Bounds used where none are given: strength 0.5 - 2.5, lengths x 0.85 - 1.15, pennation x 0.8 - 1.2,
/// v_max x 0.5 - 1.5, delay 0 - 0.125 s, time constants 0.0075 - 0.060 s, recursion -0.95 - -0.05, shape
/// -2.999 - -0.001 (Lloyd & Besier 2003, doi:10.1016/S0021-9290(03)00010-1; Buchanan et al. 2004) or, piecewise,
/// 0.001 - 0.119 (Manal & Buchanan 2003, doi:10.1016/S0021-9290(03)00152-0), gain 0.05 - 20.
FreeQuantity with_default_bounds(FreeQuantity free, emg::Nonlinearity nonlinearity);

struct CalibrationProblemOptions {
  std::string coordinate;  ///< of the moment; default: the scene's only one
  ModelChoice model;
  std::vector<FreeQuantity> free;
  std::optional<double> scale_N_m;  ///< sigma; default: pooled SD of the reference about the set's mean
  /// Independent samples a second that the data are believed to hold. Residuals are then weighted by
  /// sqrt(independent_rate / sampling rate), so that priors count as many observations as they should; sigma
  /// is then the expected error of the moment. Default: every sample counts fully.
  std::optional<double> independent_rate_hz;
  std::map<std::string, double> channel_gains;  ///< gains of channels (start, or fixed); 1 where absent
  double edge_s = 0.0;       ///< dropped at both ends of each trial's common span, beside what follows
  std::size_t decimate = 1;  ///< take every n-th sample of the reference as a residual
  std::size_t threads = 1;   ///< muscles and trials in parallel (0: all cores); results do not depend on it
};

/// What was left out of a trial, and what was used.
struct TrialWindow {
  std::string name;
  double first_time_s = 0.0, last_time_s = 0.0;
  std::size_t used = 0;               ///< reference samples that became residuals
  std::size_t before = 0, after = 0;  ///< reference samples outside the window, by end
  std::size_t masked = 0;             ///< reference samples inside it that `use` leaves out
  std::size_t above_one = 0;          ///< excitation samples above 1, all channels, at starting gains
  std::size_t below_zero = 0;         ///< and below 0, as zero-lag filters leave them
};

/// One muscle on one trial, at the reference's samples inside the common span (frames).
struct MuscleTraces {
  std::string muscle;
  std::vector<double> activation, force_N, moment_N_m, fibre_length_m;
};

/// How often muscles were run since the evaluator was made.
struct EvaluationCount {
  std::size_t points = 0;
  std::size_t muscle_trials = 0;  ///< full runs of one muscle on one trial
  std::size_t reused = 0;         ///< taken from the cache instead
};

/// The problem; const and shared by threads. A muscle is run again only where a parameter other than its
/// strength has changed since the last point.
class CalibrationProblem final : public LeastSquaresProblem {
 public:
  /// Throws InputError with every mistake found: "no-trials", "duplicate-trial", "unmapped-channel",
  /// "missing-moment", "zero-variance-moment" (the pooled reference moment does not vary and no scale is
  /// given), "empty-window", "rate-mismatch", "angle-out-of-range", "bad-parameter", "bad-bounds",
  /// "no-match". With nothing set free it is still good for prediction.
  CalibrationProblem(data::Scene scene, std::vector<CalibrationTrial> trials,
                     CalibrationProblemOptions options);
  ~CalibrationProblem() override;

  const std::vector<Parameter>& parameters() const override;
  std::size_t residual_count() const override;
  std::string residual_name(std::size_t i) const override;
  std::unique_ptr<Evaluator> evaluator() const override;

  const data::Scene& scene() const;
  const CalibrationProblemOptions& options() const;
  const std::vector<TrialWindow>& windows() const;
  const std::vector<std::string>& channels() const;  ///< that drive a muscle
  const std::vector<std::string>& undriven() const;
  double scale_N_m() const;                         ///< sigma
  double residual_weight(std::size_t trial) const;  ///< r = weight (M - M_reference) [1 / (N m)]
  std::vector<ResidualBlock> blocks() const;
  std::vector<double> times_s(std::size_t trial) const;
  std::vector<double> reference_N_m(std::size_t trial) const;  ///< at times_s
  /// Modelled moment at times_s, from residuals as evaluate() gave them.
  std::vector<double> modelled_N_m(std::size_t trial, const Eigen::VectorXd& residuals) const;

  std::vector<double> frame_times_s(std::size_t trial) const;
  std::vector<MuscleTraces> muscle_traces(std::size_t trial, const Eigen::VectorXd& x) const;
  /// Muscles (with fixed parameters where nothing is free), gains and model at x; no verdicts.
  data::Subject subject(const Eigen::VectorXd& x) const;
  /// Indices of the strength parameters: the moment is linear in them.
  std::vector<std::size_t> strength_parameters() const;
  /// Free gains and free strengths of muscles they drive, neither with a prior (indices of parameters): what
  /// the data fix without a maximal contraction is their product; what tells them apart is only the model's
  /// curvature.
  std::vector<std::pair<std::size_t, std::size_t>> gain_strength_pairs() const;
  /// The same trials with other excitations on the same grids: for studies of errors in the excitation.
  /// samples[trial][channel], channels in the order of channels().
  using Samples = std::vector<std::vector<std::vector<double>>>;
  const Samples& excitations() const;
  CalibrationProblem with_excitations(Samples samples) const;
  double excitation_rate_hz(std::size_t trial) const;
  static EvaluationCount count(const Evaluator& evaluator);  ///< of an evaluator that this class made

  struct Impl;

 private:
  explicit CalibrationProblem(std::shared_ptr<const Impl> impl);
  std::shared_ptr<const Impl> impl_;
};

}  // namespace brachium::optimise
