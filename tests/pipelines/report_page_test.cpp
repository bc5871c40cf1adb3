#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <fstream>
#include <stdexcept>

#include "pipelines/report/html.hpp"
#include "pipelines/report/style.hpp"
#include "tests/pipelines/report_sample.hpp"
#include "tests/support/paths.hpp"

namespace brachium::pipelines::report {
namespace {

using testing::HasSubstr;
using testing::Not;

const std::string& sample_page() {
  static const std::string page = render_html(tests::sample_report());
  return page;
}

/// Runs the checking script on a page; its exit code, or -1 where there is no Python.
int check(const std::string& page) {
  const std::filesystem::path dir = tests::scratch_dir();
  std::ofstream(dir / "report.html", std::ios::binary) << page;
  if (std::system("python3 -c 'import html.parser' > /dev/null 2>&1") != 0) return -1;
  const std::string script = (tests::source_dir() / "tests/pipelines/report_wellformed.py").string();
  return std::system(("python3 '" + script + "' '" + (dir / "report.html").string() + "'").c_str());
}

TEST(ReportPage, StaysBelowFiveMegabytesForSixTrialsOfSevenMuscles) {
  EXPECT_LT(sample_page().size(), 5'000'000u);
}

TEST(ReportPage, TheSameDocumentGivesTheSameBytes) {
  EXPECT_EQ(render_html(tests::sample_report()), sample_page());
}

TEST(ReportPage, IsWellFormedFetchesNothingAndNamesEveryPicture) {
  const int code = check(sample_page());
  if (code == -1) GTEST_SKIP() << "needs python3";
  EXPECT_EQ(code, 0);
}

TEST(ReportPage, TheCheckItselfFindsABrokenPage) {
  std::string page = sample_page();
  page.replace(page.find("<section>"), 9, "<section><b>");
  const int code = check(page);
  if (code == -1) GTEST_SKIP() << "needs python3";
  EXPECT_NE(code, 0);
}

TEST(ReportPage, AnEmptyDocumentIsStillAPage) {
  const std::string page = render_html({});
  EXPECT_THAT(page, HasSubstr("No errors and no warnings."));
  EXPECT_THAT(page, Not(HasSubstr("id=\"chain\"")));
}

TEST(ReportPage, PartsStandInTheOrderAReaderNeedsThem) {
  const std::string& page = sample_page();
  std::size_t last = 0;
  for (const char* part :
       {"<h1>", "class=\"verdict warning\"", "id=\"findings\"", "id=\"chain\"", "id=\"contents\"",
        "id=\"emg-quality\"", "id=\"calibration\"", "id=\"methods\"", "id=\"provenance\""}) {
    const std::size_t at = page.find(part);
    ASSERT_NE(at, std::string::npos) << part;
    EXPECT_GT(at, last) << part;
    last = at;
  }
}

TEST(ReportPage, ErrorsComeBeforeWarningsBeforeNotes) {
  Document document;
  document.findings = {{.text = "a note"},
                       {.text = "a warning", .tone = Tone::warning},
                       {.text = "an error", .tone = Tone::bad}};
  const std::string page = render_html(document);
  EXPECT_LT(page.find("an error"), page.find("a warning"));
  EXPECT_LT(page.find("a warning"), page.find("a note"));
  EXPECT_THAT(page, Not(HasSubstr("No errors")));
}

TEST(ReportPage, ManyNotesAreFoldedAway) {
  Document document;
  for (int k = 0; k < 40; ++k)
    document.findings.push_back({.text = std::string("note ").append(std::to_string(k))});
  EXPECT_THAT(render_html(document), HasSubstr("<summary>40 notes</summary>"));
}

TEST(ReportPage, SectionsOfOneTitleGetAnchorsOfTheirOwn) {
  Document document;
  document.sections = {{.title = "Trial"}, {.title = "Trial"}, {.title = "Methods"}};
  const std::string page = render_html(document);
  EXPECT_THAT(page, HasSubstr("<h2 id=\"trial\">"));
  EXPECT_THAT(page, HasSubstr("<h2 id=\"trial-2\">"));
  EXPECT_THAT(page, HasSubstr("<h2 id=\"methods-2\">")) << "methods is the page's own";
}

TEST(ReportPage, TablesAlignNumbersRightAndSetTonesAsClasses) {
  Document document;
  document.sections = {{.title = "T",
                        .blocks = {Grid{.caption = "C",
                                        .header = {"muscle", "force [N]", "verdict"},
                                        .rows = {{{.text = "BRA"},
                                                  {.text = "12.5", .numeric = true},
                                                  {.text = "AT UPPER BOUND", .tone = Tone::warning}},
                                                 {{.text = "TRI"}}}}}}};
  const std::string page = render_html(document);
  EXPECT_THAT(page, HasSubstr("<th scope=\"col\">muscle</th><th scope=\"col\" class=\"n\">force [N]</th>"));
  EXPECT_THAT(
      page,
      HasSubstr(
          "<th scope=\"row\">BRA</th><td class=\"n\">12.5</td><td class=\"warning\">AT UPPER BOUND</td>"));
  EXPECT_THAT(page, HasSubstr("<th scope=\"row\">TRI</th><td></td><td></td>"));
}

TEST(ReportPage, ARowLongerThanItsHeaderIsRefused) {
  Document document;
  document.sections = {{.title = "T", .blocks = {Grid{.caption = "C", .header = {"a"}, .rows = {{{}, {}}}}}}};
  try {
    render_html(document);
    FAIL();
  } catch (const std::logic_error& error) {
    EXPECT_STREQ(error.what(), "table `C`: a row has more cells than the header");
  }
}

// ---------------------------------------------------------------- colours

/// Relative luminance of "#rgb" or "#rrggbb" (WCAG 2.2).
double luminance(const std::string& colour) {
  double sum = 0.0;
  const double weights[] = {0.2126, 0.7152, 0.0722};
  for (std::size_t k = 0; k < 3; ++k) {
    const std::string digits =
        colour.size() == 4 ? std::string(2, colour[1 + k]) : colour.substr(1 + 2 * k, 2);
    const double v = std::stoi(digits, nullptr, 16) / 255.0;
    sum += weights[k] * (v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4));
  }
  return sum;
}

double contrast(const std::string& a, const std::string& b) {
  const double la = luminance(a);
  const double lb = luminance(b);
  return (std::max(la, lb) + 0.05) / (std::min(la, lb) + 0.05);
}

/// Value of a custom property in the light (0) or dark (1) theme.
std::string colour(const std::string& name, int theme) {
  const std::string css(style_sheet());
  std::size_t at = css.find("--" + name + ":#");
  if (theme == 1) at = css.find("--" + name + ":#", at + 1);
  at += name.size() + 3;
  return css.substr(at, css.find_first_of(";}", at) - at);
}

TEST(ReportStyle, TheContrastFormulaKnowsBlackAndWhite) {
  EXPECT_NEAR(contrast("#000", "#ffffff"), 21.0, 1e-12);
  EXPECT_NEAR(contrast("#777777", "#fff"), 4.48, 0.005);
}

TEST(ReportStyle, CurvesStandOutFromTheirGroundInBothThemes) {
  for (const int theme : {0, 1}) {
    for (int k = 0; k < 8; ++k) {
      const std::string name = std::string("c").append(std::to_string(k));
      EXPECT_GE(contrast(colour(name, theme), colour("ground", theme)), 3.0) << name << " in theme " << theme;
    }
  }
}

TEST(ReportStyle, TextIsReadableInBothThemes) {
  for (const int theme : {0, 1}) {
    for (const char* ground : {"ground", "raised"}) {
      for (const char* ink : {"ink", "soft", "link"}) {
        EXPECT_GE(contrast(colour(ink, theme), colour(ground, theme)), 4.5)
            << ink << " on " << ground << ", theme " << theme;
      }
    }
    for (const std::string tone : {"good", "warning", "bad"}) {
      EXPECT_GE(contrast(colour(tone, theme), colour(tone + "-bg", theme)), 4.5)
          << tone << ", theme " << theme;
      EXPECT_GE(contrast(colour(tone, theme), colour("ground", theme)), 4.5) << tone << ", theme " << theme;
      EXPECT_GE(contrast(colour("ink", theme), colour(tone + "-bg", theme)), 4.5)
          << tone << ", theme " << theme;
    }
  }
}

}  // namespace
}  // namespace brachium::pipelines::report
