#include "fem/solve/stress_free.hpp"

#include <fmt/format.h>

#include <Eigen/QR>

#include "fem/solve/equations.hpp"
#include "fem/solve/holds.hpp"

namespace brachium::fem {
namespace {

constexpr Eigen::Index remembered = 8;  // changes that Anderson's rule looks back on

/// Anderson's rule over the last iterations.
class Acceleration {
 public:
  /// The step from X with its error.
  Eigen::VectorXd step(const Eigen::VectorXd& X, const Eigen::VectorXd& error) {
    if (last_X_.size() > 0) {
      if (dX_.cols() == remembered) {
        dX_ = dX_.rightCols(remembered - 1).eval();
        dE_ = dE_.rightCols(remembered - 1).eval();
      }
      dX_.conservativeResize(X.size(), dX_.cols() + 1);
      dE_.conservativeResize(X.size(), dE_.cols() + 1);
      dX_.rightCols(1) = X - last_X_;
      dE_.rightCols(1) = error - last_error_;
    }
    last_X_ = X;
    last_error_ = error;
    if (dE_.cols() == 0) return error;
    const Eigen::VectorXd g = dE_.colPivHouseholderQr().solve(error);
    return error - (dX_ + dE_) * g;
  }

 private:
  Eigen::MatrixXd dX_, dE_;
  Eigen::VectorXd last_X_, last_error_;
};

std::vector<char> held_points(const Problem& problem) {
  std::vector<char> held(static_cast<std::size_t>(problem.mesh->points.cols()), 0);
  for (std::size_t c = 0; c < problem.conditions.size(); ++c) {
    for (const Hold& h : holds_of(problem, static_cast<int>(c))) held[static_cast<std::size_t>(h.node)] = 1;
  }
  return held;
}

/// The programme's end as a place to begin from: the points in the loaded shape, pressures of the last shape.
SolveState guess_of(const Problem& problem, const Discretisation& discretisation,
                    const Eigen::Matrix3Xd& loaded, const Eigen::MatrixXd& pressure) {
  SolveState guess;
  for (const Phase& phase : problem.programme) {
    for (const auto& [name, value] : phase.amplitude) guess.amplitude[name] = value;
  }
  guess.phase_amplitude = guess.amplitude;
  guess.phase = static_cast<int>(problem.programme.size()) - 1;
  Configuration& c = guess.configuration;
  c.activation = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(problem.mesh->regions.size()));
  for (const Phase& phase : problem.programme) {
    for (std::size_t r = 0; r < problem.mesh->regions.size(); ++r) {
      const auto found = phase.activation.find(problem.mesh->regions[r]);
      if (found != phase.activation.end()) c.activation[static_cast<Eigen::Index>(r)] = found->second;
    }
  }
  guess.phase_activation = c.activation;
  c.dofs = Eigen::VectorXd::Zero(discretisation.dof_count());
  const Eigen::Matrix3Xd moved = loaded - problem.mesh->points;
  c.dofs.head(moved.size()) = moved.reshaped();
  guess.guessed_pressure_pa = pressure;
  return guess;
}

/// The equilibrium of one shape: from the guess where that leads there, else along the programme.
Summary equilibrium(const Problem& problem, const StressFreeOptions& options, const Eigen::Matrix3Xd& loaded,
                    const Eigen::MatrixXd& pressure) {
  if (pressure.size() > 0) {
    const Discretisation discretisation(problem.mesh, problem.formulation);
    const SolveState guess = guess_of(problem, discretisation, loaded, pressure);
    Summary summary = solve(problem, options.solve, {}, {}, &guess);
    if (summary.completed) return summary;
  }
  return solve(problem, options.solve);
}

}  // namespace

StressFreeShape stress_free_shape(const Eigen::Matrix3Xd& loaded, data::Mesh start,
                                  const std::function<Problem(std::shared_ptr<const data::Mesh>)>& make,
                                  const StressFreeOptions& options) {
  if (loaded.cols() != start.points.cols())
    throw data::InputError(
        "in-situ-shape",
        fmt::format("the loaded shape has {} points, the mesh {}", loaded.cols(), start.points.cols()),
        "give a place for each point of the mesh");
  StressFreeShape out;
  out.mesh = std::move(start);
  Acceleration acceleration;
  Eigen::MatrixXd pressure;
  for (int k = 0;; ++k) {
    const Problem problem = make(std::make_shared<const data::Mesh>(out.mesh));
    const Summary summary = equilibrium(problem, options, loaded, pressure);
    if (!summary.completed) {
      out.reason = fmt::format("iteration {}: {}", k, summary.reason);
      return out;
    }
    out.loaded = summary.last;
    Equations equations(problem, options.solve);
    if (equations.condensed()) pressure = equations.assembly().pressures(out.loaded.configuration);
    Eigen::Matrix3Xd error = loaded - out.mesh.points;
    error -= out.loaded.configuration.dofs.head(error.size()).reshaped(3, error.cols());
    const std::vector<char> held = held_points(problem);
    for (Eigen::Index p = 0; p < error.cols(); ++p) {
      if (!held[static_cast<std::size_t>(p)]) continue;
      if (error.col(p).norm() > 10.0 * options.tolerance_m)
        throw data::InputError(
            "in-situ-shape",
            fmt::format("point {} is held and arrives {:.3g} m from where the loaded shape has it", p,
                        error.col(p).norm()),
            "held points of the first guess must be where they are when nothing pulls");
      error.col(p).setZero();
    }
    out.error_m.push_back(error.colwise().norm().maxCoeff());
    out.converged = out.error_m.back() <= options.tolerance_m;
    if (out.converged) return out;
    if (k == options.max_iterations) {
      out.reason = fmt::format("{} iterations left points {:.3g} m from their places", k, out.error_m.back());
      return out;
    }
    out.mesh.points +=
        acceleration.step(out.mesh.points.reshaped(), error.reshaped()).reshaped(3, error.cols());
  }
}

}  // namespace brachium::fem
