#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <fstream>
#include <limits>
#include <set>
#include <stdexcept>

#include "pipelines/report/colour_map.hpp"
#include "pipelines/report/html.hpp"
#include "pipelines/report/view3d.hpp"
#include "tests/pipelines/view3d_sample.hpp"
#include "tests/support/paths.hpp"

namespace brachium::pipelines::report {
namespace {

using testing::HasSubstr;
using testing::Not;
using tests::sample_view;

Document page_with(View3d view) {
  Document document;
  document.title = "One view";
  document.sections = {{.title = "View", .blocks = {std::move(view)}}};
  return document;
}

std::size_t points(const View3d& view) {
  return view.states.front().positions.size() / 3;
}

/// Value of digits of base 64 from `at` on.
unsigned digits(const std::string& text, std::size_t at, int count) {
  const std::string alphabet = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  unsigned value = 0;
  for (int k = 0; k < count; ++k)
    value = value * 64 + static_cast<unsigned>(alphabet.find(text[at + static_cast<std::size_t>(k)]));
  return value;
}

// ---------------------------------------------------------------- colours

TEST(ColourMap, EqualStepsOfTheValueAreEqualStepsOfTheEye) {
  std::vector<double> steps;
  for (int k = 0; k < 20; ++k) {
    const auto a = oklab(scale_colour(k / 20.0)), b = oklab(scale_colour((k + 1) / 20.0));
    steps.push_back(std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]));
  }
  const auto [least, most] = std::minmax_element(steps.begin(), steps.end());
  EXPECT_LT(*most / *least, 1.12);  // eight bits a channel, and chords of a curved path
}

TEST(ColourMap, IsOrderedByLightnessSoThatItReadsInGrey) {
  for (int k = 0; k < 100; ++k)
    EXPECT_LT(oklab(scale_colour(k / 100.0))[0], oklab(scale_colour((k + 1) / 100.0))[0] + 2e-3) << k;
  EXPECT_GT(oklab(scale_colour(1.0))[0] - oklab(scale_colour(0.0))[0], 0.5);
}

TEST(ColourMap, WhatIsNoNumberIsGreyAndEndsHold) {
  const Rgb none = scale_colour(std::nan(""));
  EXPECT_EQ(none.red, none.green);
  EXPECT_EQ(scale_colour(-3.0), scale_colour(0.0));
  EXPECT_EQ(scale_colour(7.0), scale_colour(1.0));
}

TEST(ColourMap, OklabKnowsWhiteAndRed) {
  EXPECT_NEAR(oklab({255, 255, 255})[0], 1.0, 1e-6);
  EXPECT_NEAR(oklab({255, 0, 0})[0], 0.62796, 1e-4);
  EXPECT_NEAR(oklab({255, 0, 0})[1], 0.22486, 1e-4);
  EXPECT_NEAR(oklab({255, 0, 0})[2], 0.12585, 1e-4);
}

TEST(ColourRange, FewExtremeValuesAreCutAndTheCutIsSaid) {
  const View3d view = sample_view();
  const ColourRange plain = colour_range(view.fields[0]);
  EXPECT_FALSE(plain.cut_below || plain.cut_above);
  const ColourRange peaked = colour_range(view.fields[1]);
  EXPECT_TRUE(peaked.cut_above);
  EXPECT_FALSE(peaked.cut_below);
  EXPECT_LT(peaked.upper, 100.0);
}

TEST(ColourRange, AConstantAndNothingStillHaveARange) {
  EXPECT_LT(colour_range({.label = "", .values = {{2.0, 2.0}}}).lower, 2.0);
  EXPECT_GT(colour_range({.label = "", .values = {{2.0, 2.0}}}).upper, 2.0);
  const ColourRange none = colour_range({.label = "", .values = {{std::nan("")}}});
  EXPECT_LT(none.lower, none.upper);
}

// ---------------------------------------------------------------- data

TEST(View3d, DigitsOfBase64AreMostSignificantFirst) {
  std::string text;
  append_digits(text, 0, 2);
  append_digits(text, 63, 2);
  append_digits(text, 262143, 3);
  append_digits(text, 64 * 64 + 2, 3);
  EXPECT_EQ(text, "AAA////BAC");
}

