#include <gtest/gtest.h>

#include "pipelines/report/findings.hpp"
#include "pipelines/report/html.hpp"

namespace brachium::pipelines::report {
namespace {

using data::Diagnostic;
using data::Severity;
using testing::ElementsAre;
using testing::HasSubstr;

Diagnostic warning(const std::string& code, const std::string& message, const std::string& help = "") {
  return {Severity::warning, code, message, std::nullopt, help};
}

TEST(ReportFindings, OneParameterOverManyFoldsIsOneNameInOneFinding) {
  const std::vector<Diagnostic> many = {
      warning("not-identified",
              "without `a`: `biceps gain` is NOT IDENTIFIED: determined by its prior (0.97)"),
      warning("at-bound", "without `a`: `* shape` is AT LOWER BOUND"),
      warning("not-identified",
              "without `b`: `biceps gain` is NOT IDENTIFIED: determined by its prior (0.99)"),
      warning("at-bound", "without `b`: `* shape` is AT UPPER BOUND"),
      warning("not-identified", "without `b`: `triceps gain` is NOT IDENTIFIED")};
  const std::vector<Paragraph> findings = make_findings("validation", many);
  ASSERT_EQ(findings.size(), 2u);
  EXPECT_EQ(
      findings[0].text,
      "`validation`: 2 parameters are NOT IDENTIFIED in one or more of 2 folds: `biceps gain` (2 folds), "
      "`triceps gain` (`not-identified`)");
  EXPECT_EQ(findings[0].tone, Tone::warning);
  EXPECT_THAT(findings[0].details, ElementsAre("`biceps gain` is NOT IDENTIFIED without `a`, `b`",
                                               "`triceps gain` is NOT IDENTIFIED without `b`"));
  EXPECT_EQ(
      findings[1].text,
      "`validation`: 1 parameter is AT A BOUND in one or more of 2 folds: `* shape` (2 folds) (`at-bound`)");
  EXPECT_THAT(findings[1].details, ElementsAre("`* shape` is AT LOWER BOUND without `a`",
                                               "`* shape` is AT UPPER BOUND without `b`"));
}

TEST(ReportFindings, AFoldOfSeveralTrialsIsNamedWhole) {
  const std::vector<Diagnostic> folds = {warning("at-bound", "without `a`, `b`: `* shape` is AT LOWER BOUND"),
                                         warning("at-bound", "without `c`: `* shape` is AT LOWER BOUND")};
  EXPECT_THAT(make_findings("cv", folds).at(0).details,
              ElementsAre("`* shape` is AT LOWER BOUND without `a`, `b`, `c`"));
}

TEST(ReportFindings, BadChannelsAreCountedByChannelAndEachReasonIsKept) {
  const std::vector<Diagnostic> bad = {
      warning("bad-channel", "channel `biceps` of trial `t1` is bad: SNR 3 dB", "look"),
      warning("bad-channel", "channel `triceps` of trial `t1` is bad: flat", "look"),
      warning("bad-channel", "channel `biceps` of trial `t2` is bad: clipped", "look")};
  const std::vector<Paragraph> findings = make_findings("quality", bad);
  ASSERT_EQ(findings.size(), 1u);
  EXPECT_EQ(findings[0].text,
            "`quality`: 2 channels are bad: `biceps` (2 trials), `triceps` (1 trial); look (`bad-channel`)");
  EXPECT_THAT(findings[0].details, ElementsAre("channel `biceps` of trial `t1` is bad: SNR 3 dB",
                                               "channel `biceps` of trial `t2` is bad: clipped",
                                               "channel `triceps` of trial `t1` is bad: flat"));
}

TEST(ReportFindings, OtherCodesShareTheirHeadAndKeepTheirWords) {
  const std::vector<Diagnostic> same = {warning("not-converged", "without `a`: it did not converge: cost 1"),
                                        warning("not-converged", "without `b`: it did not converge: cost 2")};
  const std::vector<Paragraph> findings = make_findings("cv", same);
  ASSERT_EQ(findings.size(), 1u);
  EXPECT_EQ(findings[0].text, "`cv`: it did not converge, in 2 folds (`not-converged`)");
  EXPECT_THAT(findings[0].details, ElementsAre("without `a`: it did not converge: cost 1",
                                               "without `b`: it did not converge: cost 2"));
}

TEST(ReportFindings, FewOrDifferentOnesStayAsTheyAre) {
  const std::vector<Diagnostic> few = {warning("x", "`a` is odd"),
                                       warning("x", "`b` is odd"),
                                       {Severity::note, "x", "`c` is odd", std::nullopt, ""}};
  const std::vector<Paragraph> findings = make_findings("s", few);
  ASSERT_EQ(findings.size(), 3u);
  EXPECT_EQ(findings[0].text, "`s`: `a` is odd (`x`)");
  EXPECT_EQ(findings[2].tone, Tone::plain);
  for (const Paragraph& f : findings) EXPECT_TRUE(f.details.empty());
}

TEST(ReportFindings, DetailsAreFoldedUnderTheirFinding) {
  Document document;
  document.findings = {{.text = "many", .tone = Tone::warning, .details = {"the `first`", "a < b"}}};
  EXPECT_THAT(
      render_html(document),
      HasSubstr("<details class=\"more\"><summary>one by one</summary><ul><li>the <code>first</code></li>"
                "<li>a &lt; b</li></ul></details>"));
}

}  // namespace
}  // namespace brachium::pipelines::report
