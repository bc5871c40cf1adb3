#include "fem/solve/sensitivity.hpp"

#include <fmt/format.h>

#include <Eigen/QR>
#include <cmath>
#include <vector>

namespace brachium::fem {
namespace {

constexpr double difference = 1e-5;  // of a cell's size
constexpr double held_part = 1e-5;   // of an amplitude
constexpr double tolerance = 1e-9;
constexpr double contact_tolerance = 1e-4;  // where contacts have multipliers
constexpr double slow = 0.3;  // contraction above which a new factor is made
constexpr int most = 60;

[[noreturn]] void unknown(const std::string& code, const std::string& what, const std::string& name) {
  throw data::InputError(
      code, fmt::format("a rate is given for the {} `{}`, which the problem has not", what, name),
      "rates are named as the problem's conditions and regions");
}

/// Anderson's acceleration of a fixed-point iteration z <- g(z) with all of its history, which for a linear g is
/// GMRES (Walker & Ni 2011, doi:10.1137/10078356X): multipliers of contact alone converge too slowly.
class Acceleration {
 public:
  /// `step` = g(z) - z. The next z.
  Eigen::VectorXd next(const Eigen::VectorXd& z, const Eigen::VectorXd& step) {
    Eigen::VectorXd out = z + step;
    if (z_.size() > 0) {
      const Eigen::Index n = moves_.cols();
      moves_.conservativeResize(z.size(), n + 1);
      changes_.conservativeResize(z.size(), n + 1);
      moves_.col(n) = z - z_;
      changes_.col(n) = step - step_;
      const Eigen::VectorXd share = changes_.completeOrthogonalDecomposition().solve(step);
      out -= (moves_ + changes_) * share;
    }
    z_ = z;
    step_ = step;
    return out;
  }

