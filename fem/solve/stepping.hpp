#pragma once
/// The walk along the programme: one load step after another, cut where Newton fails, grown where it is
/// quick.
///
/// A step that fails is halved. After `cuts_before_relaxation` halvings in a row (or at the smallest step)
/// the state is continued by viscous flow, where options ask for it; else the solve ends with its reason.
/// Every number is bounded. An unstable state that follows a stable one may lie on another branch that a long
/// step has led to: steps longer than 1/16 of a phase are halved before it is believed. A step that needed at
/// most 4 factorisations doubles the next, at most 7 leaves it a quarter longer, more than 10 makes it a
/// third shorter.

#include <string>

#include "fem/solve/newton.hpp"
#include "fem/solve/programme.hpp"

namespace brachium::fem {

class Stepper {
 public:
  Stepper(const Problem& problem, const SolveOptions& options, const Observer& observer,
          const Progress& progress);

  Summary run(const SolveState* restart);

 private:
  struct Attempt {
    bool accepted = false;
    std::string reason;
    Configuration configuration;
    Evaluation last;
    Stability stability;
  };
  const Problem& problem_;
  const SolveOptions& options_;
  const Observer& observer_;
  const Progress& progress_;
  Programme programme_;
  Equations equations_;
  TangentFactor factor_;
  SolveState state_;
  Summary summary_;

  void restore(const SolveState& restart);
  std::string begin_phase();
  std::string walk_phase();
  std::string take_step();
  std::string after_failure(Attempt& attempt, double h, double time, StepRecord& record, bool& again);
  Attempt try_newton(double time, StepRecord& record);
  void halve(const Attempt& attempt, double h, StepRecord& record);
  void relax(Attempt& attempt, const LoadPoint& from, const LoadPoint& to, bool disturb, StepRecord& record);
  void press(Attempt& attempt, const LoadPoint& load, StepRecord& record);
  bool wants_stability(double time) const;
  Configuration first_guess(const LoadPoint& from, const LoadPoint& to, double h, StepRecord& record,
                            Eigen::MatrixXd& pressure);
  void judge_stability(Attempt& attempt, double time);
  std::string settle(Attempt& attempt, double time, StepRecord& record);
  void accept(Attempt& attempt, double time, StepRecord& record);
  void count(const NewtonOutcome& outcome, StepRecord& record);
  void collect(double seconds);
  std::string place(double time) const;
};

}  // namespace brachium::fem
