#include "pipelines/report/text.hpp"

#include <gtest/gtest.h>

namespace brachium::pipelines::report {
namespace {

TEST(ReportText, EscapesMarkup) {
  EXPECT_EQ(escape("a<b> & \"c\" 'd'"), "a&lt;b&gt; &amp; &quot;c&quot; &#39;d&#39;");
}

}  // namespace
}  // namespace brachium::pipelines::report
