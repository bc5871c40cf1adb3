#pragma once
/// The three forms of activation dynamics as responses u of an excitation e, with du/dp for each parameter p: the parts
/// that activation.cpp puts behind one interface. Arguments are taken as checked.

#include <cstddef>
#include <span>

#include "data/model/muscle.hpp"
#include "emg/activation.hpp"

namespace brachium::emg {

/// Each span is empty or as long as the excitation.
struct ResponseTangents {
  std::span<double> delay, dynamics_1, dynamics_2;
};

/// A delay as whole samples and a rest: d = (whole + fraction) / rate, fraction in [0, 1).
struct SplitDelay {
  std::size_t whole = 0;
  double fraction = 0.0;
};
SplitDelay split_delay(double delay_s, double rate_hz);

void continuous_response(StartUp start_up, const data::ActivationParameters& parameters,
                         std::span<const double> e, double rate_hz, std::span<double> u,
                         const ResponseTangents& tangents);

void recursive_response(StartUp start_up, const RecursionParameters& parameters, std::span<const double> e,
                        std::span<double> u, const ResponseTangents& tangents);

/// Not linear in e, hence with the gain inside; du_dgain is empty or as long as the excitation.
void first_order_response(StartUp start_up, const data::ActivationParameters& parameters,
                          std::span<const double> e, double rate_hz, double gain, std::span<double> u,
                          std::span<double> du_dgain, const ResponseTangents& tangents);

}  // namespace brachium::emg
