#pragma once
/// One small synthetic session and short ways to run single stages on it.

#include <cmath>
#include <functional>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "data/io/scene_file.hpp"
#include "pipelines/run_stage.hpp"
#include "tests/support/paths.hpp"

namespace brachium::pipelines::tests {

using Inputs = std::map<std::string, std::vector<const StageData*>>;

inline const Catalogue& catalogue() {
  static const Catalogue all = built_in_catalogue();
  return all;
}

inline const data::Scene& elbow() {
  static const data::Scene scene =
      io::read_scene(brachium::tests::source_dir() / "pipelines/scenes/elbow_twin.toml");
  return scene;
}

/// One stage with the twin's scene.
inline StageData run(const std::string& stage, const std::string& options, const Inputs& inputs = {},
                     const std::vector<std::string>& trials = {"*"}, const data::Scene& scene = elbow(),
                     std::size_t threads = 1) {
  StageRequest request;
  request.options = options;
  request.inputs = inputs;
  request.scene = &scene;
  request.trials = trials;
  request.threads = threads;
  return run_stage(*catalogue().find(stage), request);
}

/// A maximal contraction, a sweep at rest, a weak and a strong ramp, two random trials and a curl; 20 dB of sensor noise.
inline const std::string protocol =
    "seed = 3\nsnr_db = 20.0\ndynamometer = true\n"
    "trial = [\n"
    "{ name = \"mvc-1\", programme = \"mvc\", kind = \"mvc\", duration_s = 24.0, lower_deg = 90.0, upper_deg "
    "= 90.0, effort = 1.0 },\n"
    "{ name = \"sweep\", programme = \"passive_sweep\", kind = \"passive\", duration_s = 12.0, lower_deg = "
    "10.0, upper_deg = 130.0, effort = 0.0, cycle_s = 12.0 },\n"
    "{ name = \"weak\", programme = \"isometric_ramp\", duration_s = 8.0, lower_deg = 75.0, upper_deg = "
    "75.0, effort = 0.2 },\n"
    "{ name = \"ramp\", programme = \"isometric_ramp\", duration_s = 8.0, lower_deg = 75.0, upper_deg = "
    "75.0, effort = 0.7 },\n"
    "{ name = \"random-1\", programme = \"random\", duration_s = 8.0, lower_deg = 20.0, upper_deg = 120.0, "
    "effort = 0.7 },\n"
    "{ name = \"random-2\", programme = \"random\", duration_s = 8.0, lower_deg = 20.0, upper_deg = 120.0, "
    "effort = 0.7 },\n"
    "{ name = \"curl\", programme = \"curl\", kind = \"test\", duration_s = 8.0, lower_deg = 20.0, upper_deg "
    "= 120.0, effort = 0.5, cycle_s = 4.0 },\n"
    "]\n";

inline StageData named(StageData data, const std::string& name) {
  data.stage = name;
  return data;
}

/// What a recorder keeps of that session: raw EMG, motion, dynamometer, moment.
inline const StageData& recordings() {
  static const StageData data = named(run("twin.session", protocol), "recordings");
  return data;
}

/// What nobody can record: true excitations, activations, forces and moment.
inline const StageData& truth() {
  static const StageData data =
      named(run("twin.session", protocol + "content = \"truth\"\nraw_emg = false\n"), "truth");
  return data;
}

inline data::Session session_of(const StageData& data) {
  return data::load(*data.signals);
}
inline data::Signal signal(const StageData& data, const std::string& trial, const std::string& name) {
  return data.signals->signal(trial, name);
}

/// The recordings with something done to one trial or to all.
inline StageData changed(const StageData& data, const std::function<void(data::Session&)>& change) {
  data::Session session = session_of(data);
  change(session);
  StageData out = session_data(std::move(session));
  out.stage = data.stage;
  return out;
}

/// The scene's own values as a subject.
inline StageData subject_data() {
  StageData data = session_data({});
  data.stage = "subject";
  data::Subject subject;
  for (const data::SceneMuscle& m : elbow().muscles)
    subject.muscles.push_back({m.name, m.group, m.parameters, m.activation});
  subject.model = {{"curves", "degroote_fregly_2016"},
                   {"tendon", "rigid"},
                   {"activation_form", "continuous"},
                   {"nonlinearity", "exponential"}};
  data.subject = subject;
  return data;
}

/// The findings of the InputError that `f` throws, as a terminal shows them; empty where it throws none.
inline std::string error_of(const std::function<void()>& f) {
  try {
    f();
  } catch (const data::InputError& error) {
    return data::render(error.diagnostics());
  }
  return {};
}

inline double largest_difference(const std::vector<double>& a, const std::vector<double>& b) {
  EXPECT_EQ(a.size(), b.size());
  double largest = 0.0;
  for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i)
    largest = std::max(largest, std::abs(a[i] - b[i]));
  return largest;
}

inline double mean(const std::vector<double>& x) {
  double sum = 0.0;
  for (double v : x) sum += v;
  return sum / static_cast<double>(x.size());
}

}  // namespace brachium::pipelines::tests
