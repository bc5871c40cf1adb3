#include "data/limb/chain.hpp"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <utility>

#include "data/model/error.hpp"

namespace brachium::limb {
namespace {

using Eigen::Index;

Eigen::Vector2d direction(double phi) {
  return {std::sin(phi), -std::cos(phi)};
}
Eigen::Vector2d direction_slope(double phi) {
  return {std::cos(phi), std::sin(phi)};
}

// Sums over all links distal to each hinge: what acts in inclinations, brought to hinge angles.
Eigen::VectorXd distal_sums(Eigen::VectorXd v) {
  for (Index i = v.size() - 1; i-- > 0;) v(i) += v(i + 1);
  return v;
}

}  // namespace

PlanarChain::PlanarChain(std::vector<Link> links, Eigen::Vector2d gravity)
    : links_(std::move(links)), gravity_(std::move(gravity)) {
  if (links_.empty()) throw data::InputError("missing-segment", "a chain needs at least one link");
  if (!gravity_.allFinite()) throw data::InputError("not-finite", "gravity is not a finite vector");
  const auto n = static_cast<Index>(links_.size());
  k_ = Eigen::VectorXd::Zero(n);
  a_ = Eigen::MatrixXd::Zero(n, n);
  double carried = 0.0;  // mass distal to the link at hand
  for (Index i = n; i-- > 0;) {
    const Link& link = links_[static_cast<std::size_t>(i)];
    const bool last = i == n - 1;
    if (!last && !(link.length_m > 0.0)) {
      throw data::InputError(
          "out-of-range",
          fmt::format("the length of link {} must be greater than 0 m, not {}", i + 1, link.length_m));
    }
    const double length = last ? 0.0 : link.length_m;
    k_(i) = link.bodies.first_moment_kg_m() + length * carried;
    a_(i, i) = link.bodies.inertia_kg_m2() + length * length * carried;
    if (!(a_(i, i) > 0.0)) {
      throw data::InputError("out-of-range", fmt::format("link {} has no inertia about its hinge", i + 1),
                             "give its segment a mass");
    }
    for (Index j = i + 1; j < n; ++j) a_(i, j) = a_(j, i) = length * k_(j);
    carried += link.bodies.mass_kg();
  }
}

void PlanarChain::check(const Eigen::VectorXd& v, const char* what) const {
  if (v.size() != static_cast<Index>(links_.size())) {
    throw data::InputError("wrong-size", fmt::format("{} has {} entries for a chain of {} hinges", what,
                                                     v.size(), links_.size()));
  }
  if (!v.allFinite()) throw data::InputError("not-finite", fmt::format("{} is not finite", what));
}

Eigen::VectorXd PlanarChain::inclinations(const Eigen::VectorXd& q, double base) const {
  Eigen::VectorXd phi(q.size());
  for (Index i = 0; i < q.size(); ++i) phi(i) = base += q(i);
  return phi;
}

Eigen::MatrixXd PlanarChain::mass_matrix(const Eigen::VectorXd& q) const {
  check(q, "the angle");
  const Eigen::VectorXd phi = inclinations(q, 0.0);
  const Index n = q.size();
  Eigen::MatrixXd m(n, n);
  for (Index i = 0; i < n; ++i) {
    for (Index j = 0; j < n; ++j) m(i, j) = a_(i, j) * std::cos(phi(i) - phi(j));
  }
  // phi = S q with a lower triangle S of ones: M = S^T A S.
  for (Index j = n - 1; j-- > 0;) m.col(j) += m.col(j + 1);
  for (Index i = n - 1; i-- > 0;) m.row(i) += m.row(i + 1);
  return m;
}

Eigen::VectorXd PlanarChain::gravity_moment(const Eigen::VectorXd& q, const BaseMotion& base) const {
  check(q, "the angle");
  const Eigen::VectorXd phi = inclinations(q, base.inclination_rad);
  Eigen::VectorXd m(q.size());
  for (Index i = 0; i < q.size(); ++i) m(i) = k_(i) * gravity_.dot(direction_slope(phi(i)));
  return distal_sums(std::move(m));
}

Eigen::MatrixXd PlanarChain::gravity_stiffness(const Eigen::VectorXd& q, const BaseMotion& base) const {
  check(q, "the angle");
  const Eigen::VectorXd phi = inclinations(q, base.inclination_rad);
  Eigen::VectorXd slope(q.size());
  for (Index i = 0; i < q.size(); ++i) slope(i) = -k_(i) * gravity_.dot(direction(phi(i)));
  const Eigen::VectorXd sums = distal_sums(std::move(slope));
  Eigen::MatrixXd k(q.size(), q.size());
  for (Index i = 0; i < q.size(); ++i) {
    for (Index j = 0; j < q.size(); ++j) k(i, j) = sums(std::max(i, j));
  }
  return k;
}

Eigen::VectorXd PlanarChain::force_moment(const Eigen::VectorXd& q, const std::vector<PointForce>& forces,
                                          const BaseMotion& base) const {
  check(q, "the angle");
  const Eigen::VectorXd phi = inclinations(q, base.inclination_rad);
  Eigen::VectorXd m = Eigen::VectorXd::Zero(q.size());
  for (const PointForce& f : forces) {
    if (f.link >= links_.size()) {
      throw data::InputError("wrong-size",
                             fmt::format("a force on link {} of a chain of {}", f.link + 1, links_.size()));
    }
    if (!f.force_N.allFinite() || !std::isfinite(f.distance_m))
      throw data::InputError("not-finite", "a force on the limb is not finite");
    const auto at = static_cast<Index>(f.link);
    // A force on link i also pulls at the end of every link before it.
    for (Index i = 0; i <= at; ++i) {
      const double arm = i == at ? f.distance_m : links_[static_cast<std::size_t>(i)].length_m;
      m(i) += arm * f.force_N.dot(direction_slope(phi(i)));
    }
  }
  return distal_sums(std::move(m));
}

Eigen::VectorXd PlanarChain::inverse_dynamics(const Eigen::VectorXd& q, const Eigen::VectorXd& qdot,
                                              const Eigen::VectorXd& qddot, const BaseMotion& base,
                                              const std::vector<PointForce>& forces) const {
  check(q, "the angle");
  check(qdot, "the angular velocity");
  check(qddot, "the angular acceleration");
  const Eigen::VectorXd phi = inclinations(q, base.inclination_rad);
  const Eigen::VectorXd rate = inclinations(qdot, base.rate_rad_per_s);
  const Eigen::VectorXd acceleration = inclinations(qddot, base.acceleration_rad_per_s2);
  const Eigen::Vector2d fall = gravity_ - base.hinge_acceleration_m_per_s2;
  Eigen::VectorXd m(q.size());
  for (Index i = 0; i < q.size(); ++i) {
    m(i) = -k_(i) * fall.dot(direction_slope(phi(i)));
    for (Index j = 0; j < q.size(); ++j) {
      m(i) += a_(i, j) *
              (std::cos(phi(i) - phi(j)) * acceleration(j) + std::sin(phi(i) - phi(j)) * rate(j) * rate(j));
    }
  }
  return distal_sums(std::move(m)) - force_moment(q, forces, base);
}

Eigen::VectorXd PlanarChain::forward_dynamics(const Eigen::VectorXd& q, const Eigen::VectorXd& qdot,
                                              const Eigen::VectorXd& moment, const BaseMotion& base,
                                              const std::vector<PointForce>& forces) const {
  check(moment, "the moment");
  const Eigen::VectorXd bias = inverse_dynamics(q, qdot, Eigen::VectorXd::Zero(q.size()), base, forces);
  return mass_matrix(q).ldlt().solve(moment - bias);
}

double PlanarChain::kinetic_energy_J(const Eigen::VectorXd& q, const Eigen::VectorXd& qdot) const {
  check(qdot, "the angular velocity");
  return 0.5 * qdot.dot(mass_matrix(q) * qdot);
}

double PlanarChain::potential_energy_J(const Eigen::VectorXd& q, const BaseMotion& base) const {
  check(q, "the angle");
  const Eigen::VectorXd phi = inclinations(q, base.inclination_rad);
  double energy = 0.0;
  for (Index i = 0; i < q.size(); ++i) energy -= k_(i) * gravity_.dot(direction(phi(i)));
  return energy;
}

PlanarChain chain_of(const data::Scene& scene, const std::map<std::string, double>& conditions,
                     const std::string& trial) {
  std::vector<Link> links;
  std::string at;  // the hinge whose child comes next; empty: the ground
  for (std::size_t count = 0; count < scene.coordinates.size(); ++count) {
    const data::Coordinate* next = nullptr;
    for (const auto& c : scene.coordinates) {
      if (c.parent != at) continue;
      if (next) {
        throw data::InputError("not-a-chain",
                               fmt::format("coordinates `{}` and `{}` both hang on {}", next->name, c.name,
                                           at.empty() ? "the ground" : fmt::format("`{}`", at)),
                               "inverse dynamics knows chains of hinges, not trees");
      }
      next = &c;
    }
    if (!next) break;
    if (!links.empty()) links.back().length_m = next->distance_from_parent_m;
    links.push_back({bodies_of(scene, next->name, conditions, trial), 0.0});
    at = next->name;
  }
  return PlanarChain(std::move(links));
}

}  // namespace brachium::limb
