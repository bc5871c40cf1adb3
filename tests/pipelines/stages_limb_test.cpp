// The limb stages: motion, and the reference moment, against closed forms and the twin's truth.

#include <gmock/gmock.h>

#include <algorithm>
#include <fstream>
#include <numbers>

#include "data/io/session_description.hpp"
#include "data/limb/bodies.hpp"
#include "stages_support.hpp"

namespace brachium::pipelines::tests {
namespace {

using ::testing::HasSubstr;
constexpr double deg = std::numbers::pi / 180.0;
constexpr double g = 9.80665;

// ---------------------------------------------------------------- kinematics

TEST(KinematicsStage, WithoutAFilterKeepsTheAngleAndFindsItsVelocity) {
  const StageData k = run("limb.kinematics", "lowpass_hz = 0", {{"signals", {&recordings()}}}, {"random-1"});
  EXPECT_EQ(signal(k, "random-1", "elbow_flexion").samples,
            signal(recordings(), "random-1", "joint_angle").samples);
  const std::vector<double> v = signal(k, "random-1", "elbow_flexion_velocity").samples,
                            exact = signal(recordings(), "random-1", "joint_velocity").samples;
  for (std::size_t i = 4; i + 4 < v.size(); ++i)
    ASSERT_NEAR(v[i], exact[i], 1e-5) << i;  // fourth order at 200 Hz
  EXPECT_EQ(k.tables.at("ranges").numbers("highest_rad")[0], [&] {
    const std::vector<double> q = signal(recordings(), "random-1", "joint_angle").samples;
    return *std::max_element(q.begin(), q.end());
  }());
}

TEST(KinematicsStage, AddsTheOffsetAndChangesTheRateAsTold) {
  const StageData k = run("limb.kinematics", "lowpass_hz = 0\nangle_offset_deg = 5\noutput_rate_hz = 100",
                          {{"signals", {&recordings()}}}, {"ramp"});
  const data::Signal q = signal(k, "ramp", "elbow_flexion");
  EXPECT_EQ(q.info.rate_hz, 100.0);
  for (double value : q.samples) ASSERT_NEAR(value, 80.0 * deg, 1e-12);
  EXPECT_EQ(q.info.attributes.at("angle_offset"), "5 deg added");
}

// ---------------------------------------------------------------- inverse dynamics

/// First moment of forearm and hand (and of a load held at 0.318 m), from the scene's own numbers.
double first_moment(const data::Scene& scene, double load_kg) {
  double S = 0.0;
  for (const data::Segment& s : scene.segments) S += s.mass_kg * s.centre_of_mass_m;
  for (const data::Load& l : scene.loads) S += load_kg * l.distance_m;
  return S;
}

data::Scene loaded_elbow() {
  return io::read_scene(brachium::tests::source_dir() / "pipelines/scenes/elbow.toml");
}

data::Signal constant(const std::string& name, data::Quantity quantity, const std::string& unit,
                      double value) {
  data::Signal s;
  s.info.name = name;
  s.info.quantity = quantity;
  s.info.unit = unit;
  s.info.rate_hz = 100.0;
  s.info.count = 400;
  s.samples.assign(400, value);
  return s;
}

/// A forearm at rest at q, the upper arm hanging down; recorded as angle, as points and as a quaternion about y.
StageData at_rest(double q, double load_kg) {
  data::Trial trial;
  trial.name = "rest";
  trial.conditions["load_mass_kg"] = load_kg;
  data::Signal angle = constant("elbow_flexion", data::Quantity::joint_angle, "rad", q);
  angle.info.coordinate = "elbow_flexion";
  trial.signals.push_back(angle);
  const double elbow_at[3] = {0.1, 0.2, 1.0}, u[3] = {std::sin(q), 0.0, -std::cos(q)};  // z up
  const char* axis[3] = {"_x", "_y", "_z"};
  for (int k = 0; k < 3; ++k) {
    trial.signals.push_back(
        constant(std::string("elbow_position") + axis[k], data::Quantity::position, "m", elbow_at[k]));
    const double side = k == 1 ? 0.02 : 0.0;
    trial.signals.push_back(constant(std::string("radial_styloid_position") + axis[k],
                                     data::Quantity::position, "m", elbow_at[k] + 0.25 * u[k] + side));
    trial.signals.push_back(constant(std::string("ulnar_styloid_position") + axis[k],
                                     data::Quantity::position, "m", elbow_at[k] + 0.25 * u[k] - side));
  }
  // The segment's long axis is its -z; a turn by -q about y brings it from straight down to u.
  const double quaternion[4] = {0.0, std::sin(-q / 2.0), 0.0, std::cos(q / 2.0)};
  const char* part[4] = {"_x", "_y", "_z", "_w"};
  for (int k = 0; k < 4; ++k)
    trial.signals.push_back(constant(std::string("forearm_orientation") + part[k],
                                     data::Quantity::orientation, "1", quaternion[k]));
  data::Session session;
  session.trials.push_back(trial);
  return session_data(std::move(session));
}

TEST(InverseDynamicsStage, AtRestIsTheWeightOfForearmHandAndLoadForEveryKindOfMotion) {
  const data::Scene scene = loaded_elbow();
  for (const double q : {20.0 * deg, 90.0 * deg, 130.0 * deg}) {
    const StageData session = at_rest(q, 2.0);
    for (const char* options :
         {"motion = \"angle\"", "motion = \"points\"",
          "motion = \"orientation\"\nlong_axis = [0.0, 0.0, -1.0]", "motion = \"orientation\"", ""}) {
      const StageData m = run("limb.inverse_dynamics", options, {{"signals", {&session}}}, {"*"}, scene);
      const double expected = first_moment(scene, 2.0) * g * std::sin(q);
      for (double value : signal(m, "rest", "elbow_flexion_moment").samples)
        ASSERT_NEAR(value, expected, 1e-9) << options << " at " << q / deg;
      EXPECT_NEAR(m.tables.at("moment").numbers("first_moment_kg_m")[0], first_moment(scene, 2.0), 1e-12);
    }
  }
}

TEST(InverseDynamicsStage, SaysWhatIsAssumedAndHowUncertainItIs) {
  const StageData session = at_rest(90.0 * deg, 2.0);
  const StageData m = run("limb.inverse_dynamics", "", {{"signals", {&session}}}, {"*"}, loaded_elbow());
  ASSERT_EQ(m.diagnostics.size(), 2u);
  EXPECT_EQ(m.diagnostics[0].code, "assumed-mass");
  EXPECT_THAT(m.diagnostics[0].message, HasSubstr("rests on a body mass of 75 kg: assumed"));
  EXPECT_EQ(m.diagnostics[1].code, "assumed-load");
  const double sd = m.tables.at("moment").numbers("rms_sd_N_m")[0];
  EXPECT_GT(sd, 0.0);
  double squares = 0.0;
  for (double part : m.tables.at("uncertainty").numbers("rms_sd_N_m")) squares += part * part;
  EXPECT_NEAR(std::sqrt(squares), sd, 1e-9);  // independent contributions
}

TEST(InverseDynamicsStage, WarnsWhereOrientationAndPointsDisagree) {
  const StageData session = at_rest(60.0 * deg, 2.0);
  const StageData m = run("limb.inverse_dynamics", "motion = \"orientation\"\nlong_axis = [1.0, 0.0, 0.0]",
                          {{"signals", {&session}}}, {"*"}, loaded_elbow());
  ASSERT_FALSE(m.diagnostics.empty());
  EXPECT_EQ(m.diagnostics.back().code, "direction-disagreement");
  EXPECT_EQ(m.diagnostics.back().message,
            "orientation and points of the forearm differ by 90.0 deg rms in trial `rest`");
}

TEST(InverseDynamicsStage, OfTheTwinsMotionIsItsEquationOfMotion) {
  const StageData m =
      run("limb.inverse_dynamics", "lowpass_hz = 20", {{"signals", {&recordings()}}}, {"curl"});
  const std::vector<double> q = signal(recordings(), "curl", "joint_angle").samples,
                            v = signal(recordings(), "curl", "joint_velocity").samples;
  const limb::BodySet bodies = limb::bodies_of(elbow(), "elbow_flexion", {});
  const std::vector<double> moment = signal(m, "curl", "elbow_flexion_moment").samples;
  for (std::size_t i = 200; i + 200 < q.size(); ++i) {
    const double acceleration = (v[i + 1] - v[i - 1]) * 100.0;
    ASSERT_NEAR(moment[i],
                bodies.first_moment_kg_m() * g * std::sin(q[i]) + bodies.inertia_kg_m2() * acceleration, 2e-3)
        << i;
  }
}

// ---------------------------------------------------------------- dynamometer

TEST(DynamometerStage, WithTheLimbsMassesGivesTheTwinsMoment) {
  const StageData m = run("limb.dynamometer", "gravity = \"limb\"\nlowpass_hz = 20",
                          {{"signals", {&recordings()}}}, {"ramp", "random-1", "curl"});
  EXPECT_LT(largest_difference(signal(m, "ramp", "elbow_flexion_moment").samples,
                               signal(recordings(), "ramp", "joint_moment").samples),
            1e-9);
  for (const char* trial : {"random-1", "curl"}) {
    const std::vector<double> a = signal(m, trial, "elbow_flexion_moment").samples,
                              b = signal(recordings(), trial, "joint_moment").samples;
    for (std::size_t i = 200; i + 200 < a.size(); ++i)
      ASSERT_NEAR(a[i], b[i], 2e-3) << trial << " " << i;  // the acceleration is filtered
  }
}

/// The twin with tendons so long that its fibres are never stretched, and without damping: no force in the sweep, with a
/// curve set whose passive force is 0 below rest length.
data::Scene without_passive_force() {
  data::Scene scene = elbow();
  for (data::SceneMuscle& m : scene.muscles) {
    m.parameters.tendon_slack_length_m += 0.4 * m.parameters.optimal_fibre_length_m;
    m.parameters.fibre_damping = 0.0;
  }
  return scene;
}

TEST(DynamometerStage, APassiveSweepGivesTheWeightAndTheTwinsMomentWhereNothingElseIsPassive) {
  const data::Scene scene = without_passive_force();
  const StageData session =
      run("twin.session", protocol + "raw_emg = false\ncurves = \"millard_2012\"\n", {}, {"*"}, scene);
  const StageData m = run("limb.dynamometer", "gravity = \"passive_sweep\"\nlowpass_hz = 20",
                          {{"signals", {&session}}}, {"ramp", "random-1"}, scene);
  const data::Table& table = m.tables.at("gravity");
  EXPECT_EQ(table.texts("trial")[0], "sweep");
  for (double moment : signal(session, "sweep", "joint_moment").samples) ASSERT_NEAR(moment, 0.0, 1e-9);
  // What is left is the inertia of a sweep that is not infinitely slow: a cycle of 12 s over 120 deg, 0.02 N m.
  EXPECT_LT(table.numbers("worst_residual_N_m")[0], 0.02);
  EXPECT_NEAR(table.numbers("sin_N_m")[0], -first_moment(scene, 0.0) * g, 0.05);
  EXPECT_NEAR(table.numbers("cos_N_m")[0], 0.0, 0.05);
  for (const char* trial : {"ramp", "random-1"}) {
    const std::vector<double> a = signal(m, trial, "elbow_flexion_moment").samples,
                              b = signal(session, trial, "joint_moment").samples;
    for (std::size_t i = 200; i + 200 < a.size(); ++i) ASSERT_NEAR(a[i], b[i], 0.05) << trial << " " << i;
  }
}

TEST(DynamometerStage, UndoesSignsAndZerosOfTheMachine) {
  const StageData other = changed(recordings(), [](data::Session& session) {
    for (data::Trial& t : session.trials)
      for (data::Signal& s : t.signals) {
        if (s.info.quantity == data::Quantity::dynamometer_torque)
          for (double& v : s.samples) v = 1.5 - v;
        if (s.info.quantity == data::Quantity::dynamometer_angle)
          for (double& v : s.samples) v = 30.0 * deg - v;
        if (s.info.quantity == data::Quantity::dynamometer_velocity)
          for (double& v : s.samples) v = -v;
      }
  });
  const StageData a = run("limb.dynamometer", "", {{"signals", {&recordings()}}}, {"curl"});
  const StageData b =
      run("limb.dynamometer", "angle_sign = -1\ntorque_sign = -1\nangle_zero_deg = 30\ntorque_zero_N_m = 1.5",
          {{"signals", {&other}}}, {"curl"});
  EXPECT_LT(largest_difference(signal(a, "curl", "elbow_flexion_moment").samples,
                               signal(b, "curl", "elbow_flexion_moment").samples),
            1e-9);
}

/// What an isokinetic machine would write of a trial of the twin: a plain table in its own units, its angle falling with
/// flexion from 30 deg at the straight joint, its torque in ft lbf, positive towards extension, 1.5 N m off, and its axis
/// beside the joint's by e = (along, across), with the pad at l.
std::string machine_table(const StageData& session, const std::string& trial, double along_m, double across_m,
                          double pad_m) {
  constexpr double newton_metre_per_ft_lbf = 1.3558179483314004;
  const std::vector<double> angle = signal(session, trial, "dynamometer_angle").samples,
                            velocity = signal(session, trial, "dynamometer_velocity").samples,
                            torque = signal(session, trial, "dynamometer_torque").samples;
  std::string text = "machine,K12\nTime;Position;Velocity;Torque\ns;deg;deg/s;ft lbf\n";
  for (std::size_t i = 0; i < angle.size(); ++i) {
    double q = angle[i];  // of the machine: q_joint = q - (e . t(q)) / l
    for (int k = 0; k < 50; ++k) q = angle[i] + (-along_m * std::sin(q) + across_m * std::cos(q)) / pad_m;
    const double factor = 1.0 - (along_m * std::cos(q) + across_m * std::sin(q)) / pad_m;
    text += fmt::format("{:.3f};{:.9f};{:.9f};{:.9f}\n", static_cast<double>(i) / 200.0, 30.0 - q / deg,
                        -velocity[i] / (2.0 - factor) / deg,
                        (1.5 - torque[i] / factor) / newton_metre_per_ft_lbf);
  }
  return text;
}

TEST(DynamometerStage, APlainTableWithADeclaredLayoutGivesTheTwinsMoment) {
  const StageData twin =
      run("twin.session",
          "seed = 5\nraw_emg = false\ndynamometer = true\ntrial = [ { name = \"kick\", programme = "
          "\"isokinetic\", "
          "duration_s = 12.0, lower_deg = 20.0, upper_deg = 116.0, effort = 0.8, cycle_s = 4.0 } ]");
  struct Machine {
    double along_m, across_m;
    std::string options;
  };
  for (const Machine& machine :
       {Machine{0.0, 0.0, ""},
        Machine{0.008, -0.012, "axis_along_m = 0.008\naxis_across_m = -0.012\npad_distance_m = 0.28\n"}}) {
    const std::filesystem::path folder = brachium::tests::scratch_dir();
    std::ofstream(folder / "kick.csv")
        << machine_table(twin, "kick", machine.along_m, machine.across_m, 0.28);
    std::ofstream(folder / "s.toml")
        << "[session]\nsubject = \"s\"\n[[trial]]\nname = \"kick\"\nkind = \"test\"\n[[file]]\npath = "
           "\"kick.csv\"\n"
           "delimiter = \";\"\nheader_row = 2\nunits_row = 3\ntime = \"Time\"\n"
           "[[file.signal]]\ncolumn = \"Position\"\nname = \"angle\"\nquantity = \"dynamometer_angle\"\n"
           "coordinate = \"elbow_flexion\"\n"
           "[[file.signal]]\ncolumn = \"Velocity\"\nname = \"velocity\"\nquantity = "
           "\"dynamometer_velocity\"\n"
           "coordinate = \"elbow_flexion\"\n"
           "[[file.signal]]\ncolumn = \"Torque\"\nname = \"torque\"\nquantity = \"dynamometer_torque\"\n"
           "coordinate = \"elbow_flexion\"\n";
    data::MemorySession recorded;
    io::import_session(io::read_session_description(folder / "s.toml"), recorded);
    const StageData session = named(session_data(data::load(recorded)), "recordings");
    const StageData m =
        run("limb.dynamometer",
            "angle_sign = -1\ntorque_sign = -1\nangle_zero_deg = 30\ntorque_zero_N_m = 1.5\n"
            // At 20 Hz the filter rounds the ramps off: 2.3e-3 N m at the edges of the windows.
            "lowpass_hz = 40\nwindows = \"isokinetic\"\nspeed_deg_s = 60\n" +
                machine.options,
            {{"signals", {&session}}});
    const std::vector<double> moment = signal(m, "kick", "elbow_flexion_moment").samples,
                              truth = signal(twin, "kick", "joint_moment").samples,
                              use = signal(m, "kick", "use").samples;
    ASSERT_EQ(moment.size(), truth.size());
    std::size_t used = 0;
    double largest = 0.0;
    for (std::size_t i = 0; i < moment.size(); ++i) {
      if (use[i] < 0.5) continue;  // the machine is getting up to speed
      ++used;
      largest = std::max(largest, std::abs(moment[i] - truth[i]));
    }
    EXPECT_GT(used, moment.size() / 3) << machine.options;
    EXPECT_LT(used, moment.size()) << machine.options;
    EXPECT_LT(largest, 2e-3) << machine.options;
  }
}

TEST(DynamometerStage, MarksHoldsAndSaysWhereThereAreNone) {
  const std::string hold =
      "seed = 1\nraw_emg = false\ndynamometer = true\ntrial = [ { name = \"hold\", programme = "
      "\"isometric_hold\", duration_s = 12.0, lower_deg = 75.0, upper_deg = 75.0, effort = 0.6 } ]";
  const StageData session = run("twin.session", hold + "\ncocontraction = 0\nindependence = 0");
  const StageData m = run("limb.dynamometer", "windows = \"holds\"", {{"signals", {&session}}});
  const double share = m.tables.at("moment").numbers("share_used")[0];
  EXPECT_GT(share, 0.2);
  EXPECT_LT(share, 0.95);
  const StageData none =
      run("limb.dynamometer", "windows = \"isokinetic\"\nspeed_deg_s = 60", {{"signals", {&session}}});
  ASSERT_EQ(none.diagnostics.size(), 1u);
  EXPECT_EQ(none.diagnostics[0].message, "no isokinetic phase was found in trial `hold`: none of it is used");
}

TEST(DynamometerStage, ASweepMustBeThere) {
  const StageData session = run(
      "twin.session", "raw_emg = false\ndynamometer = true\ntrial = [ { name = \"a\", duration_s = 4.0 } ]");
  EXPECT_EQ(error_of([&] {
              run("limb.dynamometer", "gravity = \"passive_sweep\"", {{"signals", {&session}}});
            }),
            "error[missing-trial]: stage `limb.dynamometer` corrects gravity by a passive sweep and needs "
            "one trial of kind `passive`, not 0\n"
            "  help: name it in `sweep_trials`, or choose `gravity = \"limb\"`\n");
}

}  // namespace
}  // namespace brachium::pipelines::tests
