#include "fem/surrogate/leave_out.hpp"

#include <fmt/format.h>

#include <cmath>

#include "data/model/error.hpp"

namespace brachium::fem {
namespace {

void compare(const Surrogate& surrogate, const Sample& s, ErrorTally& tally) {
  std::vector<OutputValue> out(surrogate.outputs().size());
  surrogate.evaluate(s.at.theta_rad, s.at.activation, out);
  Eigen::VectorXd predicted(static_cast<Eigen::Index>(out.size()));
  for (std::size_t o = 0; o < out.size(); ++o) predicted(static_cast<Eigen::Index>(o)) = out[o].value;
  tally.add(s.at, s.value, predicted);
}

}  // namespace

ErrorTally::ErrorTally(std::vector<std::string> outputs)
    : squares_(outputs.size(), 0.0), reference_(outputs.size(), 0.0) {
  for (std::string& name : outputs) error_.outputs.push_back({std::move(name), 0.0, 0.0, 0.0, {}});
}

void ErrorTally::add(const StatePoint& at, const Eigen::VectorXd& known, const Eigen::VectorXd& predicted) {
  ++error_.left_out;
  for (std::size_t o = 0; o < squares_.size(); ++o) {
    const auto i = static_cast<Eigen::Index>(o);
    const double e = std::abs(predicted(i) - known(i));
    squares_[o] += e * e;
    reference_[o] += known(i) * known(i);
    if (e >= error_.outputs[o].greatest) {
      error_.outputs[o].greatest = e;
      error_.outputs[o].worst = at;
    }
  }
}

LeaveOutError ErrorTally::result(int order) const {
  LeaveOutError error = error_;
  error.order = order;
  for (std::size_t o = 0; o < squares_.size(); ++o) {
    error.outputs[o].rms = std::sqrt(squares_[o] / static_cast<double>(error_.left_out));
    error.outputs[o].relative_l2 = reference_[o] > 0.0 ? std::sqrt(squares_[o] / reference_[o])
                                   : squares_[o] > 0.0 ? HUGE_VAL
                                                       : 0.0;
  }
  return error;
}

std::optional<LeaveOutError> leave_out_lines(const SampleGrid& grid,
                                             const std::function<Surrogate(const SampleGrid&)>& make,
                                             int order) {
  ErrorTally tally(grid.samples.outputs);
  const std::size_t n = grid.theta_rad.size(), m = grid.activation.size();
  bool any = false;
  const auto without = [&](std::size_t theta_line, std::size_t alpha_line) {  // one of them past the end
    SampleGrid rest;
    rest.samples.outputs = grid.samples.outputs;
    std::vector<const Sample*> left;
    for (std::size_t i = 0; i < n; ++i) {
      if (i != theta_line) rest.theta_rad.push_back(grid.theta_rad[i]);
    }
    for (std::size_t j = 0; j < m; ++j) {
      if (j != alpha_line) rest.activation.push_back(grid.activation[j]);
    }
    for (std::size_t k = 0; k < grid.samples.size(); ++k) {
      const Sample& s = grid.samples.samples[k];
      if (k / m == theta_line || k % m == alpha_line) {
        left.push_back(&s);
      } else {
        rest.samples.samples.push_back(s);
      }
    }
    const Surrogate surrogate = make(rest);
    for (const Sample* s : left) compare(surrogate, *s, tally);
    any = true;
  };
  for (std::size_t i = 1; i + 1 < n; ++i) without(i, m);
  for (std::size_t j = 1; j + 1 < m; ++j) without(n, j);
  if (!any) return std::nullopt;
  return tally.result(order);
}

LeaveOutError error_at(const Surrogate& surrogate, const SampleSet& known) {
  known.check();
  if (known.outputs != surrogate.outputs())
    throw data::InputError("wrong-size",
                           fmt::format("the states have {} outputs, the surrogate {}, or of other names",
                                       known.outputs.size(), surrogate.outputs().size()));
  ErrorTally tally(known.outputs);
  for (const Sample& s : known.samples) compare(surrogate, s, tally);
  return tally.result(0);
}

}  // namespace brachium::fem
