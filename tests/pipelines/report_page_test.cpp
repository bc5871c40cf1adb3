#include <gtest/gtest.h>

#include <fstream>

#include "pipelines/report/html.hpp"
#include "tests/pipelines/report_sample.hpp"
#include "tests/support/paths.hpp"

namespace brachium::pipelines::report {
namespace {

TEST(ReportPage, StaysBelowFiveMegabytesForSixTrialsOfSevenMuscles) {
  const std::string page = render_html(tests::sample_report());
  std::ofstream(tests::scratch_dir() / "report.html", std::ios::binary) << page;
  EXPECT_LT(page.size(), 5'000'000u);
}

}  // namespace
}  // namespace brachium::pipelines::report
