#pragma once
/// Neural activation u to muscle activation a: the static nonlinearity of the EMG-to-force relation.
///
/// | symbol | identifier | unit | meaning                                                 |
/// |--------|------------|------|---------------------------------------------------------|
/// | u      | neural     | 1    | neural activation                                       |
/// | a      | value      | 1    | muscle activation                                       |
/// | A      | shape      | 1    | shape factor                                            |
/// | φ(x)   | phi        | 1    | (e^x - 1)/x, φ(0) = 1                                   |
/// | u0, a0 | u0, -      | 1    | node between the logarithmic and the linear piece       |
/// | m      | m          | 1    | slope of the linear piece                               |
/// | x, κ   | x, kappa   | 1    | logarithmic piece a = κ ln(1 + x u/u0)/x                |
///
/// exponential  a = (e^(A u) - 1) / (e^A - 1) = u φ(A u)/φ(A), -3 <= A <= 0; a = u at A = 0
///              (Lloyd & Besier 2003, doi:10.1016/S0021-9290(03)00010-1)
/// piecewise    a = α ln(β u + 1) for u < u0, a = m u + 1 - m for u >= u0, equal in value and slope at the node
///              (u0, a0) = (0.3085 - A/√2, 0.3085 + A/√2), 0 <= A <= 0.12; a = u at A = 0
///              (Manal & Buchanan 2003, doi:10.1016/S0021-9290(03)00152-0)
/// none         a = u
///
/// u < 0 (an envelope's undershoot) is not clamped: the exponential goes on as it is, the logarithm as its tangent.

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

/// Closed range of the shape factor: [-3, 0] exponential, [0, 0.12] piecewise, any finite number for none.
struct ShapeRange {
  double lower = 0.0, upper = 0.0;
};
ShapeRange shape_range(Nonlinearity nonlinearity);

/// The nonlinearity for one shape factor, prepared once for many samples.
class ShapedNonlinearity {
 public:
  /// Throws InputError("out-of-range") for a shape outside shape_range.
  ShapedNonlinearity(Nonlinearity kind, double shape);

  double operator()(double neural) const;
  NonlinearityValue with_derivatives(double neural) const;
  Nonlinearity kind() const { return kind_; }

 private:
  void prepare_exponential();
  void prepare_piecewise();

  Nonlinearity kind_;
  double shape_ = 0.0;
  double phi_ = 1.0, dphi_ = 0.5, inverse_expm1_ = 0.0;  // exponential: φ(A), φ'(A), 1/(e^A - 1)
  double u0_ = 0.3085, m_ = 1.0, x_ = 0.0, kappa_ = 0.3085, slope_at_0_ = 1.0;  // piecewise
  double du0_ = 0.0, dm_ = 0.0, dx_ = 0.0, dkappa_ = 0.0, dslope_at_0_ = 0.0;   // their derivatives in A
};

}  // namespace brachium::emg
