#include "pipelines/report/thin.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <random>
#include <sstream>
#include <utility>

#include "pipelines/report/path.hpp"

namespace brachium::pipelines::report {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

struct Curve {
  std::vector<double> x, y;
};

Curve noisy_curve() {
  Curve curve;
  std::mt19937 generator(3);
  std::normal_distribution<double> noise(0.0, 5.0);
  for (int i = 0; i < 60000; ++i) {
    curve.x.push_back(960.0 * i / 60000.0);
    curve.y.push_back(90.0 + 40.0 * std::sin(i / 4000.0) + noise(generator));
  }
  curve.y[12345] = -70.0;  // a spike of one sample
  curve.y[45678] = 260.0;
  return curve;
}

Curve keep(const Curve& curve, const std::vector<std::size_t>& kept) {
  Curve out;
  for (const std::size_t i : kept) {
    out.x.push_back(curve.x[i]);
    out.y.push_back(curve.y[i]);
  }
  return out;
}

/// What a line drawing shows: the lowest and highest ink of every column of pixels, joins between columns
/// included.
std::map<int, std::pair<double, double>> ink(const Curve& curve) {
  std::map<int, std::pair<double, double>> columns;
  const auto touch = [&](double x, double y) {
    const auto [entry, is_new] = columns.try_emplace(static_cast<int>(std::floor(x)), y, y);
    entry->second.first = std::min(entry->second.first, y);
    entry->second.second = std::max(entry->second.second, y);
  };
  for (std::size_t i = 0; i < curve.x.size(); ++i) {
    touch(curve.x[i], curve.y[i]);
    if (i == 0) continue;
    for (double edge = std::floor(curve.x[i - 1]) + 1.0; edge <= curve.x[i]; edge += 1.0) {
      const double u = (edge - curve.x[i - 1]) / (curve.x[i] - curve.x[i - 1]);
      const double y = curve.y[i - 1] + u * (curve.y[i] - curve.y[i - 1]);
      touch(edge - 1e-9, y);
      touch(edge, y);
    }
  }
  return columns;
}

double largest_difference(const Curve& a, const Curve& b) {
  const auto ink_a = ink(a);
  const auto ink_b = ink(b);
  double largest = 0.0;
  for (const auto& [column, range] : ink_a) {
    const auto other = ink_b.find(column);
    if (other == ink_b.end()) return std::numeric_limits<double>::infinity();
    largest = std::max({largest, std::abs(range.first - other->second.first),
                        std::abs(range.second - other->second.second)});
  }
  return largest;
}

TEST(ReportThin, TheThinnedLineShowsTheSamePictureInEveryColumn) {
  const Curve curve = noisy_curve();
  const std::vector<std::size_t> kept = thin_line(curve.x, curve.y);
  EXPECT_LE(kept.size(), 4u * 960u);
  EXPECT_LT(largest_difference(curve, keep(curve, kept)), 1e-9);
}

TEST(ReportThin, TakingEveryNthSampleInsteadWouldNot) {
  const Curve curve = noisy_curve();
  std::vector<std::size_t> kept;
  for (std::size_t i = 0; i < curve.x.size(); i += 15) kept.push_back(i);
  EXPECT_GT(largest_difference(curve, keep(curve, kept)), 50.0);
}

TEST(ReportThin, KeepsBothExtremesAndBothEnds) {
  const Curve curve = noisy_curve();
  const std::vector<std::size_t> kept = thin_line(curve.x, curve.y);
  for (const std::size_t i : {std::size_t{0}, std::size_t{12345}, std::size_t{45678}, curve.x.size() - 1}) {
    EXPECT_TRUE(std::binary_search(kept.begin(), kept.end(), i)) << i;
  }
  EXPECT_TRUE(std::is_sorted(kept.begin(), kept.end()));
}

TEST(ReportThin, BreaksSurviveEvenWithinOneColumn) {
  const std::vector<double> x = {0.1, 0.2, 0.3, 0.4, 0.5};
  const std::vector<double> y = {1.0, 2.0, kNan, 3.0, 4.0};
  EXPECT_EQ(thin_line(x, y), (std::vector<std::size_t>{0, 1, 2, 3, 4}));
  EXPECT_TRUE(thin_line({}, {}).empty());
  EXPECT_EQ(thin_line(std::vector<double>{kNan, kNan}, std::vector<double>{1.0, 2.0}),
            (std::vector<std::size_t>{0}));
}

TEST(ReportThin, PointsCoverTheSameSquares) {
  const Curve curve = noisy_curve();
  const std::vector<std::size_t> kept = thin_points(curve.x, curve.y, 3.0);
  const auto cell = [&](std::size_t i) {
    return std::pair(std::floor(curve.x[i] / 3.0), std::floor(curve.y[i] / 3.0));
  };
  std::map<std::pair<double, double>, int> all, thinned;
  for (std::size_t i = 0; i < curve.x.size(); ++i) ++all[cell(i)];
  for (const std::size_t i : kept) ++thinned[cell(i)];
  EXPECT_EQ(all.size(), thinned.size());
  EXPECT_EQ(thinned.size(), kept.size());
}

TEST(ReportPath, RoundingNeverAddsUp) {
  PathWriter path;
  path.move_to(0.0, 0.0);
  double x = 0.0;
  for (int i = 1; i <= 1000; ++i) {
    x = 0.333 * i;
    path.line_to(x, i % 2 == 0 ? 0.0 : 1.26);
  }
  // Read back: M x y l dx dy dx dy ..., numbers separated by spaces or minus signs.
  std::string text = path.text();
  ASSERT_EQ(text.substr(0, 5), "M0 0l");
  text = text.substr(5);
  std::string spaced;
  for (const char c : text) spaced += c == '-' ? " -" : std::string(1, c);
  std::istringstream numbers(spaced);
  double at_x = 0.0;
  double at_y = 0.0;
  double dx = 0.0;
  double dy = 0.0;
  while (numbers >> dx >> dy) {
    at_x += dx;
    at_y += dy;
  }
  EXPECT_NEAR(at_x, x, 0.051);
  EXPECT_NEAR(at_y, 0.0, 0.051);
}

TEST(ReportPath, IsWrittenShort) {
  PathWriter path;
  path.move_to(0.5, 10.0);
  path.line_to(1.0, 9.5);
  path.line_to(1.01, 9.52);  // less than a tenth: not drawn
  path.line_to(2.0, 9.5);
  path.close();
  EXPECT_EQ(path.text(), "M.5 10l.5-.5 1 0z");
}

}  // namespace
}  // namespace brachium::pipelines::report
