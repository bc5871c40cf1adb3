#include "tests/pipelines/view3d_sample.hpp"

#include <cmath>
#include <limits>
#include <numbers>

namespace brachium::tests {

using namespace pipelines::report;

View3d sample_view(int around, int along, int states) {
  View3d view{.title = "A spindle that <contracts> & \"bends\""};
  const double length = 120.0, nan = std::numeric_limits<double>::quiet_NaN();
  const int n = around * (along + 1) + 2;
  const int tendon_from = along * 3 / 4;
  const auto radius = [&](double s) { return 3.0 + 11.0 * std::pow(std::sin(std::numbers::pi * s), 2); };
  const auto place = [&](double f) {
    std::vector<double> x;
    const auto put = [&](double s, double r, double angle) {
      // Bent into a circular arc of angle `bend` in the x-z plane.
      const double bend = std::max(0.7 * f, 1e-6), arc = length * (1.0 - 0.18 * f) / bend, turn = bend * s;
      const double swell = r * (1.0 + 0.25 * f), y = swell * std::cos(angle), z = swell * std::sin(angle);
      x.insert(x.end(), {(arc - z) * std::sin(turn), y, arc - (arc - z) * std::cos(turn)});
    };
    for (int i = 0; i <= along; ++i) {
      const double s = static_cast<double>(i) / along;
      for (int k = 0; k < around; ++k) put(s, radius(s), 2.0 * std::numbers::pi * k / around);
    }
    put(0.0, 0.0, 0.0);
    put(1.0, 0.0, 0.0);
    return x;
  };
  view.reference = place(0.0);
  view.regions = {{.name = "muscle"}, {.name = "tendon"}};
  for (int i = 0; i < along; ++i) {
    ViewRegion& region = view.regions[i < tendon_from ? 0 : 1];
    for (int k = 0; k < around; ++k) {
      const int a = i * around + k, b = i * around + (k + 1) % around, c = a + around, d = b + around;
      region.triangles.push_back({a, b, c});
      region.triangles.push_back({b, d, c});
      region.edges.push_back({a, b});
      region.edges.push_back({a, c});
    }
  }
  for (int k = 0; k < around; ++k) {
    view.regions[0].triangles.push_back({n - 2, (k + 1) % around, k});
    view.regions[1].triangles.push_back({n - 1, along * around + k, along * around + (k + 1) % around});
  }
  view.fields = {
      {.label = "fibre stretch [1]"}, {.label = "von Mises stress [kPa]"}, {.label = "fibre stress [kPa]"}};
  for (int t = 0; t < states; ++t) {
    const double f = states > 1 ? static_cast<double>(t) / (states - 1) : 0.0;
    view.states.push_back({.label = "activate, " + std::to_string(t), .positions = place(f)});
    std::vector<double> stretch, mises, fibre;
    for (int p = 0; p < n; ++p) {
      const double s = p < n - 2 ? static_cast<double>(p / around) / along : p - (n - 2);
      const double around_angle = 2.0 * std::numbers::pi * (p % around) / around;
      stretch.push_back(1.0 -
                        0.2 * f * std::sin(std::numbers::pi * s) * (1.0 + 0.3 * std::cos(around_angle)));
      mises.push_back(20.0 + 60.0 * f * s + (p == 0 ? 4000.0 : 0.0));
      fibre.push_back(s < 0.75 ? 150.0 * f * s : nan);
    }
    view.fields[0].values.push_back(std::move(stretch));
    view.fields[1].values.push_back(std::move(mises));
    view.fields[2].values.push_back(std::move(fibre));
  }
  return view;
}

}  // namespace brachium::tests
