#include "fem/contact/distance_grid.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "data/model/error.hpp"
#include "data/model/parallel.hpp"

namespace brachium::fem {
namespace {

/// B-spline coefficients that interpolate n samples with given stride, mirrored at both ends: one causal and
/// one anti-causal pass with the pole z = sqrt 3 - 2.
void prefilter(double* c, int n, int stride) {
  if (n < 2) return;
  const double z = std::sqrt(3.0) - 2.0;
  const auto at = [&](int i) -> double& { return c[static_cast<std::ptrdiff_t>(i) * stride]; };
  for (int i = 0; i < n; ++i) at(i) *= 6.0;
  // Mirror-symmetric start, exact: sum over one period of the mirrored samples.
  double power = z, last = std::pow(z, n - 1), sum = at(0) + last * at(n - 1);
  last = last * last / z;
  for (int i = 1; i < n - 1; ++i) {
    sum += (power + last) * at(i);
    power *= z;
    last /= z;
  }
  at(0) = sum / (1.0 - power * power);
  for (int i = 1; i < n; ++i) at(i) += z * at(i - 1);
  at(n - 1) = z / (z * z - 1.0) * (at(n - 1) + z * at(n - 2));
  for (int i = n - 2; i >= 0; --i) at(i) = z * (at(i + 1) - at(i));
}

/// Values, first and second derivatives of the four cubic B-splines at t in [0, 1).
struct Basis {
  std::array<double, 4> value, slope, curvature;
};

Basis basis(double t) {
  const double s = 1.0 - t;
  return {{s * s * s / 6.0, (3.0 * t * t * t - 6.0 * t * t + 4.0) / 6.0,
           (3.0 * s * s * s - 6.0 * s * s + 4.0) / 6.0, t * t * t / 6.0},
          {-0.5 * s * s, 1.5 * t * t - 2.0 * t, -1.5 * s * s + 2.0 * s, 0.5 * t * t},
          {s, 3.0 * t - 2.0, 3.0 * s - 2.0, t}};
}

/// Separable Gaussian with the ends repeated.
void blur(std::vector<double>& values, const Eigen::Vector3i& size, double width) {
  const int reach = static_cast<int>(std::ceil(4.0 * width));
  std::vector<double> kernel(static_cast<std::size_t>(2 * reach + 1));
  double sum = 0.0;
  for (int k = -reach; k <= reach; ++k)
    sum += kernel[static_cast<std::size_t>(k + reach)] = std::exp(-0.5 * k * k / (width * width));
  for (double& w : kernel) w /= sum;
  const std::array<int, 3> stride{1, size[0], size[0] * size[1]};
  std::vector<double> line;
  for (int axis = 0; axis < 3; ++axis) {
    const int a = (axis + 1) % 3, b = (axis + 2) % 3, n = size[axis];
    line.resize(static_cast<std::size_t>(n));
    for (int i = 0; i < size[a]; ++i) {
      for (int j = 0; j < size[b]; ++j) {
        double* start = values.data() + static_cast<std::ptrdiff_t>(i) * stride[static_cast<std::size_t>(a)] +
                        static_cast<std::ptrdiff_t>(j) * stride[static_cast<std::size_t>(b)];
        for (int k = 0; k < n; ++k)
          line[static_cast<std::size_t>(k)] =
              start[static_cast<std::ptrdiff_t>(k) * stride[static_cast<std::size_t>(axis)]];
        for (int k = 0; k < n; ++k) {
          double filtered = 0.0;
          for (int m = -reach; m <= reach; ++m)
            filtered += kernel[static_cast<std::size_t>(m + reach)] *
                        line[static_cast<std::size_t>(std::clamp(k + m, 0, n - 1))];
          start[static_cast<std::ptrdiff_t>(k) * stride[static_cast<std::size_t>(axis)]] = filtered;
        }
      }
    }
  }
}

}  // namespace

DistanceGrid::DistanceGrid(const TriangleTree& tree, double spacing_m, double margin_m, double smoothing_m,
                           std::size_t threads)
    : spacing_(spacing_m) {
  if (!(spacing_m > 0.0))
    throw data::InputError("contact-grid", fmt::format("spacing of the distance grid is {} m", spacing_m),
                           "it must be above 0");
  if (!(margin_m >= 0.0) || !(smoothing_m >= 0.0))
    throw data::InputError(
        "contact-grid",
        fmt::format("margin {} m and smoothing {} m of the distance grid", margin_m, smoothing_m),
        "they must not be negative");
  const double margin = margin_m + 3.0 * spacing_m;
  origin_ = tree.box().min() - Eigen::Vector3d::Constant(margin);
  const Eigen::Vector3d extent = tree.box().sizes() + Eigen::Vector3d::Constant(2.0 * margin);
  double total = 1.0;
  for (int i = 0; i < 3; ++i) total *= std::ceil(extent[i] / spacing_m) + 1.0;
  if (!(total < 5e7))
    throw data::InputError("contact-grid", fmt::format("the distance grid would have {:.3g} samples", total),
                           "choose a larger spacing or a smaller margin");
  for (int i = 0; i < 3; ++i) size_[i] = static_cast<int>(std::ceil(extent[i] / spacing_m)) + 1;
  coefficient_.resize(static_cast<std::size_t>(total));
  data::parallel_for(static_cast<std::size_t>(size_[2]), threads, [&](std::size_t k) {
    for (int j = 0; j < size_[1]; ++j) {
      for (int i = 0; i < size_[0]; ++i) {
        const Eigen::Vector3d x = origin_ + spacing_ * Eigen::Vector3d(i, j, static_cast<double>(k));
        coefficient_[(k * static_cast<std::size_t>(size_[1]) + static_cast<std::size_t>(j)) *
                         static_cast<std::size_t>(size_[0]) +
                     static_cast<std::size_t>(i)] = tree.closest(x).signed_distance;
      }
    }
  });
  if (smoothing_m > 0.0) blur(coefficient_, size_, smoothing_m / spacing_m);
  const int nx = size_[0], ny = size_[1], nz = size_[2];
  for (int k = 0; k < nz; ++k) {
    for (int j = 0; j < ny; ++j)
      prefilter(coefficient_.data() + (static_cast<std::ptrdiff_t>(k) * ny + j) * nx, nx, 1);
  }
  for (int k = 0; k < nz; ++k) {
    for (int i = 0; i < nx; ++i)
      prefilter(coefficient_.data() + static_cast<std::ptrdiff_t>(k) * ny * nx + i, ny, nx);
  }
  for (int j = 0; j < ny; ++j) {
    for (int i = 0; i < nx; ++i)
      prefilter(coefficient_.data() + static_cast<std::ptrdiff_t>(j) * nx + i, nz, nx * ny);
  }
  const TriangleMesh& mesh = tree.mesh();
  for (int t = 0; t < mesh.triangles.cols(); ++t) {
    Eigen::Vector3d centre = Eigen::Vector3d::Zero();
    for (int c = 0; c < 3; ++c) {
      const Eigen::Vector3d x = mesh.points.col(mesh.triangles(c, t));
      centre += x / 3.0;
      greatest_error_ = std::max(greatest_error_, std::abs(evaluate(x).value));
    }
    greatest_error_ = std::max(greatest_error_, std::abs(evaluate(centre).value));
  }
}

Distance DistanceGrid::evaluate(const Eigen::Vector3d& x) const {
  // Within the box one spacing inside the samples the four splines of each axis exist; beyond it, the nearest
  // such point.
  const Eigen::Vector3d lower = origin_ + Eigen::Vector3d::Constant(spacing_);
  const Eigen::Vector3d upper =
      origin_ + spacing_ * (size_.cast<double>() - Eigen::Vector3d::Constant(2.0 + 1e-9));
  const Eigen::Vector3d inside = x.cwiseMax(lower).cwiseMin(upper);
  const Eigen::Vector3d local = (inside - origin_) / spacing_;
  std::array<Basis, 3> b;
  std::array<int, 3> first;
  for (int i = 0; i < 3; ++i) {
    const double floor = std::floor(local[i]);
    first[static_cast<std::size_t>(i)] = static_cast<int>(floor) - 1;
    b[static_cast<std::size_t>(i)] = basis(local[i] - floor);
  }
  double value = 0.0;
  Eigen::Vector3d gradient = Eigen::Vector3d::Zero();
  Eigen::Matrix3d hessian = Eigen::Matrix3d::Zero();
  for (std::size_t k = 0; k < 4; ++k) {
    for (std::size_t j = 0; j < 4; ++j) {
      const double* row =
          coefficient_.data() +
          ((static_cast<std::ptrdiff_t>(first[2]) + static_cast<std::ptrdiff_t>(k)) * size_[1] + first[1] +
           static_cast<std::ptrdiff_t>(j)) *
              size_[0] +
          first[0];
      double v = 0.0, s = 0.0, c = 0.0;
      for (std::size_t i = 0; i < 4; ++i) {
        v += b[0].value[i] * row[i];
        s += b[0].slope[i] * row[i];
        c += b[0].curvature[i] * row[i];
      }
      const double yv = b[1].value[j], ys = b[1].slope[j], yc = b[1].curvature[j];
      const double zv = b[2].value[k], zs = b[2].slope[k], zc = b[2].curvature[k];
      value += v * yv * zv;
      gradient += Eigen::Vector3d(s * yv * zv, v * ys * zv, v * yv * zs);
      hessian(0, 0) += c * yv * zv;
      hessian(1, 1) += v * yc * zv;
      hessian(2, 2) += v * yv * zc;
      hessian(0, 1) += s * ys * zv;
      hessian(0, 2) += s * yv * zs;
      hessian(1, 2) += v * ys * zs;
    }
  }
  hessian(1, 0) = hessian(0, 1);
  hessian(2, 0) = hessian(0, 2);
  hessian(2, 1) = hessian(1, 2);
  Distance d{value, gradient / spacing_, hessian / (spacing_ * spacing_)};
  const Eigen::Vector3d beyond = x - inside;
  const double far = beyond.norm();
  if (far > 0.0) d = {value + far, beyond / far, Eigen::Matrix3d::Zero()};
  return d;
}

}  // namespace brachium::fem
