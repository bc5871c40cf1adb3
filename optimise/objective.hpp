#pragma once
/// The objective as solvers see it: scaled parameters, priors appended, work counted, failures turned into
/// "no value". Internal to optimise/.

#include <Eigen/Core>
#include <functional>
#include <memory>
#include <string>

#include "optimise/problem.hpp"
#include "optimise/solve.hpp"

namespace brachium::optimise {

/// One start's view of a problem in scaled parameters u = x / s.
class Objective {
 public:
  explicit Objective(const LeastSquaresProblem& problem);

  Eigen::Index size() const { return scale_.size(); }      ///< n
  Eigen::Index rows() const { return rows_ + priors_; }    ///< residuals and priors
  const Eigen::VectorXd& lower() const { return lower_; }  ///< scaled
  const Eigen::VectorXd& upper() const { return upper_; }
  Eigen::VectorXd scaled(const Eigen::VectorXd& x) const { return x.cwiseQuotient(scale_); }
  Eigen::VectorXd unscaled(const Eigen::VectorXd& u) const { return u.cwiseProduct(scale_); }

  /// r with prior rows, and J in scaled parameters if wanted. False where the model has no value at u, or not
  /// a finite one; failure() then says why.
  bool evaluate(const Eigen::VectorXd& u, Eigen::VectorXd& r, Eigen::MatrixXd* J);

  int evaluations() const { return evaluations_; }
  int jacobians() const { return jacobians_; }
  int failures() const { return failures_; }
  const std::string& failure() const { return failure_; }

 private:
  const LeastSquaresProblem& problem_;
  std::unique_ptr<Evaluator> evaluator_;
  Eigen::VectorXd lower_, upper_, scale_;
  Eigen::Index rows_ = 0, priors_ = 0;
  Eigen::VectorXd r_;
  Eigen::MatrixXd J_;
  int evaluations_ = 0, jacobians_ = 0, failures_ = 0;
  std::string failure_;
};

using Report = std::function<void(Iteration)>;

// Each minimises from result.start (in x) and fills the rest of the result.
void run_levenberg_marquardt(Objective& objective, const SolveOptions& options, const Report& report,
                             StartResult& result);
void run_gsl(Objective& objective, const SolveOptions& options, const Report& report, StartResult& result);
void run_nlopt(Objective& objective, const SolveOptions& options, std::uint64_t seed, const Report& report,
               StartResult& result);

/// Largest component of the gradient that is not blocked by a bound.
double projected_gradient_norm(const Eigen::VectorXd& u, const Eigen::VectorXd& gradient,
                               const Eigen::VectorXd& lower, const Eigen::VectorXd& upper);

}  // namespace brachium::optimise
