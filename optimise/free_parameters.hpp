#pragma once
/// Which numbers of which muscles a vector of free parameters stands for. Internal to optimise/.

#include <string>
#include <vector>

#include "optimise/calibration_problem.hpp"

namespace brachium::optimise {

/// One number a free parameter sets: value = x, or value = base * x for a shared factor.
struct Target {
  Quantity quantity = Quantity::strength;
  std::size_t index = 0;  ///< muscle, or channel for gains
  double base = 0.0;      ///< > 0: x is a factor on it; 0: x is the value
  double slope() const { return base > 0.0 ? base : 1.0; }
};

/// All numbers of the chain.
struct ChainValues {
  struct Muscle {
    data::MuscleParameters parameters;
    data::ActivationParameters activation;
    double recursion_1 = 0.0, recursion_2 = 0.0;  ///< recursive form only

    double get(Quantity quantity) const;
    void set(Quantity quantity, double value);
  };
  std::vector<Muscle> muscles;
  std::vector<double> gains;
};

struct FreeParameters {
  std::vector<Parameter> parameters;
  std::vector<std::vector<Target>> targets;  ///< by parameter

  ChainValues apply(ChainValues start, const Eigen::VectorXd& x) const;
};

/// What a list of free quantities means for these muscles and channels; problems go to `found`.
FreeParameters expand(const std::vector<FreeQuantity>& free, const std::vector<data::SceneMuscle>& muscles,
                      const std::vector<bool>& driven, const std::vector<std::string>& channels,
                      const ChainValues& start, const ModelChoice& model,
                      std::vector<data::Diagnostic>& found);

bool is_activation(Quantity quantity);  ///< delay, time constants, recursion, shape
bool is_shared_as_factor(Quantity quantity);

}  // namespace brachium::optimise
