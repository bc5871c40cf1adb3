#pragma once
/// Small least-squares problems with known answers.

#include <cmath>
#include <functional>

#include "data/model/error.hpp"
#include "optimise/problem.hpp"

namespace brachium::optimise::tests {

using Residuals = std::function<void(const Eigen::VectorXd&, Eigen::VectorXd&, Eigen::MatrixXd*)>;

class ToyProblem final : public LeastSquaresProblem {
 public:
  ToyProblem(std::vector<Parameter> parameters, std::size_t count, Residuals residuals)
      : parameters_(std::move(parameters)), count_(count), residuals_(std::move(residuals)) {}

  const std::vector<Parameter>& parameters() const override { return parameters_; }
  std::size_t residual_count() const override { return count_; }
  std::string residual_name(std::size_t i) const override { return "sample " + std::to_string(i); }
  std::unique_ptr<Evaluator> evaluator() const override {
    struct Own final : Evaluator {
      explicit Own(const Residuals& f) : residuals(f) {}
      void evaluate(const Eigen::VectorXd& x, Eigen::VectorXd& r, Eigen::MatrixXd* J) override {
        residuals(x, r, J);
      }
      const Residuals& residuals;
    };
    return std::make_unique<Own>(residuals_);
  }

 private:
  std::vector<Parameter> parameters_;
  std::size_t count_;
  Residuals residuals_;
};

inline Parameter toy_parameter(const std::string& name, double start, double lower, double upper) {
  return {"toy", name, "1", start, lower, upper, 0.5 * (upper - lower), {}};
}

/// Rosenbrock's valley as residuals (10 (y - x^2), 1 - x): minimum 0 at (1, 1).
inline ToyProblem rosenbrock(double upper = 2.0) {
  return ToyProblem({toy_parameter("x", -1.2, -2.0, upper), toy_parameter("y", 1.0, -2.0, 2.0)}, 2,
                    [](const Eigen::VectorXd& x, Eigen::VectorXd& r, Eigen::MatrixXd* J) {
                      r.resize(2);
                      r << 10.0 * (x[1] - x[0] * x[0]), 1.0 - x[0];
                      if (!J) return;
                      J->resize(2, 2);
                      *J << -20.0 * x[0], 10.0, -1.0, 0.0;
                    });
}

/// y_i = a exp(-b t_i) + c with a fixed disturbance; `wrong` spoils one derivative.
inline ToyProblem decay(double wrong = 0.0) {
  return ToyProblem({toy_parameter("a", 1.0, 0.1, 5.0), toy_parameter("b", 0.5, 0.05, 4.0),
                     toy_parameter("c", 0.1, -1.0, 1.0)},
                    40, [wrong](const Eigen::VectorXd& x, Eigen::VectorXd& r, Eigen::MatrixXd* J) {
                      r.resize(40);
                      if (J) J->resize(40, 3);
                      for (int i = 0; i < 40; ++i) {
                        const double t = 0.1 * i, e = std::exp(-x[1] * t);
                        r[i] = x[0] * e + x[2] - (2.0 * std::exp(-1.3 * t) + 0.4 + 0.05 * std::sin(7.0 * t));
                        if (J) J->row(i) << e, -x[0] * t * e * (i == 7 ? 1.0 + wrong : 1.0), 1.0;
                      }
                    });
}

}  // namespace brachium::optimise::tests
