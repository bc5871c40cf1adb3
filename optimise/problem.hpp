#pragma once
/// A bounded nonlinear least-squares problem with exact derivatives: what every solver here is given.
///
///     minimise  f(x) = 1/2 |r(x)|^2 + 1/2 sum_j ((x_j - mean_j) / sd_j)^2    over    lower <= x <= upper
///
/// | symbol | identifier   | unit                | meaning                                                  |
/// |--------|--------------|---------------------|----------------------------------------------------------|
/// | x      | x            | that of a parameter | free parameters (n)                                      |
/// | r      | residuals    | 1                   | scaled residuals (m)                                     |
/// | J      | jacobian     | 1 / unit            | dr_i/dx_j (m x n)                                        |
/// | s      | scale        | unit of x           | typical size of a change; solvers work in x / s          |
///
/// Priors are rows of the least-squares problem like any other; they are kept apart so that statistics can
/// tell what the data said from what was believed beforehand.

#include <Eigen/Core>
#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace brachium::optimise {

/// A normal prior, in the parameter's unit.
struct Prior {
  double mean = 0.0;
  double standard_deviation = 1.0;  ///< > 0
};

struct Parameter {
  std::string owner;  ///< muscle, group, channel, or "*" for all
  std::string name;   ///< "tendon_slack_length_m"
  std::string unit;   ///< "m", "s", "1"
  double start = 0.0;
  double lower = 0.0;
  double upper = 0.0;
  double scale = 1.0;  ///< > 0; the half width of the bounds is a good choice
  std::optional<Prior> prior;

  std::string label() const { return owner + " " + name; }
};

/// One thread's access to a problem: keeps whatever may be reused from one point to the next.
class Evaluator {
 public:
  virtual ~Evaluator() = default;
  /// residuals is resized to m, the Jacobian, if wanted, to m x n. Throws data::ConvergenceFailure where the
  /// model has no value at x.
  virtual void evaluate(const Eigen::VectorXd& x, Eigen::VectorXd& residuals, Eigen::MatrixXd* jacobian) = 0;
};

/// Const, and safe to use from several threads, each with an evaluator of its own.
class LeastSquaresProblem {
 public:
  virtual ~LeastSquaresProblem() = default;
  virtual const std::vector<Parameter>& parameters() const = 0;
  virtual std::size_t residual_count() const = 0;
  virtual std::string residual_name(std::size_t i) const = 0;  ///< e.g. "trial `curl-1`, 3.205 s"
  virtual std::unique_ptr<Evaluator> evaluator() const = 0;
};

/// Throws InputError listing every parameter that is not finite, has lower > upper, a start outside its
/// bounds, a scale or prior deviation that is not positive ("bad-parameter"), or stands twice
/// ("duplicate-parameter").
void check_parameters(const std::vector<Parameter>& parameters);

Eigen::VectorXd start_of(const std::vector<Parameter>& parameters);
Eigen::VectorXd lower_of(const std::vector<Parameter>& parameters);
Eigen::VectorXd upper_of(const std::vector<Parameter>& parameters);
Eigen::VectorXd scale_of(const std::vector<Parameter>& parameters);

}  // namespace brachium::optimise
