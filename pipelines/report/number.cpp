#include "pipelines/report/number.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <string_view>

#include "pipelines/report/text.hpp"

namespace brachium::pipelines::report {
namespace {

constexpr std::string_view kMinus = "−";

std::string with_true_minus(const std::string& number) {
  return number.starts_with('-') ? std::string(kMinus) + number.substr(1) : number;
}

bool is_zero_text(const std::string& number) {
  return std::all_of(number.begin(), number.end(), [](char c) { return c == '0' || c == '.' || c == '-'; });
}

std::string not_finite(double value) {
  if (std::isnan(value)) return "–";
  return value > 0 ? "∞" : std::string(kMinus) + "∞";
}

}  // namespace

std::string significant(double value, int digits) {
  if (!std::isfinite(value)) return not_finite(value);
  if (value == 0.0) return "0";
  digits = std::clamp(digits, 1, 17);
  // Rounding first: 9.9996 to four digits has the exponent of 10.00.
  const std::string scientific = fmt::format("{:.{}e}", value, digits - 1);
  const std::size_t e = scientific.find('e');
  const int exponent = std::atoi(scientific.c_str() + e + 1);
  if (exponent < -4 || exponent >= 7) {
    const std::string power = typeset_unit("10^" + std::to_string(exponent));
    return with_true_minus(scientific.substr(0, e)) + "×" + power;
  }
  return with_true_minus(fmt::format("{:.{}f}", value, std::max(0, digits - 1 - exponent)));
}

std::string fixed(double value, int decimals) {
  if (!std::isfinite(value)) return not_finite(value);
  const std::string number = fmt::format("{:.{}f}", value, std::clamp(decimals, 0, 17));
  if (number.starts_with('-') && is_zero_text(number)) return number.substr(1);
  return with_true_minus(number);
}

std::string quantity(double value, const std::string& unit, int digits) {
  const std::string number = significant(value, digits);
  if (unit.empty() || unit == "1") return number;
  const std::string set = typeset_unit(unit);
  return number + (set.starts_with("°") ? "" : "\u202F") + set;
}

std::string percent(double fraction, int digits) {
  return quantity(100.0 * fraction, "%", digits);
}

std::string duration(double seconds) {
  if (!std::isfinite(seconds)) return not_finite(seconds);
  if (seconds < 0.0995) return fmt::format("{:.0f}\u202Fms", std::max(0.0, seconds) * 1e3);
  if (seconds < 9.95) return fmt::format("{:.1f}\u202Fs", seconds);
  if (seconds < 59.5) return fmt::format("{:.0f}\u202Fs", seconds);
  const double whole = std::round(seconds);
  if (whole < 3600.0)
    return fmt::format("{:.0f}\u202Fmin {:.0f}\u202Fs", std::floor(whole / 60.0), std::fmod(whole, 60.0));
  const double minutes = std::round(seconds / 60.0);
  return fmt::format("{:.0f}\u202Fh {:02.0f}\u202Fmin", std::floor(minutes / 60.0), std::fmod(minutes, 60.0));
}

std::string tenths(long tenth) {
  if (tenth == 0) return "0";
  std::string out = tenth < 0 ? "-" : "";
  const long size = std::labs(tenth);
  if (size >= 10) out += std::to_string(size / 10);
  if (size % 10 != 0) {
    out += '.';
    out += static_cast<char>('0' + size % 10);
  }
  return out;
}

std::string pixels(double length) {
  return tenths(std::lround(10.0 * length));
}

}  // namespace brachium::pipelines::report
