#include "optimise/muscle_force_fit.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "data/model/error.hpp"
#include "fem/limb/body_parameters.hpp"
#include "optimise/verdicts.hpp"

namespace brachium::optimise {
namespace {

constexpr double difference = 1e-4;  // of the bounds' width

std::string place(const ReferenceForce& r) {
  return fmt::format("{}, {:.4g} deg, activation {:.4g}", r.set, r.q_rad * 180.0 / std::numbers::pi,
                     r.activation);
}

std::vector<Parameter> parameters_of(const fem::MuscleBody& start,
                                     const std::vector<FreeBodyParameter>& free) {
  std::vector<Parameter> parameters;
  for (const FreeBodyParameter& f : free) {
    Parameter p;
    p.owner = start.name;
    p.name = f.name;
    p.start = fem::body_value(start, f.name);
    for (const fem::BodyParameter& known : fem::body_parameters()) {
      if (known.name != f.name) continue;
      p.unit = known.unit;
      p.lower = std::isfinite(f.lower) ? f.lower : known.lower;
      p.upper = std::isfinite(f.upper) ? f.upper : known.upper;
    }
    p.scale = 0.5 * (p.upper - p.lower);
    parameters.push_back(std::move(p));
  }
  check_parameters(parameters);
  return parameters;
}

class Problem final : public LeastSquaresProblem {
 public:
  Problem(fem::MuscleBody start, std::vector<Parameter> parameters,
          const std::vector<ReferenceForce>& references, const MuscleForceModel& model)
      : start_(std::move(start)), parameters_(std::move(parameters)), references_(references), model_(model) {
    const auto m = static_cast<Eigen::Index>(references.size());
    reference_.resize(m);
    scale_.resize(m);
    std::map<std::pair<std::string, Measure>, double> square;
    for (const ReferenceForce& r : references) square[{r.set, r.measure}] += r.weight * r.value * r.value;
    const auto sets =
        std::count_if(square.begin(), square.end(), [](const auto& s) { return s.second > 0.0; });
    if (sets == 0) {
      throw data::InputError("no-references", fmt::format("{}: no reference has a weight", start_.name),
                             "give forces or moments other than 0 with weights above 0");
    }
    for (Eigen::Index i = 0; i < m; ++i) {
      const ReferenceForce& r = references[static_cast<std::size_t>(i)];
      reference_[i] = r.value;
      const double whole = static_cast<double>(sets) * square.at({r.set, r.measure});
      scale_[i] = r.weight > 0.0 && whole > 0.0 ? std::sqrt(r.weight / whole) : 0.0;
    }
  }

  const std::vector<Parameter>& parameters() const override { return parameters_; }
  std::size_t residual_count() const override { return references_.size(); }
  std::string residual_name(std::size_t i) const override { return place(references_[i]); }

  fem::MuscleBody body(const Eigen::VectorXd& x) const {
    fem::MuscleBody b = start_;
    std::vector<std::pair<std::string, double>> values;
    for (std::size_t j = 0; j < parameters_.size(); ++j)
      values.emplace_back(parameters_[j].name, x[static_cast<Eigen::Index>(j)]);
    fem::set_body_values(b, values);
    return b;
  }

  std::unique_ptr<Evaluator> evaluator() const override {
    struct Own final : Evaluator {
      Own(const Problem& p, std::unique_ptr<MuscleForces> m) : problem(p), model(std::move(m)) {}
      void evaluate(const Eigen::VectorXd& x, Eigen::VectorXd& r, Eigen::MatrixXd* J) override {
        const Eigen::VectorXd here = model->values(problem.body(x), false);
        r = problem.scale_.cwiseProduct(here - problem.reference_);
        if (!J) return;
        J->resize(r.size(), x.size());
        for (Eigen::Index j = 0; j < x.size(); ++j) {
          const Parameter& p = problem.parameters_[static_cast<std::size_t>(j)];
          Eigen::VectorXd moved = x;
          const double step = difference * (p.upper - p.lower);
          moved[j] += x[j] + step <= p.upper ? step : -step;
          const Eigen::VectorXd there = model->values(problem.body(moved), true);
          J->col(j) = problem.scale_.cwiseProduct(there - here) / (moved[j] - x[j]);
        }
      }
      const Problem& problem;
      std::unique_ptr<MuscleForces> model;
    };
    return std::make_unique<Own>(*this, model_.make(references_));
  }

 private:
  fem::MuscleBody start_;
  std::vector<Parameter> parameters_;
  const std::vector<ReferenceForce>& references_;
  const MuscleForceModel& model_;
  Eigen::VectorXd reference_, scale_;
};

}  // namespace

MuscleForceFit fit_muscle_forces(const fem::MuscleBody& start, const std::vector<FreeBodyParameter>& free,
                                 const std::vector<ReferenceForce>& references, const MuscleForceModel& model,
                                 const SolveOptions& options) {
  const Problem problem(start, parameters_of(start, free), references, model);
  MuscleForceFit fit;
  fit.summary = solve(problem, options);
  fit.body = problem.body(fit.summary.x);
  Eigen::VectorXd r;
  Eigen::MatrixXd J;
  problem.evaluator()->evaluate(fit.summary.x, r, &J);
  fit.value = model.make(references)->values(fit.body, false);
  fit.statistics =
      fit_statistics(problem.parameters(), fit.summary.x, r, J, {{start.name, 0, references.size()}});
  VerdictInput input;
  input.parameters = &problem.parameters();
  input.x = input.x_uncorrected = fit.summary.x;
  input.bias = Eigen::VectorXd::Zero(fit.summary.x.size());
  input.statistics = &fit.statistics;
  // Straight, not along profiles: a profile costs dozens of Jacobians, each of all states of all parameters.
  const Eigen::VectorXd half =
      student_quantile(fit.statistics.degrees_of_freedom) * fit.statistics.standard_error;
  input.intervals = {fit.summary.x - half, fit.summary.x + half};
  fit.verdicts = verdicts(input);
  return fit;
}

std::vector<ForceAgreement> agreement(const std::vector<ReferenceForce>& references,
                                      const Eigen::VectorXd& value) {
  std::vector<ForceAgreement> out;
  std::vector<double> error, size;
  for (std::size_t i = 0; i < references.size(); ++i) {
    const ReferenceForce& r = references[i];
    const std::string set = r.weight > 0.0 ? r.set : r.set + ", not fitted";
    auto at = std::find_if(out.begin(), out.end(),
                           [&](const ForceAgreement& a) { return a.set == set && a.measure == r.measure; });
    if (at == out.end()) {
      out.push_back({set, r.measure});
      error.push_back(0.0);
      size.push_back(0.0);
      at = out.end() - 1;
    }
    const auto k = static_cast<std::size_t>(at - out.begin());
    const double e = value[static_cast<Eigen::Index>(i)] - r.value;
    ++at->states;
    error[k] += e * e;
    size[k] += r.value * r.value;
    if (std::abs(e) > std::abs(at->worst)) {
      at->worst = e;
      at->worst_q_rad = r.q_rad;
      at->worst_activation = r.activation;
    }
  }
  for (std::size_t k = 0; k < out.size(); ++k) {
    out[k].relative_l2 = std::sqrt(error[k] / size[k]);
    out[k].rms = std::sqrt(error[k] / static_cast<double>(out[k].states));
  }
  return out;
}

}  // namespace brachium::optimise