TEST(View3d, PositionsAreTrueToFourMillionthsOfTheBody) {
  const View3d view = sample_view(12, 10, 2);
  const std::string html = draw_view3d(view);
  const auto number = [&](const std::string& key) {
    const std::size_t at = html.find("\"" + key + "\":") + key.size() + 3;
    return std::stod(html.substr(at + (html[at] == '[' ? 1 : 0)));
  };
  const double low_x = number("low"), side = number("side");
  const std::size_t second = html.find("\"x\":\"", html.find("\"x\":\"") + 1) + 5;
  for (std::size_t p = 0; p < points(view); ++p) {
    const double x = low_x + side * digits(html, second + 9 * p, 3) / 262143.0;
    EXPECT_NEAR(x, view.states[1].positions[3 * p], 2.1e-6 * side) << p;
  }
}

TEST(View3d, TextCannotEndTheScriptItStandsIn) {
  View3d view = sample_view(8, 6, 2);
  view.regions[0].name = "</script><b>\"\\ & it's";
  view.states[1].label = "</script>";
  view.fields[0].label = "a <b> [kPa]";
  const std::string html = draw_view3d(view);
  const std::size_t begin = html.find("<script"), end = html.find("</script>");
  EXPECT_EQ(html.find("</script>", end + 1), std::string::npos);
  EXPECT_THAT(html.substr(begin + 8, end - begin - 8), Not(HasSubstr("<")));
  EXPECT_THAT(html, HasSubstr("\\u003c/script\\u003e\\u003cb\\u003e\\u0022\\\\ \\u0026 it\\u0027s"));
}

TEST(View3d, APageWithAViewIsWellFormedAndFetchesNothing) {
  const std::filesystem::path file = tests::scratch_dir() / "view.html";
  std::ofstream(file, std::ios::binary) << render_html(page_with(sample_view()));
  if (std::system("python3 -c 'import html.parser' > /dev/null 2>&1") != 0) GTEST_SKIP() << "needs python3";
  const std::string script = (tests::source_dir() / "tests/pipelines/report_wellformed.py").string();
  EXPECT_EQ(std::system(("python3 '" + script + "' '" + file.string() + "'").c_str()), 0);
}

TEST(View3d, OnlyPagesWithAViewCarryItsScript) {
  EXPECT_THAT(render_html(page_with(sample_view(8, 6, 2))), HasSubstr("webgl2"));
  EXPECT_THAT(render_html({}), Not(HasSubstr("webgl2")));
}

TEST(View3d, ThePosterShowsFacesTowardsTheReaderOnly) {
  const View3d view = sample_view(24, 40, 2);
  const std::string poster = draw_poster(view);
  std::size_t faces = 0;
  for (std::size_t at = poster.find(" color="); at != std::string::npos; at = poster.find(" color=", at + 1))
    ++faces;
  const std::size_t all = view.regions[0].triangles.size() + view.regions[1].triangles.size();
  EXPECT_GT(faces, all * 2 / 5);
  EXPECT_LT(faces, all * 3 / 5);
}

TEST(View3d, TheFirstLookIsARightHandedFrameWithTheLongestAxisAcross) {
  for (const int longest : {0, 1, 2}) {
    View3d view{.title = "T"};
    view.states = {{.label = "s", .positions = {0, 0, 0, 1, 1, 1}}};
    view.states[0].positions[3 + static_cast<std::size_t>(longest)] = 4.0;
    const auto r = first_look(view);
    for (std::size_t k = 0; k < 3; ++k) {  // right x up = towards the reader
      EXPECT_NEAR(r[(k + 1) % 3] * r[3 + (k + 2) % 3] - r[(k + 2) % 3] * r[3 + (k + 1) % 3], r[6 + k], 1e-12);
    }
    EXPECT_GT(r[static_cast<std::size_t>(longest)], 0.85) << longest;
    if (longest != 2) {
      EXPECT_GT(r[5], 0.85) << "z points up";
    }
    EXPECT_GT(r[6 + (longest == 2 ? 1 : 2)], 0.0) << "seen from above";
  }
}

