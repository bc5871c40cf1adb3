#pragma once
/// Colours of a quantity: a scale that looks as even as the values are.
///
/// Lightness and hue of OKLCH (Ottosson 2020, "A perceptual color space for image processing",
/// bottosson.github.io/posts/oklab) run from a deep blue to a light yellow; colours are spaced so that equal
/// steps of the value are equal distances in OKLab. Ordered by lightness, so that it also reads in grey and
/// with colour blindness; both ends stand out from white and from the page's dark ground.

#include <array>
#include <cstdint>
#include <string>

namespace brachium::pipelines::report {

struct Rgb {
  std::uint8_t red = 0, green = 0, blue = 0;
  auto operator<=>(const Rgb&) const = default;
};

/// OKLab coordinates (L, a, b) of an sRGB colour.
std::array<double, 3> oklab(const Rgb& colour);

/// The scale at t in [0, 1]; values outside are brought to its ends. Not a number: neutral grey.
Rgb scale_colour(double t);

/// "#0a1b2c"
std::string hex(const Rgb& colour);

}  // namespace brachium::pipelines::report
