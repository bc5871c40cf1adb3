#include "fem/surrogate/surrogate.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <numbers>

#include "data/model/error.hpp"

namespace brachium::fem {

Surrogate::Surrogate(std::string method, std::vector<std::string> outputs, StateBounds bounds,
                     std::size_t states, PatchTable patches)
    : method_(std::move(method)),
      outputs_(std::move(outputs)),
      bounds_(bounds),
      states_(states),
      patches_(std::move(patches)) {
  bounds_.check();
}

std::size_t Surrogate::output(const std::string& name) const {
  const auto found = std::find(outputs_.begin(), outputs_.end(), name);
  if (found == outputs_.end())
    throw data::InputError("unknown-output", fmt::format("the surrogate has no output `{}`", name),
                           data::suggest(name, outputs_));
  return static_cast<std::size_t>(found - outputs_.begin());
}

void Surrogate::refuse(double theta, double activation, const std::string& where) const {
  constexpr double degrees = 180.0 / std::numbers::pi;
  throw data::InputError(
      "outside-surrogate",
      fmt::format("{}angle {:.6g} deg with activation {:.6g} lies outside the surrogate's states, {:.6g} to "
                  "{:.6g} deg and {:.6g} to {:.6g}",
                  where, theta * degrees, activation, bounds_.theta_lower_rad * degrees,
                  bounds_.theta_upper_rad * degrees, bounds_.activation_lower, bounds_.activation_upper),
      "compute states there and make the surrogate again");
}

void Surrogate::evaluate(double theta, double activation, std::span<OutputValue> out) const {
  if (out.size() != outputs_.size())
    throw data::InputError(
        "wrong-size", fmt::format("room for {} outputs, the surrogate has {}", out.size(), outputs_.size()));
  if (!bounds_.contains({theta, activation})) refuse(theta, activation, "");
  patches_.evaluate(theta, activation, out.data());
}

Surrogate::Series Surrogate::evaluate_series(std::span<const double> theta,
                                             std::span<const double> activation) const {
  if (theta.size() != activation.size()) {
    throw data::InputError("wrong-size",
                           fmt::format("{} angles and {} activations", theta.size(), activation.size()));
  }
  const auto n = static_cast<Eigen::Index>(theta.size()), m = static_cast<Eigen::Index>(outputs_.size());
  Series series{Eigen::MatrixXd(m, n), Eigen::MatrixXd(m, n), Eigen::MatrixXd(m, n)};
  std::vector<OutputValue> at(outputs_.size());
  for (std::size_t i = 0; i < theta.size(); ++i) {
    if (!bounds_.contains({theta[i], activation[i]}))
      refuse(theta[i], activation[i], fmt::format("sample {}: ", i));
    patches_.evaluate(theta[i], activation[i], at.data());
    const auto column = static_cast<Eigen::Index>(i);
    for (Eigen::Index o = 0; o < m; ++o) {
      const OutputValue& v = at[static_cast<std::size_t>(o)];
      series.value(o, column) = v.value;
      series.dtheta(o, column) = v.dtheta;
      series.dalpha(o, column) = v.dalpha;
    }
  }
  return series;
}

}  // namespace brachium::fem
