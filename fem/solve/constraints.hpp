#pragma once
/// All conditions that hold displacements at once: an orthonormal set of held directions at every node,
/// whatever planes, components and motions meet there.
///
/// At a node the conditions d_i . u = g_i(t) are made orthonormal in their order (Gram-Schmidt), q_k . u =
/// h_k(t). A direction that the earlier ones already hold adds nothing, and must agree with them.

#include <Eigen/Core>
#include <string>
#include <vector>

#include "fem/solve/holds.hpp"

namespace brachium::fem {

/// Two conditions that ask different displacements of one node.
struct Contradiction {
  int first = 0, second = 0;  ///< conditions (first: the last one that held the direction)
  int node = 0;
  double difference_m = 0.0;
  int nodes = 0;  ///< on which the two disagree
};

class Constraints {
 public:
  /// `released`: names of conditions that hold no more. Dofs: 3 per node, then pressures (never held).
  Constraints(const Problem& problem, int node_count, int dof_count,
              const std::vector<std::string>& released);

  const std::vector<char>& held() const { return held_; }     ///< by dof, in the nodes' frames
  const Eigen::Matrix3Xd& frames() const { return frames_; }  ///< empty, or 3 x 3 n_nodes
  int held_count() const;

  /// Moves the held components of `dofs` (global axes) to their values at the amplitudes (by condition).
  void impose(const Eigen::VectorXd& amplitude, Eigen::VectorXd& dofs) const;

  /// Part of a force (by dof, global axes) that the held directions do not bear.
  Eigen::VectorXd not_borne(const Eigen::VectorXd& force) const;

  /// Conditions that disagree by more than `tolerance_m` at the amplitudes; each pair once.
  std::vector<Contradiction> contradictions(const Eigen::VectorXd& amplitude, double tolerance_m) const;

 private:
  struct Node {
    int node;
    std::vector<Hold> holds;
  };
  struct Held {
    Eigen::Matrix3d direction;  ///< orthonormal columns
    Eigen::Vector3d value;
    std::array<int, 3> condition;
    int count = 0;
  };
  const Problem* problem_;
  std::vector<Node> nodes_;
  std::vector<char> held_;
  Eigen::Matrix3Xd frames_;

  Held evaluate(const Node& node, const Eigen::VectorXd& amplitude, double tolerance_m,
                std::vector<Contradiction>* contradictions) const;
};

}  // namespace brachium::fem
