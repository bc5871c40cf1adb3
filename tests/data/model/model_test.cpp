#include <cmath>
#include <numbers>

#include "data/io/toml.hpp"
#include "data/model/curve.hpp"
#include "data/model/error.hpp"
#include "data/model/parallel.hpp"
#include "data/model/session.hpp"
#include "data/model/units.hpp"
#include "tests/support/paths.hpp"

namespace brachium::data {
namespace {

TEST(Units, RecorderSpellingsConvertToSi) {
  EXPECT_DOUBLE_EQ(convert(1.0, "uV", "V"), 1e-6);
  EXPECT_DOUBLE_EQ(convert(1.0, "\xC2\xB5V", "V"), 1e-6);
  EXPECT_DOUBLE_EQ(convert(180.0, "deg", "rad"), std::numbers::pi);
  EXPECT_DOUBLE_EQ(convert(5.5, "lb", "kg"), 5.5 * 0.45359237);
  EXPECT_DOUBLE_EQ(convert(2.0, "Nm", "N m"), 2.0);
  EXPECT_DOUBLE_EQ(convert(1000.0, "mG", "m/s^2"), 9.80665);
}

TEST(Units, RefusesUnknownAndIncompatible) {
  EXPECT_THROW(parse_unit("furlong"), InputError);
  try {
    convert(1.0, "mV", "N m");
    FAIL();
  } catch (const InputError& e) {
    EXPECT_STREQ(e.what(), "`mV` is a unit of voltage, but a unit of torque is needed");
  }
}

TEST(NearestName, FindsMisspellingsButNotStrangers) {
  const std::vector<std::string> keys{"lowpass_hz", "highpass_hz", "rectify"};
  EXPECT_EQ(nearest_name("low_pas_hz", keys), "lowpass_hz");
  EXPECT_EQ(nearest_name("zzz", keys), std::nullopt);
}

TEST(Render, UnderlinesTheOffendingText) {
  const Diagnostic d{Severity::error, "unknown-key", "`low_pas_hz` is not an option of stage `emg.envelope`",
                     SourceSpan{"pipelines/isometric.toml", 14, 1, 10, "low_pas_hz = 6.0"},
                     "did you mean `lowpass_hz`?"};
  EXPECT_EQ(render(d),
            "error[unknown-key]: `low_pas_hz` is not an option of stage `emg.envelope`\n"
            "  --> pipelines/isometric.toml:14:1\n"
            "   |\n"
            "14 | low_pas_hz = 6.0\n"
            "   | ^^^^^^^^^^ did you mean `lowpass_hz`?\n");
}

TEST(MatchNames, GlobsAndReportsEveryPatternWithoutMatch) {
  const std::vector<std::string> names{"mvc-1", "mvc-2", "iso-1"};
  EXPECT_EQ(match_names(std::vector<std::string>{"mvc-*"}, names, "trial"),
            (std::vector<std::string>{"mvc-1", "mvc-2"}));
  try {
    match_names(std::vector<std::string>{"mcv-*", "iso-?", "dyn-*"}, names, "trial");
    FAIL();
  } catch (const InputError& e) {
    EXPECT_EQ(e.diagnostics().size(), 2u);
  }
}

TEST(ParallelFor, RethrowsTheLowestIndexForAnyNumberOfThreads) {
  for (std::size_t threads : {1u, 2u, 4u}) {
    try {
      parallel_for(100, threads, [](std::size_t i) {
        if (i >= 7) throw std::runtime_error(std::to_string(i));
      });
      FAIL();
    } catch (const std::runtime_error& e) {
      EXPECT_STREQ(e.what(), "7");
    }
  }
}

TEST(PiecewiseCubic, MonotoneStaysBetweenItsPoints) {
  const std::vector<double> x{0, 1, 2, 3, 4}, y{0, 0, 1, 1, 5};
  const auto curve = PiecewiseCubic::monotone(x, y);
  for (double s = 0; s <= 2; s += 0.01) {
    EXPECT_GE(curve(s).value, -1e-15);
    EXPECT_LE(curve(s).value, 1.0 + 1e-15);
    EXPECT_GE(curve(s).slope, -1e-12);
  }
}

TEST(PiecewiseCubic, ForsytheReproducesACubicExactly) {
  const auto f = [](double t) { return 2.0 - t + 0.5 * t * t - 0.25 * t * t * t; };
  std::vector<double> x{-1.0, -0.2, 0.3, 1.1, 2.0}, y;
  for (double t : x) y.push_back(f(t));
  const auto curve = PiecewiseCubic::forsythe(x, y);
  for (double t = -1; t <= 2; t += 0.05) EXPECT_NEAR(curve(t).value, f(t), 1e-13);
}

TEST(PiecewiseCubic, SlopeIsTheDerivativeOfTheValue) {
  const std::vector<double> x{0, 1, 2.5, 3, 4}, y{0, 2, 1, 1.5, 5};
  for (const auto& curve : {PiecewiseCubic::monotone(x, y), PiecewiseCubic::forsythe(x, y)}) {
    for (double s = -0.5; s <= 4.5; s += 0.0713) {
      const double h = 1e-6;
      EXPECT_NEAR((curve(s + h).value - curve(s - h).value) / (2 * h), curve(s).slope, 1e-7);
    }
  }
}

TEST(MemorySession, RoundTripsThroughSourceAndSink) {
  Session s{"s01", {{"body_mass_kg", 75.0}}, {}, {}};
  s.trials.push_back({"iso-1",
                      TrialKind::calibration,
                      {},
                      {},
                      {Signal{{"bic", Quantity::emg, "V", 1000.0, 0.5, 3, "BIC", "", {}}, {1, 2, 3}}}});
  const MemorySession source{s};
  MemorySession copy;
  store(load(source), copy);
  EXPECT_EQ(copy.signal("iso-1", "bic").samples, (std::vector<double>{1, 2, 3}));
  EXPECT_THROW(copy.signal("iso-1", "bicc"), InputError);
}

}  // namespace
}  // namespace brachium::data

