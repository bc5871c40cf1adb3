#include <fmt/format.h>

#include <algorithm>
#include <numbers>
#include <numeric>
#include <optional>

#include "data/model/error.hpp"
#include "fem/limb/strap.hpp"
#include "optimise/muscle_force_fit.hpp"

namespace brachium::optimise {
namespace {

/// A body that a fit tries may be one that cannot be built: no forces, rather than the user's mistake.
template <class F>
auto tried(const fem::MuscleBody& body, F&& f) {
  try {
    return f();
  } catch (const data::InputError& error) {
    if (error.diagnostics().front().code != "limb-geometry") throw;
    throw data::ConvergenceFailure({body.name, error.what(), 0, 0.0, 0.0, body.name});
  }
}

class StrapForces final : public MuscleForces {
 public:
  explicit StrapForces(const std::vector<ReferenceForce>& references) : references_(references) {}
  Eigen::VectorXd values(const fem::MuscleBody& body, bool) override {
    return tried(body, [&] {
      Eigen::VectorXd f(static_cast<Eigen::Index>(references_.size()));
      for (std::size_t i = 0; i < references_.size(); ++i)
        f[static_cast<Eigen::Index>(i)] = value(body, references_[i]);
      return f;
    });
  }

 private:
  static double value(const fem::MuscleBody& body, const ReferenceForce& r) {
    const double force_n = fem::strap_force_n(body, r.q_rad, r.activation);
    return r.measure == Measure::force ? force_n
                                       : force_n * fem::CablePath(body.cable, r.q_rad).lever_arm_m();
  }

  const std::vector<ReferenceForce>& references_;
};

class StrapModel final : public MuscleForceModel {
 public:
  std::unique_ptr<MuscleForces> make(const std::vector<ReferenceForce>& references) const override {
    return std::make_unique<StrapForces>(references);
  }
};

class ContinuumForces final : public MuscleForces {
 public:
  ContinuumForces(const ContinuumForceOptions& options, const std::vector<ReferenceForce>& references)
      : options_(options), references_(references), order_(references.size()) {
    // Passive states first, angle by angle: every other one then lies near a known one.
    std::iota(order_.begin(), order_.end(), std::size_t{0});
    std::stable_sort(order_.begin(), order_.end(), [&](std::size_t a, std::size_t b) {
      const ReferenceForce &x = references_[a], &y = references_[b];
      return std::pair(x.activation, x.q_rad) < std::pair(y.activation, y.q_rad);
    });
  }

  Eigen::VectorXd values(const fem::MuscleBody& body, bool variation) override {
    return tried(body, [&] {
      auto states = std::make_unique<fem::MuscleStates>(body, options_.range, options_.hinge, options_.bones,
                                                        options_.states, base_.get());
      Eigen::VectorXd f(static_cast<Eigen::Index>(references_.size()));
      for (const std::size_t i : order_) {
        const ReferenceForce& r = references_[i];
        const fem::SolvedMuscle& s = base_ ? states->solve_state_like(*base_, r.q_rad, r.activation)
                                           : states->solve_state(r.q_rad, r.activation);
        if (s.stability == "unstable") {
          throw data::ConvergenceFailure(
              {body.name,
               fmt::format("the state at {:.4g} deg, activation {:.4g} is unstable",
                           r.q_rad * 180.0 / std::numbers::pi, r.activation),
               0, 0.0, 0.0, body.name});
        }
        f[static_cast<Eigen::Index>(i)] = r.measure == Measure::force ? s.force_n : s.moment_n_m;
      }
      if (!variation) base_ = std::move(states);
      return f;
    });
  }

 private:
  const ContinuumForceOptions& options_;
  const std::vector<ReferenceForce>& references_;
  std::vector<std::size_t> order_;
  std::unique_ptr<fem::MuscleStates> base_;
};

class ContinuumModel final : public MuscleForceModel {
 public:
  explicit ContinuumModel(ContinuumForceOptions options) : options_(std::move(options)) {}
  std::unique_ptr<MuscleForces> make(const std::vector<ReferenceForce>& references) const override {
    return std::make_unique<ContinuumForces>(options_, references);
  }

 private:
  ContinuumForceOptions options_;
};

}  // namespace

std::unique_ptr<MuscleForceModel> strap_force_model() {
  return std::make_unique<StrapModel>();
}

std::unique_ptr<MuscleForceModel> continuum_force_model(const ContinuumForceOptions& options) {
  return std::make_unique<ContinuumModel>(options);
}

}  // namespace brachium::optimise
