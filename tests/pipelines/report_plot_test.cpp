#include "pipelines/report/plot.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <stdexcept>

#include "pipelines/report/shapes.hpp"

namespace brachium::pipelines::report {
namespace {

using testing::HasSubstr;
using testing::Not;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInf = std::numeric_limits<double>::infinity();

const Panel kPanel{.x = {.lower = 0.0, .upper = 10.0},
                   .y = {.lower = 0.0, .upper = 10.0},
                   .width_px = 100,
                   .height_px = 100};

TEST(ReportPlot, ALineGoesThroughItsPoints) {
  const Series series{.label = "", .x = {0, 5, 10}, .y = {0, 10, 5}};
  EXPECT_EQ(draw_series(series, 0, kPanel, 0, 1), "<path class=\"l c0\" d=\"M0 100l50-100 50 50\"/>");
}

TEST(ReportPlot, NanBreaksALineAndALoneSampleIsStillSeen) {
  const Series series{.label = "", .x = {0, 1, 2, 3, 4, 5, 6}, .y = {1, 1, kNan, 2, kNan, 1, 1}};
  EXPECT_EQ(draw_series(series, 1, kPanel, 0, 1),
            "<path class=\"l c1\" d=\"M0 90l10 0M29 80l2 0M50 90l10 0\"/>");
}

TEST(ReportPlot, AStepHoldsItsValueUntilTheNext) {
  const Series series{.label = "", .x = {0, 5, 10}, .y = {0, 10, 5}, .style = Style::step};
  EXPECT_EQ(draw_series(series, 0, kPanel, 0, 1), "<path class=\"l c0\" d=\"M0 100l50 0 0-100 50 0 0 50\"/>");
}

TEST(ReportPlot, ABandRunsThereAboveAndBackBelow) {
  const Series series{
      .label = "", .x = {0, 10}, .y = {8, 9}, .style = Style::area, .colour = -1, .y_lower = {2, 1}};
  EXPECT_EQ(draw_series(series, 6, kPanel, 0, 1),
            "<path class=\"b c6\" d=\"M0 80l0-60 100-10 0 80-100-10z\"/>");
}

TEST(ReportPlot, BarsOfSeveralSeriesStandBesideEachOther) {
  const Series series{.label = "", .x = {2.5, 7.5}, .y = {10, 5}, .style = Style::bars};
  EXPECT_EQ(draw_series(series, 0, kPanel, 0, 2),
            "<path class=\"a c0\" d=\"M5 100l0-100 20 0 0 100zM55 100l0-50 20 0 0 50z\"/>");
  EXPECT_EQ(draw_series(series, 1, kPanel, 1, 2),
            "<path class=\"a c1\" d=\"M25 100l0-100 20 0 0 100zM75 100l0-50 20 0 0 50z\"/>");
}

TEST(ReportPlot, PointsAreRoundDotsThatDoNotStretchWithThePage) {
  const Series series{.label = "", .x = {0, 5, kNan}, .y = {0, 10, 1}, .style = Style::points};
  EXPECT_EQ(draw_series(series, 0, kPanel, 0, 1), "<path class=\"p c0\" d=\"M0 100h0M50 0h0\"/>");
}

TEST(ReportPlot, EmptyPlotsSayThatThereIsNoData) {
  for (const Plot& plot :
       {Plot{.title = "a"}, Plot{.title = "b", .series = {{.label = "x", .x = {}, .y = {}}}},
        Plot{.title = "c", .series = {{.label = "x", .x = {1, 2}, .y = {kNan, kNan}}}}}) {
    const std::string picture = draw_plot(plot, {});
    EXPECT_THAT(picture, HasSubstr(">no data</text>"));
    EXPECT_THAT(picture, Not(HasSubstr("nan")));
  }
}

TEST(ReportPlot, ValuesThatCannotBeDrawnAreCountedInANote) {
  Plot plot{
      .title = "cost", .series = {{.label = "", .x = {1, 2, 3, 4}, .y = {1, 0, -2, kInf}}}, .log_y = true};
  EXPECT_THAT(draw_plot(plot, {}),
              HasSubstr("3 values are not drawn: infinite, or not positive on a logarithmic axis."));
  plot.log_y = false;
  EXPECT_THAT(draw_plot(plot, {}), HasSubstr("1 value is not drawn: infinite."));
}

TEST(ReportPlot, NoNumberInThePictureIsNanOrInfinite) {
  Plot plot{.title = "odd",
            .series = {{.label = "a", .x = {kNan, 1, kInf, 1e308}, .y = {1, -1e308, 2, 1e308}},
                       {.label = "b", .x = {0, 1}, .y = {5e-324, 1e-320}},
                       {.label = "c", .x = {1, 1}, .y = {3, 3}, .style = Style::bars}},
            .markers = {{.from = kNan, .label = "m"}, {.from = -kInf, .to = kInf, .label = "n"}},
            .levels = {{.y = kNan, .label = "l"}}};
  for (const bool log : {false, true}) {
    plot.log_x = plot.log_y = log;
    std::string picture = draw_plot(plot, {});
    picture = picture.substr(0, picture.find("<p class=\"note\""));
    EXPECT_THAT(picture, Not(HasSubstr("nan")));
    EXPECT_THAT(picture, Not(HasSubstr("inf")));
  }
}

TEST(ReportPlot, EqualAxesShareOneRangeAndShowIdentity) {
  const Plot plot{.title = "agreement",
                  .series = {{.label = "", .x = {0, 10}, .y = {-5, 5}, .style = Style::points}},
                  .equal_axes = true};
  const std::string picture = draw_plot(plot, {});
  const std::size_t x = picture.find("data-x=\"");
  const std::size_t y = picture.find("data-y=\"");
  const auto value = [&](std::size_t at) {
    return picture.substr(at + 8, picture.find('"', at + 8) - at - 8);
  };
  EXPECT_EQ(value(x), value(y));
  EXPECT_THAT(picture, HasSubstr("identity"));
}

TEST(ReportPlot, RepeatedMarkersGoToTheLegendOthersStandAboveThePlot) {
  Plot plot{.title = "t", .series = {{.label = "", .x = {0, 10}, .y = {0, 1}}}};
  plot.markers = {{.from = 2.0, .label = "onset"},
                  {.from = 6.0, .label = "onset"},
                  {.from = 3.0, .to = 4.0, .label = "held out"}};
  const std::string picture = draw_plot(plot, {});
  EXPECT_THAT(picture, HasSubstr("onset</li>"));
  EXPECT_THAT(picture, Not(HasSubstr("onset</text>")));
  EXPECT_THAT(picture, HasSubstr("held out</text>"));
}

TEST(ReportPlot, ContradictionsAreRefusedByName) {
  const auto message = [](const Plot& plot) -> std::string {
    try {
      draw_plot(plot, {});
    } catch (const std::logic_error& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(message({.title = "a", .series = {{.label = "s", .x = {1, 2}, .y = {1}}}}),
            "plot `a`: series `s` has x and y of different length");
  EXPECT_EQ(
      message(
          {.title = "a",
           .series =
               {{.label = "s", .x = {1}, .y = {1}, .style = Style::area, .colour = 0, .y_lower = {1, 2}}}}),
      "plot `a`: series `s` has y and y_lower of different length");
  EXPECT_EQ(message({.title = "a", .below = {Plot{.below = {Plot{}}}}}),
            "plot `a`: a panel below has panels below it");
}

TEST(ReportPlot, TextsAreEscapedWhereverTheyStand) {
  Plot plot{.title = "<T>",
            .x_label = "<X> [s]",
            .y_label = "<Y> [N]",
            .series = {{.label = "<S>", .x = {0, 1}, .y = {0, 1}}}};
  plot.markers = {{.from = 0.5, .label = "<M>"}};
  plot.levels = {{.y = 0.5, .label = "<L>"}};
  plot.categories = {"<C>", "d"};
  plot.note = "<N>";
  const std::string picture = draw_plot(plot, {});
  for (const char* raw : {"<T>", "<X>", "<Y>", "<S>", "<M>", "<L>", "<C>", "<N>"})
    EXPECT_THAT(picture, Not(HasSubstr(raw)));
  for (const char* set : {"&lt;T&gt;", "&lt;X&gt;", "&lt;Y&gt;", "&lt;S&gt;", "&lt;M&gt;", "&lt;L&gt;",
                          "&lt;C&gt;", "&lt;N&gt;"}) {
    EXPECT_THAT(picture, HasSubstr(set));
  }
}

}  // namespace
}  // namespace brachium::pipelines::report
