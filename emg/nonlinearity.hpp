#pragma once
/// Neural activation u to muscle activation a: the static nonlinearity of the EMG-to-force relation.
///
/// exponential  a = (e^(A u) - 1) / (e^A - 1), -3 < A < 0, and its limit a = u at A = 0
///              (Lloyd & Besier 2003, doi:10.1016/S0021-9290(03)00010-1)
/// piecewise    a = α ln(β u + 1) for u < u0,  a = m u + c for u >= u0, with one parameter 0 < A <= 0.12
///              (Manal & Buchanan 2003, doi:10.1016/S0021-9290(03)00152-0)
/// none         a = u

#include <string>

namespace brachium::emg {

enum class Nonlinearity { exponential, piecewise, none };

std::string to_string(Nonlinearity nonlinearity);
Nonlinearity parse_nonlinearity(const std::string& name);  ///< throws InputError("unknown-nonlinearity")

/// a and its derivatives at one u.
struct NonlinearityValue {
  double value = 0.0;   ///< a
  double slope = 0.0;   ///< da/du
  double dshape = 0.0;  ///< da/dA
};

/// The nonlinearity for one shape factor, prepared once for many samples. Throws InputError("out-of-range") for a
/// shape outside [-3, 0] (exponential) or [0, 0.12] (piecewise; 0 is the straight line).
class ShapedNonlinearity {
 public:
  ShapedNonlinearity(Nonlinearity kind, double shape);

  double operator()(double neural) const;
  NonlinearityValue with_derivatives(double neural) const;
  Nonlinearity kind() const { return kind_; }

 private:
  Nonlinearity kind_;
  double shape_ = 0.0;
  // exponential: φ(A) = (e^A - 1)/A and its derivative; 1/(e^A - 1) where A is not small.
  double phi_ = 1.0, dphi_ = 0.5, inverse_expm1_ = 0.0;
  // piecewise: node and coefficients, with their derivatives with respect to A.
  double u0_ = 0.0, alpha_ = 0.0, beta_ = 0.0, m_ = 1.0, c_ = 0.0;
  double dalpha_ = 0.0, dbeta_ = 0.0, dm_ = 0.0, dc_ = 0.0;
};

}  // namespace brachium::emg