namespace brachium::io {
namespace {

TEST(Toml, EveryMistakeOfATableIsReportedWithItsPlace) {
  const TomlNode root = parse_toml("title = 3\nlow_pas_hz = 6.0\n[stage]\nrate_hz = -1\n", "x.toml");
  std::vector<data::Diagnostic> found;
  TomlTable table(root, found);
  table.text("title");
  table.number("lowpass_hz");
  auto stage = table.table("stage");
  ASSERT_TRUE(stage);
  stage->positive("rate_hz");
  stage->finish();
  table.finish();
  ASSERT_EQ(found.size(), 3u);
  EXPECT_EQ(found[0].message, "`title` must be a text, not a whole number");
  EXPECT_EQ(found[1].message, "`rate_hz` must be greater than 0, not -1");
  EXPECT_EQ(found[2].where->line, 2);
  EXPECT_EQ(found[2].where->column, 1);
  EXPECT_EQ(found[2].where->length, 10);
  EXPECT_EQ(found[2].help, "did you mean `lowpass_hz`?");
  EXPECT_THROW(raise_if_errors(found), data::InputError);
}

TEST(Toml, WritesWhatItReads) {
  const std::string text =
      "a = 1\nb = 0.1\nc = \"x\\ny\"\nd = [1.0, 2.5]\n\n[t]\ne = true\n\n[[s]]\nf = 1e-300\n\n[[s]]\ng = { h "
      "= 2 }\n";
  const TomlNode once = parse_toml(text, "a");
  const std::string written = write_toml(once);
  EXPECT_EQ(write_toml(parse_toml(written, "b")), written);
  EXPECT_EQ(parse_toml(written, "b").find("s")->items.at(0).find("f")->number, 1e-300);
}

TEST(Toml, SyntaxErrorsCarryAPlace) {
  try {
    parse_toml("a = 1\nb = = 2\n", "bad.toml");
    FAIL();
  } catch (const data::InputError& e) {
    EXPECT_EQ(e.diagnostics().front().code, "toml-syntax");
    EXPECT_EQ(e.diagnostics().front().where->line, 2);
  }
}

}  // namespace
}  // namespace brachium::io
