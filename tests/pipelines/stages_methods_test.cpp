// The methods text tells of the options that were used, not of the defaults.

#include <gmock/gmock.h>

#include "pipelines/options.hpp"
#include "stages_support.hpp"

namespace brachium::pipelines::tests {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

std::string methods_of(const std::string& stage, const std::string& text,
                       const std::map<std::string, std::vector<const StageData*>>& inputs = {}) {
  const StageSpec& spec = *catalogue().find(stage);
  const Options options = options_from_text(text, spec);
  const StageData output = session_data({});
  ReportContext context;
  context.name = stage;
  context.options = &options;
  context.output = &output;
  context.inputs = inputs;
  context.scene = &elbow();
  return spec.methods(context);
}

TEST(Methods, OfConditioningFollowItsFilters) {
  EXPECT_THAT(methods_of("emg.envelope", "highpass_hz = 20.0\nlowpass_hz = 4.0\nnormalise = \"none\"\n"),
              AllOf(HasSubstr("high-pass filtered at 20 Hz"), HasSubstr("low-pass filtered at 4 Hz"),
                    HasSubstr("not normalised")));
  EXPECT_THAT(methods_of("emg.envelope", "phase = \"causal\"\n"),
              AllOf(Not(HasSubstr("without lag")), HasSubstr("maximum voluntary contractions")));
  EXPECT_THAT(methods_of("emg.envelope", "notch_hz = 50.0\n"), HasSubstr("notched at 50 Hz and harmonics"));
}

TEST(Methods, OfACalibrationFollowItsSolverAndItsNoise) {
  const std::string free = "free = [{ parameter = \"strength\", scope = \"group\" }]\n";
  EXPECT_THAT(methods_of("optimise.calibrate", free),
              AllOf(HasSubstr("levenberg marquardt"), HasSubstr("strength (group)"),
                    HasSubstr("Nakamura 1990"), HasSubstr("taken off the fitted values")));
  EXPECT_THAT(methods_of("optimise.calibrate", free + "solver = \"slsqp\"\ncorrect_bias = false\n"),
              AllOf(HasSubstr("slsqp"), HasSubstr("reported, not taken off")));
  EXPECT_THAT(methods_of("optimise.calibrate", free + "excitation_cv = 0.0\n"),
              AllOf(Not(HasSubstr("Nakamura")), HasSubstr("noise in the excitation was not allowed for")));
}

TEST(Methods, OfMuscleForcesCiteTheCurvesThatWereUsed) {
  EXPECT_THAT(methods_of("hill.moment", "curves = \"millard_2012\"\ntendon = \"elastic\"\n"),
              AllOf(HasSubstr("elastic tendon"), HasSubstr("doi:10.1115/1.4023390")));
  const StageData subject = subject_data();  // its own choices go before the options
  EXPECT_THAT(methods_of("hill.moment", "curves = \"millard_2012\"\n", {{"subject", {&subject}}}),
              AllOf(HasSubstr("rigid tendon"), HasSubstr("doi:10.1007/s10439-016-1591-9")));
}

TEST(Methods, OfActivationsTellTheirForm) {
  EXPECT_THAT(methods_of("emg.activation", "activation_form = \"first_order\"\n"),
              HasSubstr("Thelen 2003, doi:10.1115/1.1531112"));
  EXPECT_THAT(methods_of("emg.activation", "activation_form = \"recursive\"\nnonlinearity = \"none\"\n"),
              AllOf(HasSubstr("recursive"), Not(HasSubstr("nonlinearity"))));
}

}  // namespace
}  // namespace brachium::pipelines::tests
