#include "fem/surrogate/patches.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "data/model/error.hpp"

namespace brachium::fem {

MeshLines::MeshLines(std::vector<double> lines) : lines_(std::move(lines)) {
  for (std::size_t i = 0; i + 1 < lines_.size(); ++i) {
    if (!(lines_[i + 1] > lines_[i])) {
      throw data::InputError("bad-option", fmt::format("mesh lines must increase: {:.6g} follows {:.6g}",
                                                       lines_[i + 1], lines_[i]));
    }
    inverse_width_.push_back(1.0 / (lines_[i + 1] - lines_[i]));
  }
  if (inverse_width_.empty())
    throw data::InputError("bad-option", "a mesh of states needs at least two lines in each direction");
  const double step = (lines_.back() - lines_.front()) / static_cast<double>(cells());
  equidistant_ = true;
  for (std::size_t i = 0; i < lines_.size(); ++i) {
    equidistant_ =
        equidistant_ && std::abs(lines_[i] - lines_.front() - step * static_cast<double>(i)) < 1e-9 * step;
  }
  inverse_step_ = 1.0 / step;
}

std::size_t MeshLines::cell(double x) const {
  if (equidistant_) {
    const double at = (x - lines_.front()) * inverse_step_;
    if (!(at > 0.0)) return 0;
    return std::min(static_cast<std::size_t>(at), cells() - 1);
  }
  const auto after = std::upper_bound(lines_.begin() + 1, lines_.end() - 1, x);
  return static_cast<std::size_t>(after - lines_.begin()) - 1;
}

PatchTable::PatchTable(MeshLines theta, MeshLines alpha, int theta_degree, int alpha_degree,
                       std::size_t outputs)
    : theta_(std::move(theta)),
      alpha_(std::move(alpha)),
      theta_degree_(theta_degree),
      alpha_degree_(alpha_degree),
      outputs_(outputs),
      lanes_((outputs + 3) / 4 * 4),
      cell_size_(lanes_ * static_cast<std::size_t>((theta_degree + 1) * (alpha_degree + 1))),
      coefficients_(cell_size_ * theta_.cells() * alpha_.cells(), 0.0),
      kernel_(choose_patch_kernel()) {}

// Blocks of four outputs one after the other, so that the kernel walks through memory once.
std::size_t PatchTable::place(std::size_t i, std::size_t j, int k, int l, std::size_t output) const {
  const auto terms = static_cast<std::size_t>((theta_degree_ + 1) * (alpha_degree_ + 1));
  const auto term = static_cast<std::size_t>(k * (alpha_degree_ + 1) + l);
  return (i * alpha_.cells() + j) * cell_size_ + ((output / 4) * terms + term) * 4 + output % 4;
}

void PatchTable::evaluate(double theta, double activation, OutputValue* out) const {
  const std::size_t i = theta_.cell(theta), j = alpha_.cell(activation);
  const double dt = theta_.inverse_width(i), ds = alpha_.inverse_width(j);
  kernel_(coefficients_.data() + (i * alpha_.cells() + j) * cell_size_, theta_degree_, alpha_degree_,
          outputs_, (theta - theta_.start(i)) * dt, (activation - alpha_.start(j)) * ds, dt, ds, out);
}

}  // namespace brachium::fem
