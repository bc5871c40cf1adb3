#include "pipelines/report/text.hpp"

#include <gtest/gtest.h>

namespace brachium::pipelines::report {
namespace {

TEST(ReportText, EscapesEveryCharacterThatMarkupKnows) {
  EXPECT_EQ(escape("a<b> & \"c\" 'd'"), "a&lt;b&gt; &amp; &quot;c&quot; &#39;d&#39;");
}

TEST(ReportText, KeepsUtf8AndReplacesWhatIsNot) {
  EXPECT_EQ(escape("µV ± 3 €"), "µV ± 3 €");
  EXPECT_EQ(escape("caf\xE9!"), "caf\uFFFD!");                        // Latin-1
  EXPECT_EQ(escape("\xC0\xAF"), "\uFFFD\uFFFD");                      // overlong
  EXPECT_EQ(escape("\xED\xA0\x80"), "\uFFFD\uFFFD\uFFFD");            // surrogate
  EXPECT_EQ(escape("\xF5\x80\x80\x80"), "\uFFFD\uFFFD\uFFFD\uFFFD");  // above U+10FFFF
  EXPECT_EQ(escape("cut \xE2\x82"), "cut \uFFFD\uFFFD");
}

TEST(ReportText, ReplacesControlCharactersButNotLineEnds) {
  EXPECT_EQ(escape(std::string_view("a\0b\x1B[1m\n\t", 9)), "a\uFFFDb\uFFFD[1m\n\t");
}

TEST(ReportText, CodeSpansAreEscapedAndNothingElseHappensInThem) {
  EXPECT_EQ(inline_markup("use `<lowpass_hz>` at 6 Hz"), "use <code>&lt;lowpass_hz&gt;</code> at 6\u202FHz");
  EXPECT_EQ(inline_markup("`6 Hz doi:10.1/x`"), "<code>6 Hz doi:10.1/x</code>");
  EXPECT_EQ(inline_markup("a lone ` stays"), "a lone ` stays");
}

TEST(ReportText, DoisBecomeLinksWithTheirBracketsAndWithoutTheSentencesPunctuation) {
  EXPECT_EQ(
      inline_markup("(doi:10.1016/S0021-9290(03)00010-1)."),
      "(<a href=\"https://doi.org/10.1016/S0021-9290(03)00010-1\">doi:10.1016/S0021-9290(03)00010-1</a>).");
  EXPECT_EQ(inline_markup("doi:10.1115/1.1531112, then"),
            "<a href=\"https://doi.org/10.1115/1.1531112\">doi:10.1115/1.1531112</a>, then");
}

TEST(ReportText, ALinkCannotBreakOutOfItsAttribute) {
  EXPECT_EQ(inline_markup("https://a.org/?x=1&y='z"),
            "<a href=\"https://a.org/?x=1&amp;y=&#39;z\">https://a.org/?x=1&amp;y=&#39;z</a>");
  EXPECT_EQ(inline_markup("javascript:alert(1)"), "javascript:alert(1)");
}

TEST(ReportText, NumbersKeepTheirUnitsOnOneLine) {
  EXPECT_EQ(bind_units("RMSE 1.02 N m, 30 % of 2 kHz"), "RMSE 1.02\u202FN\u202Fm, 30\u202F% of 2\u202FkHz");
  EXPECT_EQ(bind_units("turned by 35 deg"), "turned by 35°");
  EXPECT_EQ(bind_units("7 muscles, 6 samples, 2 men"), "7 muscles, 6 samples, 2 men");
}

TEST(ReportText, LabelsCarryTypesetUnits) {
  EXPECT_EQ(typeset_label("moment [N m]"), "moment [N\u202Fm]");
  EXPECT_EQ(typeset_label("acceleration [m/s^2]"), "acceleration [m/s²]");
  EXPECT_EQ(typeset_label("angle [deg]"), "angle [°]");
  EXPECT_EQ(typeset_label("EMG [uV]"), "EMG [µV]");
  EXPECT_EQ(typeset_label("activation [1]"), "activation");
  EXPECT_EQ(typeset_label("[1]"), "");
  EXPECT_EQ(typeset_label("no unit"), "no unit");
  EXPECT_EQ(typeset_unit("s^-1"), "s⁻¹");
}

TEST(ReportText, PlainTextHasNoCodeMarks) {
  EXPECT_EQ(plain_text("stage `a` <b>"), "stage a <b>");
}

TEST(ReportText, AnchorsAreNeverEmpty) {
  EXPECT_EQ(make_anchor("EMG quality (raw)"), "emg-quality-raw");
  EXPECT_EQ(make_anchor("±"), "section");
  EXPECT_EQ(make_anchor(""), "section");
}

}  // namespace
}  // namespace brachium::pipelines::report
