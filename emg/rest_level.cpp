#include "emg/rest_level.hpp"

#include <fmt/format.h>

#include <cmath>

#include "data/model/error.hpp"

namespace brachium::emg {

std::size_t remove_rest(std::span<double> envelope, double rest) {
  if (!(rest >= 0.0) || !std::isfinite(rest))
    throw data::InputError("out-of-range", fmt::format("the rest level `{}` must be 0 or greater", rest));
  std::size_t floored = 0;
  for (double& e : envelope) {
    const double square = e * e - rest * rest;
    if (e > 0.0 && square > 0.0) {
      e = std::sqrt(square);
    } else {
      e = 0.0;
      ++floored;
    }
  }
  return floored;
}

}  // namespace brachium::emg
