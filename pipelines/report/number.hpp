#pragma once
/// Numbers as a reader wants them: as many digits as they deserve, a true minus sign, powers of ten set as
/// such. Independent of the locale.

#include <string>

namespace brachium::pipelines::report {

/// `value` rounded to significant digits (1..17): 0.1235, 1.50, 12. Trailing zeros stay, as they are
/// significant; digits before the decimal point are never replaced by zeros (123456 stays 123456). Outside
/// [1e-4, 1e7) as 1.2×10⁻⁷. Not a number: "–"; infinite: "∞". Minus is U+2212.
std::string significant(double value, int digits = 4);

/// `value` with a fixed number of decimals (0..17); never "−0".
std::string fixed(double value, int decimals);

/// "1.50 N m": number and unit joined by a narrow no-break space; unit "1" or "" gives the number alone.
std::string quantity(double value, const std::string& unit, int digits = 4);

/// 0.0421 -> "4.2 %".
std::string percent(double fraction, int digits = 2);

/// "0.8 s", "3 min 12 s", "2 h 05 min".
std::string duration(double seconds);

/// The smallest text of a length in pixels, rounded to a tenth: "12.3", "-.5", "7"; for SVG.
std::string pixels(double length);

/// Tenths of a pixel as the same text.
std::string tenths(long tenth);

}  // namespace brachium::pipelines::report
