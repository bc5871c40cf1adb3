#include "pipelines/report/colour_map.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace brachium::pipelines::report {
namespace {

using Triple = std::array<double, 3>;

constexpr Rgb kNoValue{150, 150, 150};
constexpr int kFine = 1024;   // points at which the path through OKLab is measured
constexpr int kCoarse = 120;  // points at which its chroma is found

double to_linear(double v) {
  return v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4);
}

double to_srgb(double v) {
  return v <= 0.0031308 ? 12.92 * v : 1.055 * std::pow(v, 1.0 / 2.4) - 0.055;
}

/// Linear sRGB of OKLab: l' = L + ..., l = l'^3 (inverse of the matrices of Ottosson 2020).
Triple linear_rgb(const Triple& lab) {
  const double l = std::pow(lab[0] + 0.3963377774 * lab[1] + 0.2158037573 * lab[2], 3);
  const double m = std::pow(lab[0] - 0.1055613458 * lab[1] - 0.0638541728 * lab[2], 3);
  const double s = std::pow(lab[0] - 0.0894841775 * lab[1] - 1.2914855480 * lab[2], 3);
  return {4.0767416621 * l - 3.3077115913 * m + 0.2309699292 * s,
          -1.2684380046 * l + 2.6097574011 * m - 0.3413193965 * s,
          -0.0041960863 * l - 0.7034186147 * m + 1.7076147010 * s};
}

bool in_gamut(const Triple& rgb) {
  return std::all_of(rgb.begin(), rgb.end(), [](double v) { return v >= 0.0 && v <= 1.0; });
}

double lightness_at(double u) {
  return 0.38 + 0.52 * u;
}
double hue_at(double u) {
  return (275.0 - 175.0 * u) * std::numbers::pi / 180.0;
}

Triple lch(double lightness, double chroma, double hue) {
  return {lightness, chroma * std::cos(hue), chroma * std::sin(hue)};
}

/// Largest chroma up to 0.15 that sRGB holds at that lightness and hue.
double held_chroma(double lightness, double hue) {
  double low = 0.0, high = 0.15;
  if (in_gamut(linear_rgb(lch(lightness, high, hue)))) return high;
  for (int k = 0; k < 40; ++k) {
    const double middle = 0.5 * (low + high);
    (in_gamut(linear_rgb(lch(lightness, middle, hue))) ? low : high) = middle;
  }
  return low;
}

/// Chroma along the path: what sRGB holds, without its kinks. A moving mean of moving minima over the same
/// window never exceeds it.
const std::array<double, kCoarse + 1>& chromas() {
  static const std::array<double, kCoarse + 1> smooth = [] {
    constexpr int window = kCoarse / 6;
    const auto at = [](int k) { return static_cast<double>(std::clamp(k, 0, kCoarse)) / kCoarse; };
    std::array<double, kCoarse + 1> held{}, least{}, mean{};
    for (int k = 0; k <= kCoarse; ++k)
      held[static_cast<std::size_t>(k)] = held_chroma(lightness_at(at(k)), hue_at(at(k)));
    const auto value = [](const std::array<double, kCoarse + 1>& of, int k) {
      return of[static_cast<std::size_t>(std::clamp(k, 0, kCoarse))];
    };
    for (int k = 0; k <= kCoarse; ++k) {
      double m = 1.0;
      for (int j = -window; j <= window; ++j) m = std::min(m, value(held, k + j));
      least[static_cast<std::size_t>(k)] = m;
    }
    for (int k = 0; k <= kCoarse; ++k) {
      double sum = 0.0;
      for (int j = -window; j <= window; ++j) sum += value(least, k + j);
      mean[static_cast<std::size_t>(k)] = sum / (2 * window + 1);
    }
    return mean;
  }();
  return smooth;
}

/// The path, u in [0, 1]: lightness 0.38 -> 0.90, hue 275 -> 100 degrees.
Triple path(double u) {
  const double place = u * kCoarse;
  const int k = std::min(static_cast<int>(place), kCoarse - 1);
  const double part = place - k, below = chromas()[static_cast<std::size_t>(k)],
               above = chromas()[static_cast<std::size_t>(k) + 1];
  return lch(lightness_at(u), below + part * (above - below), hue_at(u));
}

double distance(const Triple& a, const Triple& b) {
  return std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);
}

/// u by fraction of the path's length.
const std::array<double, kFine + 1>& arc() {
  static const std::array<double, kFine + 1> length = [] {
    std::array<double, kFine + 1> sum{};
    Triple before = path(0.0);
    for (int k = 1; k <= kFine; ++k) {
      const Triple here = path(static_cast<double>(k) / kFine);
      sum[static_cast<std::size_t>(k)] = sum[static_cast<std::size_t>(k) - 1] + distance(before, here);
      before = here;
    }
    for (double& s : sum) s /= sum.back() > 0.0 ? sum.back() : 1.0;
    return sum;
  }();
  return length;
}

std::uint8_t byte_of(double linear) {
  return static_cast<std::uint8_t>(std::lround(255.0 * std::clamp(to_srgb(linear), 0.0, 1.0)));
}

}  // namespace

std::array<double, 3> oklab(const Rgb& colour) {
  const double r = to_linear(colour.red / 255.0), g = to_linear(colour.green / 255.0),
               b = to_linear(colour.blue / 255.0);
  const double l = std::cbrt(0.4122214708 * r + 0.5363325363 * g + 0.0514459929 * b);
  const double m = std::cbrt(0.2119034982 * r + 0.6806995451 * g + 0.1073969566 * b);
  const double s = std::cbrt(0.0883024619 * r + 0.2817188376 * g + 0.6299787005 * b);
  return {0.2104542553 * l + 0.7936177850 * m - 0.0040720468 * s,
          1.9779984951 * l - 2.4285922050 * m + 0.4505937099 * s,
          0.0259040371 * l + 0.7827717662 * m - 0.8086757660 * s};
}

Rgb scale_colour(double t) {
  if (std::isnan(t)) return kNoValue;
  t = std::clamp(t, 0.0, 1.0);
  const auto& length = arc();
  const auto above = std::lower_bound(length.begin(), length.end(), t);
  double u = 0.0;
  if (above != length.begin()) {
    const auto below = above - 1;
    const double part = *above > *below ? (t - *below) / (*above - *below) : 0.0;
    u = (static_cast<double>(below - length.begin()) + part) / kFine;
  }
  const Triple rgb = linear_rgb(path(u));
  return {byte_of(rgb[0]), byte_of(rgb[1]), byte_of(rgb[2])};
}

std::string hex(const Rgb& colour) {
  return fmt::format("#{:02x}{:02x}{:02x}", colour.red, colour.green, colour.blue);
}

}  // namespace brachium::pipelines::report
