#include "fem/solve/constraints.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>

namespace brachium::fem {
namespace {

constexpr double parallel = 1e-6;  // sine of the angle below which a direction is already held

int axis_of(const Eigen::Vector3d& q) {
  for (int i = 0; i < 3; ++i) {
    if (std::abs(q[i]) == 1.0) return i;
  }
  return -1;
}

}  // namespace

Constraints::Constraints(const Problem& problem, int node_count, int dof_count,
                         const std::vector<std::string>& released)
    : problem_(&problem), held_(static_cast<std::size_t>(dof_count), 0) {
  std::map<int, std::vector<Hold>> by_node;
  for (std::size_t c = 0; c < problem.conditions.size(); ++c) {
    if (std::find(released.begin(), released.end(), problem.conditions[c].name) != released.end()) continue;
    for (const Hold& hold : holds_of(problem, static_cast<int>(c))) by_node[hold.node].push_back(hold);
  }
  const Eigen::VectorXd rest = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(problem.conditions.size()));
  std::map<int, Eigen::Matrix3d> oblique;
  for (auto& [node, holds] : by_node) {
    nodes_.push_back({node, std::move(holds)});
    const Held held = evaluate(nodes_.back(), rest, 0.0, nullptr);
    const auto dof = static_cast<std::size_t>(3 * node);
    bool along_axes = true;
    for (int k = 0; k < held.count; ++k) along_axes = along_axes && axis_of(held.direction.col(k)) >= 0;
    if (held.count == 3) {
      held_[dof] = held_[dof + 1] = held_[dof + 2] = 1;
    } else if (along_axes) {
      for (int k = 0; k < held.count; ++k)
        held_[dof + static_cast<std::size_t>(axis_of(held.direction.col(k)))] = 1;
    } else {
      Eigen::Matrix3d frame;
      frame.col(0) = held.direction.col(0);
      frame.col(1) = held.count == 2 ? Eigen::Vector3d(held.direction.col(1)) : frame.col(0).unitOrthogonal();
      frame.col(2) = frame.col(0).cross(frame.col(1));
      oblique[node] = frame;
      for (int k = 0; k < held.count; ++k) held_[dof + static_cast<std::size_t>(k)] = 1;
    }
  }
  if (oblique.empty()) return;
  frames_.resize(3, 3 * static_cast<Eigen::Index>(node_count));
  for (Eigen::Index n = 0; n < node_count; ++n) frames_.middleCols<3>(3 * n).setIdentity();
  for (const auto& [node, frame] : oblique)
    frames_.middleCols<3>(3 * static_cast<Eigen::Index>(node)) = frame;
}

Constraints::Held Constraints::evaluate(const Node& node, const Eigen::VectorXd& amplitude,
                                        double tolerance_m,
                                        std::vector<Contradiction>* contradictions) const {
  Held held;
  for (const Hold& hold : node.holds) {
    Eigen::Vector3d w = hold.direction;
    double rest = held_value(*problem_, hold, amplitude[hold.condition]);
    int last = -1;
    for (int k = 0; k < held.count; ++k) {
      const double along = hold.direction.dot(held.direction.col(k));
      w -= along * held.direction.col(k);
      rest -= along * held.value[k];
      if (std::abs(along) > parallel) last = held.condition[static_cast<std::size_t>(k)];
    }
    const double length = w.norm();
    if (held.count == 3 || length < parallel) {
      if (contradictions && std::abs(rest) > tolerance_m) {
        contradictions->push_back({last, hold.condition, node.node, std::abs(rest), 1});
      }
      continue;
    }
    held.direction.col(held.count) = w / length;
    held.value[held.count] = rest / length;
    held.condition[static_cast<std::size_t>(held.count)] = hold.condition;
    ++held.count;
  }
  return held;
}

int Constraints::held_count() const {
  return static_cast<int>(std::count(held_.begin(), held_.end(), char{1}));
}

void Constraints::impose(const Eigen::VectorXd& amplitude, Eigen::VectorXd& dofs) const {
  for (const Node& node : nodes_) {
    const Held held = evaluate(node, amplitude, 0.0, nullptr);
    auto u = dofs.segment<3>(3 * node.node);
    if (held.count == 3) {
      u = held.direction * held.value;
      continue;
    }
    for (int k = 0; k < held.count; ++k) {
      const Eigen::Vector3d q = held.direction.col(k);
      if (const int axis = axis_of(q); axis >= 0) {
        u[axis] = q[axis] * held.value[k];  // exactly, not to rounding
      } else {
        u += (held.value[k] - q.dot(u)) * q;
      }
    }
  }
}

Eigen::VectorXd Constraints::not_borne(const Eigen::VectorXd& force) const {
  Eigen::VectorXd rest = force;
  const Eigen::VectorXd zero = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(problem_->conditions.size()));
  for (const Node& node : nodes_) {
    const Held held = evaluate(node, zero, 0.0, nullptr);
    auto f = rest.segment<3>(3 * node.node);
    for (int k = 0; k < held.count; ++k)
      f -= Eigen::Vector3d(held.direction.col(k).dot(f) * held.direction.col(k));
  }
  return rest;
}

std::vector<Contradiction> Constraints::contradictions(const Eigen::VectorXd& amplitude,
                                                       double tolerance_m) const {
  std::vector<Contradiction> all, pairs;
  for (const Node& node : nodes_) evaluate(node, amplitude, tolerance_m, &all);
  for (const Contradiction& c : all) {
    const auto same = std::find_if(pairs.begin(), pairs.end(), [&](const Contradiction& p) {
      return p.first == c.first && p.second == c.second;
    });
    if (same == pairs.end()) {
      pairs.push_back(c);
      continue;
    }
    const int nodes = same->nodes + 1;
    if (c.difference_m > same->difference_m) *same = c;
    same->nodes = nodes;
  }
  return pairs;
}

}  // namespace brachium::fem