 private:
  Eigen::VectorXd z_, step_;
  Eigen::MatrixXd moves_, changes_;
};

}  // namespace

LoadPoint Sensitivity::direction_of(const LoadRate& rate) const {
  const Problem& problem = equations_.problem();
  LoadPoint d{Eigen::VectorXd::Zero(load_.amplitude.size()), Eigen::VectorXd::Zero(load_.activation.size()),
              0.0};
  for (const auto& [name, value] : rate.amplitude) {
    Eigen::Index i = 0;
    while (i < d.amplitude.size() && problem.conditions[static_cast<std::size_t>(i)].name != name) ++i;
    if (i == d.amplitude.size()) unknown("unknown-condition", "condition", name);
    d.amplitude[i] = value;
  }
  for (const auto& [name, value] : rate.activation) {
    Eigen::Index i = 0;
    while (i < d.activation.size() && problem.mesh->regions[static_cast<std::size_t>(i)] != name) ++i;
    if (i == d.activation.size()) unknown("unknown-region", "region", name);
    d.activation[i] = value;
  }
  return d;
}

/// Rate of the held components, 0 elsewhere.
Eigen::VectorXd Sensitivity::held_rate(const LoadPoint& d) const {
  Eigen::VectorXd after = at_.dofs, before = at_.dofs;
  equations_.constraints().impose(load_.amplitude + held_part * d.amplitude, after);
  equations_.constraints().impose(load_.amplitude - held_part * d.amplitude, before);
  return (after - before) / (2.0 * held_part);
}

double Sensitivity::part_of(const Eigen::VectorXd& dofs) const {
  const double size = equations_.displacements(dofs).cwiseAbs().maxCoeff() / equations_.cell_size_m();
  return size > 0.0 ? difference / size : 1e-3;
}

double Sensitivity::largest_penalty() const {
  double largest = 0.0;
  const Contacts& contacts = equations_.loads().contacts();
  for (std::size_t c = 0; c < equations_.problem().contacts.size(); ++c)
    largest = std::max(largest, contacts.penalty_pa_per_m(static_cast<int>(c)));
  return largest;
}

Configuration Sensitivity::moved(const Direction& d, double part, LoadPoint& load) const {
  Configuration c = at_;
  c.dofs += part * d.dofs;
  if (d.multiplier.size() > 0) c.multiplier += part * d.multiplier;
  if (d.contact.size() > 0) c.contact_multiplier += part * d.contact;
  load.amplitude = load_.amplitude + part * d.load.amplitude;
  load.activation = load_.activation + part * d.load.activation;
  load.released = load_.released;
  return c;
}

template <class F>
auto Sensitivity::slope(const Direction& d, F&& f) const {
  const double part = part_of(d.dofs);
  LoadPoint load;
  Configuration after = moved(d, part, load);
  auto value = f(after, load);
  Configuration before = moved(d, -part, load);
  value -= f(before, load);
  return decltype(value)(value / (2.0 * part));
}

StateRate Sensitivity::along(const LoadRate& rate) {
  Direction d;
  d.load = direction_of(rate);
  d.dofs = held_rate(d.load);
  const bool multipliers = equations_.augmented();
  if (multipliers) d.multiplier = Eigen::MatrixXd::Zero(at_.multiplier.rows(), at_.multiplier.cols());
  if (at_.contact_multiplier.size() > 0) d.contact = Eigen::VectorXd::Zero(at_.contact_multiplier.size());
  const auto residual = [&](Configuration& c, const LoadPoint& l) -> Eigen::VectorXd {
    return equations_.evaluate(c, l).residual;
  };
  const auto volumetric = [&](Configuration& c, const LoadPoint&) -> Eigen::MatrixXd {
    return equations_.volumetric_pressure(c);
  };
  const auto pressed = [&](Configuration& c, const LoadPoint& l) -> Eigen::VectorXd {
    return equations_.loads().contacts().pressures(l.amplitude, c.dofs, c.contact_multiplier);
  };
  Configuration here = at_;
  if (!factor_.ready()) factor_.make(equations_, here, load_);
  StateRate out;
  double before = 0.0;
  bool fresh = false;
  Eigen::VectorXd x = Eigen::VectorXd::Zero(equations_.unknowns().count());
  const double pressure_scale = largest_penalty();
  const double enough = d.contact.size() > 0 ? contact_tolerance : tolerance;
  const Eigen::VectorXd held = d.dofs;
  Acceleration acceleration;
  const auto packed = [&] {  // pressures as lengths, by the contact's penalty
    Eigen::VectorXd z(x.size() + d.contact.size() + d.multiplier.size());
    z.head(x.size()) = x;
    z.segment(x.size(), d.contact.size()) = d.contact / pressure_scale;
    z.tail(d.multiplier.size()) = d.multiplier.reshaped() / pressure_scale;
    return z;
  };
  for (out.iterations = 1;; ++out.iterations) {
    const Eigen::VectorXd from = d.contact.size() > 0 ? packed() : Eigen::VectorXd();
    Eigen::VectorXd correction = -slope(d, residual);
    if (multipliers) d.multiplier += slope(d, volumetric);
    if (d.contact.size() > 0) d.contact = slope(d, pressed);
    factor_.solve(correction);
    x += correction;
    if (d.contact.size() > 0) {
      const Eigen::VectorXd z = acceleration.next(from, packed() - from);
      x = z.head(x.size());
      d.contact = pressure_scale * z.segment(x.size(), d.contact.size());
      d.multiplier.reshaped() = pressure_scale * z.tail(d.multiplier.size());
    }
    d.dofs = held + equations_.unknowns().extend(x);
    const double size = equations_.displacement_norm(correction);
    const double scale = std::max(equations_.displacements(d.dofs).norm(), 1e-30);
    out.left = size / scale;
    if (!std::isfinite(out.left) || out.iterations >= most) {
      throw data::ConvergenceFailure(
          {"slope of an equilibrium by its loads",
           fmt::format("{} back-substitutions left {:.3g} of it open", out.iterations, out.left),
           out.iterations, 0.0, size, ""});
    }
    // Differences hold no more than 1e-7: below that corrections only shuffle rounding.
    if (out.left <= enough || (out.iterations > 2 && out.left <= 1e-6 && size > 0.5 * before)) break;
    if (!fresh && out.iterations > 1 && size > slow * before) {
      if (const std::string trouble = factor_.make(equations_, here, load_); !trouble.empty()) {
        throw data::ConvergenceFailure(
            {"slope of an equilibrium by its loads", trouble, out.iterations, 0.0, size, ""});
      }
      fresh = true;
    }
    before = size;
  }
  out.dofs = d.dofs;
  const Eigen::Index n = d.dofs.size();
  const Eigen::VectorXd forces = slope(d, [&](Configuration& c, const LoadPoint& l) -> Eigen::VectorXd {
    const Evaluation e = equations_.evaluate(c, l);
    Eigen::VectorXd both(2 * n);
    both << e.internal, e.external;
    return both;
  });
  out.internal_force = forces.head(n);
  out.external_force = forces.tail(n);
  return out;
}

}  // namespace brachium::fem