// ---------------------------------------------------------------- size

TEST(View3d, ASmallViewIsShownAsItIs) {
  const View3d view = sample_view();
  const View3d fitted = fitted_view(view);
  EXPECT_EQ(fitted.states.size(), view.states.size());
  EXPECT_EQ(points(fitted), points(view));
  EXPECT_EQ(fitted.note, "");
}

TEST(View3d, StatesGoBeforePointsAndFirstAndLastStay) {
  View3d view = sample_view(24, 40, 60);
  view.limit_bytes = 400'000;
  const View3d fitted = fitted_view(view);
  EXPECT_LE(view_bytes(fitted), view.limit_bytes);
  EXPECT_LT(fitted.states.size(), 60u);
  EXPECT_GE(fitted.states.size(), 8u);
  EXPECT_EQ(points(fitted), points(view));
  EXPECT_EQ(fitted.states.front().label, view.states.front().label);
  EXPECT_EQ(fitted.states.back().label, view.states.back().label);
  EXPECT_THAT(fitted.note, HasSubstr("of 60 states are shown"));
}

TEST(View3d, AHugeSurfaceIsCoarsenedUntilThePageIsSmall) {
  const View3d view = sample_view(100, 240, 16);  // 24 102 points, 6 MB as it is
  const std::string html = draw_view3d(view);
  EXPECT_LT(html.size(), 2'700'000u);  // data below the limit, and the picture
  EXPECT_THAT(html, HasSubstr("of its 24102 points"));
}

TEST(View3d, ACoarsenedSurfaceKeepsItsSize) {
  const View3d view = sample_view(64, 120, 2);
  const View3d coarse = coarsened_view(view, 1500);
  EXPECT_LE(points(coarse), 1500u);
  EXPECT_GT(points(coarse), 900u);
  const auto volume = [](const View3d& v) {  // divergence theorem over both regions
    double sum = 0.0;
    const std::vector<double>& x = v.reference;
    for (const ViewRegion& region : v.regions) {
      for (const auto& t : region.triangles) {
        const double *a = &x[3 * static_cast<std::size_t>(t[0])], *b = &x[3 * static_cast<std::size_t>(t[1])],
                     *c = &x[3 * static_cast<std::size_t>(t[2])];
        sum += (a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) +
                a[2] * (b[0] * c[1] - b[1] * c[0])) /
               6.0;
      }
    }
    return sum;
  };
  EXPECT_GT(volume(view), 0.0);
  EXPECT_NEAR(volume(coarse) / volume(view), 1.0, 0.05);
}

TEST(View3d, TheSameViewGivesTheSameBytes) {
  EXPECT_EQ(draw_view3d(sample_view()), draw_view3d(sample_view()));
}

// ---------------------------------------------------------------- contradictions

TEST(View3d, ContradictionsAreNamed) {
  const auto message = [](View3d view) {
    try {
      draw_view3d(view);
      return std::string();
    } catch (const std::logic_error& error) {
      return std::string(error.what());
    }
  };
  View3d view = sample_view(8, 6, 2);
  EXPECT_EQ(message({.title = "T"}), "view `T`: it has no state");
  View3d short_field = view;
  short_field.fields[0].values[1].pop_back();
  EXPECT_THAT(message(short_field), HasSubstr("field `fibre stretch [1]` has not one value a point"));
  View3d lost = view;
  lost.states[0].positions[4] = std::numeric_limits<double>::infinity();
  EXPECT_THAT(message(lost), HasSubstr("positions that are not finite"));
  View3d missing = view;
  missing.regions[1].triangles[0][2] = 100000;
  EXPECT_THAT(message(missing), HasSubstr("region `tendon` has a triangle of missing points"));
}

TEST(View3d, ABodyWithoutSurfaceIsSaidSo) {
  View3d view = sample_view(8, 6, 2);
  for (ViewRegion& region : view.regions) region = {.name = region.name};
  EXPECT_THAT(draw_view3d(view), HasSubstr("There is no surface to show."));
}

}  // namespace
}  // namespace brachium::pipelines::report
