#pragma once
/// Direct solvers for the symmetric tangents of Newton's method: one analysis per mesh, one factorisation per
/// iteration, any number of right-hand sides. All indices count unknowns from 0 in the caller's order.

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "fem/linear/symmetric_pattern.hpp"

namespace brachium::fem {

/// How unknowns are reordered before elimination. automatic: METIS' nested dissection, minimum degree (AMD)
/// where fewer than 200 blocks are left to order.
enum class Ordering { metis, amd, automatic };

struct SolverOptions {
  int threads = 1;  ///< 0: all cores
  bool deterministic =
      true;  ///< the same bits for any number of threads; "ldl" always is, the others then use one
  Ordering ordering = Ordering::automatic;
  double zero_pivot = 1e-12;  ///< a pivot d_i is zero when |d_i| <= zero_pivot max(|a_ii|, (|L| |D| |L'|)_ii)
  double growth_limit = 1e8;  ///< "ldl" is unstable beyond this growth
  bool fall_back = true;      ///< "ldl" hands an unstable matrix to UMFPACK, and says so in its method
};

enum class FactorKind {
  positive_definite,
  indefinite,
  regular,   ///< factorised by a method that does not tell the signs of the eigenvalues
  singular,  ///< `zero_unknowns` says where
  unstable   ///< "ldl" only, without fall-back: no usable pivot inside a front although the matrix may be
             ///< regular
};

struct FactorStatus {
  FactorKind kind = FactorKind::regular;
  std::vector<int>
      zero_unknowns;  ///< unknowns whose pivot vanished, ascending; the first of them in elimination order:
  int first_zero_unknown = -1;
  double first_zero_pivot = 0.0;

  bool solvable() const { return kind != FactorKind::singular && kind != FactorKind::unstable; }
};

/// Signs of the eigenvalues by Sylvester's law of inertia: A = L D L' has as many negative eigenvalues as D.
struct Inertia {
  long negative = 0, zero = 0, positive = 0;
  /// max_i (|L| |D| |L'|)_ii / max(|a_ii|, |d_i|): 1 for a definite matrix. The factors are those of a matrix
  /// that differs from A by a small multiple of eps times this (Higham 2002, doi:10.1137/1.9780898718027,
  /// theorem 11.3). NaN where not measured.
  double growth = 0.0;
  std::string method;  ///< by what the signs were counted
};

struct SolverStatistics {
  std::string method;                         ///< what the last factorisation was made by, for a log
  std::string ordering;                       ///< what the order was made by
  long long factor_entries = 0;               ///< non-zeros of L, diagonal included (L + U for UMFPACK)
  double flops = 0.0;                         ///< additions and multiplications of one factorisation
  long long memory_bytes = 0;                 ///< high water of factor and work space
  double analyse_s = 0.0, factorise_s = 0.0;  ///< wall time of the last call
  double largest_multiplier = 0.0;            ///< max |L_ij|; 0 where not measured
  long pivoted_blocks = 0;                    ///< diagonal blocks in which rows were interchanged ("ldl")
};

/// Unknowns that share their adjacency, for a quick and better ordering, and unknowns without stiffness of
/// their own.
struct UnknownGroups {
  /// Block of each unknown, any labels >= 0: the displacements of a node. Empty: every unknown is its own
  /// block.
  std::vector<int> block_of_unknown;
  /// 1 for an unknown whose diagonal is zero, or might be: a pressure. It is eliminated after displacements
  /// that it couples to. Empty: none. A block holds unknowns of one kind only.
  std::vector<char> constraint;
};

class SymmetricSolver {
 public:
  virtual ~SymmetricSolver() = default;

  /// Orders the unknowns and allocates the factor. InputError("linear-pattern"), InputError("linear-size").
  virtual void analyse(const SymmetricPattern& pattern, const UnknownGroups& groups = {}) = 0;

  /// Factorises the matrix with these values (one per entry of the pattern). InputError("linear-size"),
  /// InputError("linear-value") at a value that is not finite, InputError("linear-order") before analyse.
  virtual FactorStatus factorise(std::span<const double> values) = 0;

  /// x := A^-1 x for `columns` right-hand sides, one after the other, each of n entries.
  /// InputError("linear-size"), InputError("linear-order") without a factorisation that is solvable.
  virtual void solve(std::span<double> x, int columns = 1) const = 0;

  /// Signs of the eigenvalues of the matrix last factorised; none where the method does not tell.
  virtual std::optional<Inertia> inertia() const = 0;

  virtual SolverStatistics statistics() const = 0;
};

/// Solvers by name:
///   "ldl"      supernodal multifrontal L D L', definite and indefinite alike, gives the inertia
///   "cholmod"  supernodal Cholesky; an indefinite matrix goes to a simplicial L D L' that counts negative
///   pivots "umfpack"  unsymmetric LU with partial pivoting of the expanded matrix: robust, no inertia
/// InputError("unknown-solver").
std::unique_ptr<SymmetricSolver> make_symmetric_solver(const std::string& name,
                                                       const SolverOptions& options = {});

/// Names that make_symmetric_solver takes.
const std::vector<std::string>& symmetric_solver_names();

}  // namespace brachium::fem
