#pragma once
/// Number of threads inside SuiteSparse. OpenBLAS keeps one number for the whole process: it is set at each
/// factorisation and solve of a solver that calls it, so two such solvers that run side by side with
/// different numbers disturb each other's speed, never each other's result beyond rounding. "ldl" does not
/// call OpenBLAS.

namespace brachium::fem {

/// Sets the number of OpenBLAS' threads while it lives, the former number afterwards.
class BlasThreads {
 public:
  explicit BlasThreads(int threads);
  ~BlasThreads();
  BlasThreads(const BlasThreads&) = delete;
  BlasThreads& operator=(const BlasThreads&) = delete;

 private:
  int former_;
};

}  // namespace brachium::fem
