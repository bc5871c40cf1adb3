#pragma once
/// Broyden's update of an old factor, kept as the steps alone (Kelley 1995, doi:10.1137/1.9781611970944,
/// section 7.3): with K0^-1 the old factor and s_k the steps so far,
///   z = -K0^-1 R;  z += s_(j+1) (s_j . z)/|s_j|^2  for j = 0 .. n-2;  s_n = z / (1 - s_(n-1) . z /
///   |s_(n-1)|^2).
/// Every step must have been taken whole, on one and the same residual function. Products are over the
/// leading unknowns (displacements), since pressures have another unit.

#include <Eigen/Core>
#include <vector>

namespace brachium::fem {

class Secant {
 public:
  Secant() = default;
  explicit Secant(Eigen::Index leading) : leading_(leading) {}  ///< negative: all unknowns

  /// The step for z = -K0^-1 R.
  Eigen::VectorXd step(Eigen::VectorXd z) const;
  /// Takes note of a step that was taken whole; with more than `limit` steps it begins anew.
  void taken(const Eigen::VectorXd& step);
  void clear() { steps_.clear(); }
  std::size_t size() const { return steps_.size(); }

 private:
  static constexpr std::size_t limit = 20;
  Eigen::Index leading_ = -1;
  std::vector<Eigen::VectorXd> steps_;

  double product(const Eigen::VectorXd& a, const Eigen::VectorXd& b) const;
};

}  // namespace brachium::fem
