#include "fem/solve/log.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sstream>

namespace brachium::fem {
namespace {

TEST(Log, ColumnsAreFixedWhateverTheRow) {
  StepRecord s;
  s.step = 7;
  s.phase = "activate";
  s.phase_time = 0.35;
  IterationRecord predictor;
  predictor.step = 7;
  predictor.kind = "predictor";
  predictor.step_norm = 1.2e-3;
  IterationRecord newton = predictor;
  newton.kind = "newton";
  newton.iteration = 1;
  newton.relative_residual = 4.1e-9;
  newton.energy_norm = 1e-14;
  newton.worst_cell = 312;
  newton.worst_jacobian = 0.912;
  IterationRecord cut = newton;
  cut.kind = "cut";
  cut.note = "cell 312 inverts";
  s.iterations = {predictor, newton, cut};
  s.newton_iterations = 1;
  s.cut_backs = 1;
  s.stability = {"unstable", 4, "LDL' inertia, at the state"};
  const std::string heading = log_heading(), text = log_text(s);
  std::istringstream lines(text);
  std::string line;
  const std::size_t column = heading.find("worst cell");
  for (int k = 0; k < 3; ++k) {
    std::getline(lines, line);
    EXPECT_EQ(line[column - 1], ' ') << line;
    EXPECT_NE(line[column], ' ') << line;
  }
  EXPECT_EQ(text,
            "    7    -  predictor            -  1.20e-03         -      -         -  -                  \n"
            "    7    1  newton        4.10e-09  1.20e-03  1.00e-14      -         -  312 J 0.912        \n"
            "    7    -  cut           4.10e-09         -         -      -         -  312 J 0.912        "
            "cell 312 inverts\n"
            "    7       `activate` at 0.35: 1 newton, 0 chord, cut 1 times; unstable, 4 negative modes "
            "(LDL' inertia, at the state)\n");
}

TEST(Log, TheClosingLineSaysWhyItStopped) {
  Summary s;
  s.reason = "phase `crush`, step 3 at 0.5 of the phase: diverged";
  EXPECT_THAT(log_text(s), ::testing::AllOf(::testing::HasSubstr("stopped in 0.00 s"),
                                            ::testing::EndsWith(s.reason + "\n")));
}

}  // namespace
}  // namespace brachium::fem
