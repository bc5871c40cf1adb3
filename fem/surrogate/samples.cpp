#include "fem/surrogate/samples.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "data/model/error.hpp"

namespace brachium::fem {
namespace {

constexpr double slack = 1e-9;       // of the range: rounding of degrees to radians
constexpr double same_value = 1e-9;  // two states are one, relative to the range of all

std::string name_of(const StatePoint& s) {
  return fmt::format("({:.6g} rad, {:.6g})", s.theta_rad, s.activation);
}

// Distinct values, those within a tolerance taken as one.
std::vector<double> distinct(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const double tolerance = same_value * std::max(values.back() - values.front(), 1e-300);
  std::vector<double> out{values.front()};
  for (const double v : values) {
    if (v - out.back() > tolerance) out.push_back(v);
  }
  return out;
}

std::size_t place(const std::vector<double>& values, double v) {
  const auto after = std::lower_bound(values.begin(), values.end(), v);
  if (after == values.begin()) return 0;
  if (after == values.end()) return values.size() - 1;
  const auto i = static_cast<std::size_t>(after - values.begin());
  return v - values[i - 1] < values[i] - v ? i - 1 : i;
}

}  // namespace

bool StateBounds::contains(const StatePoint& s) const {
  const double dt = slack * theta_span(), da = slack * activation_span();
  return s.theta_rad >= theta_lower_rad - dt && s.theta_rad <= theta_upper_rad + dt &&
         s.activation >= activation_lower - da && s.activation <= activation_upper + da;
}

void StateBounds::check() const {
  if (!(theta_lower_rad < theta_upper_rad) || !(activation_lower < activation_upper) ||
      !std::isfinite(theta_span()) || !(activation_lower >= 0.0) || !(activation_upper <= 1.0)) {
    throw data::InputError(
        "bad-range",
        fmt::format("angles {:.6g} to {:.6g} rad and activations {:.6g} to {:.6g} span no rectangle of "
                    "states with activations in [0, 1]",
                    theta_lower_rad, theta_upper_rad, activation_lower, activation_upper));
  }
}

bool SampleSet::has_derivatives() const {
  const auto n = static_cast<Eigen::Index>(outputs.size());
  return std::all_of(samples.begin(), samples.end(),
                     [n](const Sample& s) { return s.dtheta.size() == n && s.dalpha.size() == n; });
}

void SampleSet::check() const {
  const auto n = static_cast<Eigen::Index>(outputs.size());
  if (n == 0 || samples.empty())
    throw data::InputError("bad-sample", "a surrogate needs at least one output and one state");
  for (const Sample& s : samples) {
    const auto right = [n](const Eigen::VectorXd& v, bool optional) {
      return (v.size() == n || (optional && v.size() == 0)) && v.allFinite();
    };
    if (!std::isfinite(s.at.theta_rad) || !std::isfinite(s.at.activation) || !right(s.value, false) ||
        !right(s.dtheta, true) || !right(s.dalpha, true)) {
      throw data::InputError(
          "bad-sample",
          fmt::format("the state at {} needs {} finite outputs and as many derivatives, or none",
                      name_of(s.at), n));
    }
  }
  std::vector<StatePoint> sorted;
  for (const Sample& s : samples) sorted.push_back(s.at);
  std::sort(sorted.begin(), sorted.end(), [](const StatePoint& a, const StatePoint& b) {
    return a.theta_rad != b.theta_rad ? a.theta_rad < b.theta_rad : a.activation < b.activation;
  });
  for (std::size_t i = 1; i < sorted.size(); ++i) {
    if (sorted[i].theta_rad == sorted[i - 1].theta_rad && sorted[i].activation == sorted[i - 1].activation) {
      throw data::InputError("bad-sample", fmt::format("the state at {} is there twice", name_of(sorted[i])));
    }
  }
}

StateBounds SampleGrid::bounds() const {
  return {theta_rad.front(), theta_rad.back(), activation.front(), activation.back()};
}

SampleGrid as_grid(const SampleSet& set) {
  set.check();
  std::vector<double> theta, alpha;
  for (const Sample& s : set.samples) {
    theta.push_back(s.at.theta_rad);
    alpha.push_back(s.at.activation);
  }
  SampleGrid grid{distinct(theta), distinct(alpha), {set.outputs, {}}};
  const std::size_t n = grid.activation.size();
  std::vector<const Sample*> at(grid.theta_rad.size() * n, nullptr);
  for (const Sample& s : set.samples)
    at[place(grid.theta_rad, s.at.theta_rad) * n + place(grid.activation, s.at.activation)] = &s;
  for (std::size_t k = 0; k < at.size(); ++k) {
    if (at[k] == nullptr) {
      throw data::InputError(
          "not-a-grid",
          fmt::format("{} states do not fill the grid of {} angles and {} activations: {} is missing",
                      set.size(), grid.theta_rad.size(), n,
                      name_of({grid.theta_rad[k / n], grid.activation[k % n]})),
          "give every pair, or use a sparse grid");
    }
    grid.samples.samples.push_back(*at[k]);
  }
  return grid;
}

std::vector<StatePoint> grid_states(const std::vector<double>& theta, const std::vector<double>& activation) {
  std::vector<StatePoint> states;
  for (const double t : theta) {
    for (const double a : activation) states.push_back({t, a});
  }
  return states;
}

std::vector<double> equidistant(double lower, double upper, std::size_t n) {
  if (n == 0) return {};
  if (n == 1) return {lower};
  std::vector<double> values(n);
  for (std::size_t i = 0; i < n; ++i)
    values[i] = lower + (upper - lower) * static_cast<double>(i) / static_cast<double>(n - 1);
  values.back() = upper;
  return values;
}

}  // namespace brachium::fem
