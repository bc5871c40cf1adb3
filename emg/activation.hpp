#pragma once
/// Excitation to activation: e(t) -> u(t) -> a(t), with exact derivatives with respect to every parameter.
///
/// | symbol   | identifier                            | unit | meaning                                             |
/// |----------|---------------------------------------|------|-----------------------------------------------------|
/// | e        | excitation                            | 1    | normalised linear envelope; may exceed 1            |
/// | γ        | gain                                  | 1    | factor on e                                         |
/// | d        | delay_s                               | s    | electromechanical delay, resolved below the sample  |
/// | τ1, τ2   | time_constant_1_s, time_constant_2_s  | s    | time constants; u does not change if they swap      |
/// | g1, g2   | g1, g2                                | 1    | coefficients of the recursion (C1, C2 in CEINMS)    |
/// | u        | neural                                | 1    | neural activation                                   |
/// | A        | shape                                 | 1    | shape factor of the nonlinearity                    |
/// | a        | activation                            | 1    | muscle activation                                   |
///
/// continuous   τ1 τ2 u'' + (τ1 + τ2) u' + u = γ e(t - d), e linear between its samples (first-order hold), solved
///              exactly: the result does not depend on the sampling rate but through e itself.
/// recursive    u_k = b1 γ e(t_k - d) - b2 u_(k-1) - b3 u_(k-2), b2 = g1 + g2, b3 = g1 g2, b1 = 1 + b2 + b3
///              (Lloyd & Besier 2003, doi:10.1016/S0021-9290(03)00010-1; Buchanan et al. 2004,
///              doi:10.1123/jab.20.4.367). It answers one sample earlier than the continuous form of the same poles.
/// first_order  a' = (γ e(t - d) - a) / τ, τ = τ1 (0.5 + 1.5 a) while a rises, τ2 / (0.5 + 1.5 a) while it falls
///              (Thelen 2003, doi:10.1115/1.1531112, eq. 1); τ1 activation, τ2 deactivation. Its a is called u here.

#include <array>
#include <span>
#include <string>

#include "data/model/muscle.hpp"
#include "emg/nonlinearity.hpp"

namespace brachium::emg {

enum class ActivationForm { continuous, recursive, first_order };

/// What was before the first sample.
enum class StartUp {
  steady_state,  ///< e = e_0 for ever, and u has settled to it (the default)
  rest,          ///< e = 0, u = 0
  ceinms  ///< recursive form only: u = 0 before the first sample, and at the third sample both past values of
          ///< u are set to the mean of the first two (delayed) excitations, as CEINMS does
};

std::string to_string(ActivationForm form);
std::string to_string(StartUp start_up);
ActivationForm parse_activation_form(
    const std::string& name);                     ///< throws InputError("unknown-activation-form")
StartUp parse_start_up(const std::string& name);  ///< throws InputError("unknown-start-up")

struct ActivationModel {
  ActivationForm form = ActivationForm::continuous;
  Nonlinearity nonlinearity = Nonlinearity::exponential;
  StartUp start_up = StartUp::steady_state;
};

/// The recursion's own parameters. They mean something only together with the rate they were fitted at.
struct RecursionParameters {
  double g1 = -0.5;  ///< |g1| < 1; g1 > 0 (an oscillating pole) has no time constant
  double g2 = -0.5;  ///< |g2| < 1
  double delay_s = 0.0;
  double shape = -1.5;
  double rate_hz = 0.0;  ///< rate that g1, g2 belong to
};

/// Where activate_with_tangents writes. Each span is empty (not wanted) or as long as the excitation.
struct ActivationTangents {
  std::span<double> neural;      ///< u
  std::span<double> gain;        ///< da/dγ
  std::span<double> delay;       ///< da/dd [1/s]
  std::span<double> dynamics_1;  ///< da/dτ1 [1/s], or da/dg1 for RecursionParameters
  std::span<double> dynamics_2;  ///< da/dτ2 [1/s], or da/dg2
  std::span<double> shape;       ///< da/dA
};

/// Activation at the excitation's own samples. excitation and activation have equal length and must not overlap.
/// No memory is allocated. Nothing is clamped: an excitation above 1 gives an activation above 1.
/// Throws data::InputError ("out-of-range") for parameters outside their domain: delay >= 0, time constants > 0
/// (between 1e-3 and 1e7 sample periods), |g| < 1, shape (see nonlinearity.hpp), rate > 0; ("rate-mismatch") for
/// RecursionParameters used at another rate than their own; ("not-finite") for NaN or Inf samples.
/// `recursive` with time constants uses g = -exp(-dt/τ).
void activate(const ActivationModel& model, const data::ActivationParameters& parameters,
              std::span<const double> excitation, double rate_hz, std::span<double> activation,
              double gain = 1.0);
/// The recursive form by its own coefficients; model.form must be recursive.
void activate(const ActivationModel& model, const RecursionParameters& parameters,
              std::span<const double> excitation, double rate_hz, std::span<double> activation,
              double gain = 1.0);

/// As activate, and the exact derivatives of a. Derivatives with respect to the delay are one-sided (towards a
/// longer delay) where the recursive form meets a kink of the interpolated excitation, that is at whole samples;
/// the continuous form has none. The derivative with respect to shape where `none` is chosen is 0.
void activate_with_tangents(const ActivationModel& model, const data::ActivationParameters& parameters,
                            std::span<const double> excitation, double rate_hz, std::span<double> activation,
                            const ActivationTangents& tangents, double gain = 1.0);
void activate_with_tangents(const ActivationModel& model, const RecursionParameters& parameters,
                            std::span<const double> excitation, double rate_hz, std::span<double> activation,
                            const ActivationTangents& tangents, double gain = 1.0);

/// The linear part alone, u = L e (continuous and recursive forms): a muscle driven by several channels with gains
/// γ_k has u = L(Σ γ_k w_k e_k), so that ∂a/∂γ_k = a'(u) w_k L e_k.
void neural_response(const ActivationModel& model, const data::ActivationParameters& parameters,
                     std::span<const double> excitation, double rate_hz, std::span<double> neural);
void neural_response(const ActivationModel& model, const RecursionParameters& parameters,
                     std::span<const double> excitation, double rate_hz, std::span<double> neural);

/// g = -exp(-dt/τ) of a time constant, and back; the way back throws InputError for g >= 0 (no time constant).
double recursion_coefficient(double time_constant_s, double rate_hz);
double time_constant(double g, double rate_hz);
/// The recursion uses e_k where the exact solution uses e up to t_k only on average: with delay d it answers like the
/// continuous model of the same poles with delay d - dt (and so needs d + dt to answer like one with delay d). The
/// difference left is of second order in dt/τ. [s], may be negative.
double equivalent_continuous_delay(double recursion_delay_s, double rate_hz);

/// For use inside an ODE solver: state x = (x1, x2), x1' = (γ e(t - d) - x1)/τ1, x2' = (x1 - x2)/τ2, u = x2.
/// The caller supplies the delayed excitation.
std::array<double, 2> neural_state_rate(const data::ActivationParameters& parameters,
                                        double delayed_excitation, const std::array<double, 2>& state);
/// Rate of Thelen's first-order activation.
double first_order_rate(const data::ActivationParameters& parameters, double delayed_excitation,
                        double activation);

/// Throws InputError listing every parameter outside its domain, with the muscle's name in the message.
void check_parameters(const ActivationModel& model, const data::ActivationParameters& parameters,
                      const std::string& muscle);
void check_parameters(const ActivationModel& model, const RecursionParameters& parameters,
                      const std::string& muscle);

}  // namespace brachium::emg
