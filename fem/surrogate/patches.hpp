#pragma once
/// Polynomials over the cells of a rectangular mesh of states: what every surrogate becomes before it is
/// evaluated.
///
/// In the cell [θ_i, θ_(i+1)] x [α_j, α_(j+1)], with t = (θ - θ_i)/h_θ and s = (α - α_j)/h_α in [0, 1]:
///   F(θ, α) = Σ_k Σ_l c_kl t^k s^l        by Horner's rule, with both first derivatives

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "fem/surrogate/samples.hpp"

namespace brachium::fem {

/// One output and its derivatives.
struct OutputValue {
  double value = 0.0;
  double dtheta = 0.0;  ///< [1/rad]
  double dalpha = 0.0;
};

/// One direction's mesh.
class MeshLines {
 public:
  MeshLines() = default;
  /// At least two increasing lines.
  explicit MeshLines(std::vector<double> lines);

  std::size_t cells() const { return inverse_width_.size(); }
  const std::vector<double>& lines() const { return lines_; }
  /// Cell of x; the first or last one beyond the ends.
  std::size_t cell(double x) const;
  double start(std::size_t cell) const { return lines_[cell]; }
  double inverse_width(std::size_t cell) const { return inverse_width_[cell]; }

 private:
  std::vector<double> lines_, inverse_width_;
  bool equidistant_ = false;
  double inverse_step_ = 0.0;
};

/// Loop over one cell's coefficients, four outputs at a time: the fastest that this machine has, or the
/// portable one.
using PatchKernel = void (*)(const double* coefficients, int theta_degree, int alpha_degree,
                             std::size_t outputs, double t, double s, double dt, double ds, OutputValue* out);
PatchKernel choose_patch_kernel(bool portable = false);

class PatchTable {
 public:
  PatchTable() = default;
  PatchTable(MeshLines theta, MeshLines alpha, int theta_degree, int alpha_degree, std::size_t outputs);

  const MeshLines& theta() const { return theta_; }
  const MeshLines& alpha() const { return alpha_; }
  int theta_degree() const { return theta_degree_; }
  int alpha_degree() const { return alpha_degree_; }
  std::size_t outputs() const { return outputs_; }

  /// c_kl of an output in cell (i, j).
  double& coefficient(std::size_t i, std::size_t j, int k, int l, std::size_t output) {
    return coefficients_[place(i, j, k, l, output)];
  }

  /// Writes outputs() values. No check of bounds: the polynomial of the outermost cell goes on outside.
  void evaluate(double theta_rad, double activation, OutputValue* out) const;

 private:
  std::size_t place(std::size_t i, std::size_t j, int k, int l, std::size_t output) const;

  MeshLines theta_, alpha_;
  int theta_degree_ = 0, alpha_degree_ = 0;
  std::size_t outputs_ = 0, lanes_ = 0, cell_size_ = 0;
  std::vector<double> coefficients_;
  PatchKernel kernel_ = nullptr;
};

}  // namespace brachium::fem
