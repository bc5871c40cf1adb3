#pragma once
/// Shared by the tests of data/io: files in a scratch folder, a small session, and errors as text.

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <sstream>
#include <string>

#include "data/model/error.hpp"
#include "data/model/session.hpp"

namespace brachium::tests {

inline std::filesystem::path write_file(const std::filesystem::path& file, const std::string& text) {
  std::filesystem::create_directories(file.parent_path());
  std::ofstream(file, std::ios::binary) << text;
  return file;
}

inline std::string slurp(const std::filesystem::path& file) {
  std::ostringstream text;
  text << std::ifstream(file, std::ios::binary).rdbuf();
  return text.str();
}

/// What the user sees when `action` throws an InputError, with `folder` cut out of paths; "no error"
/// otherwise.
inline std::string error_of(const std::function<void()>& action, const std::filesystem::path& folder = {}) {
  try {
    action();
  } catch (const data::InputError& error) {
    std::string text = data::render(error.diagnostics());
    const std::string prefix = folder.string() + "/";
    for (std::size_t at = text.find(prefix); !folder.empty() && at != std::string::npos;
         at = text.find(prefix, at)) {
      text.erase(at, prefix.size());
    }
    return text;
  }
  return "no error";
}

inline data::Signal make_signal(const std::string& name, data::Quantity quantity, const std::string& unit,
                                double rate_hz, double start_time_s, std::size_t count) {
  data::Signal signal;
  signal.info.name = name;
  signal.info.quantity = quantity;
  signal.info.unit = unit;
  signal.info.rate_hz = rate_hz;
  signal.info.start_time_s = start_time_s;
  signal.info.count = count;
  signal.samples.resize(count);
  for (std::size_t i = 0; i < count; ++i) signal.samples[i] = std::sin(0.37 * static_cast<double>(i)) / 3.0;
  return signal;
}

/// Two trials; the first with two rates and a delayed signal.
inline data::Session small_session() {
  data::Session session;
  session.subject = "S1 \xC3\xA4";
  session.anthropometry = {{"body_mass_kg", 75.0}, {"height_m", 1.0 / 3.0}};
  session.attributes = {{"source", "made up"}, {"note.with.dots", ""}};
  data::Trial mvc{
      "mvc-1", data::TrialKind::mvc, {{"load_mass_kg", 2.5 * 0.45359237}}, {{"operator note", "none"}}, {}};
  mvc.signals.push_back(make_signal("z_last_by_name", data::Quantity::emg, "V", 2000.0, 0.0, 5000));
  mvc.signals.back().info.muscle = "biceps";
  mvc.signals.back().info.attributes = {{"filter", "none"}, {"source_file", "a.csv"}};
  mvc.signals.push_back(make_signal("elbow_flexion", data::Quantity::joint_angle, "rad", 200.0, 0.0123, 480));
  mvc.signals.back().info.coordinate = "elbow_flexion";
  mvc.signals.push_back(make_signal("a_first_by_name", data::Quantity::emg, "V", 2000.0, 0.0, 5000));
  session.trials.push_back(std::move(mvc));
  data::Trial test{"a test", data::TrialKind::test, {}, {}, {}};
  test.signals.push_back(
      make_signal("elbow_flexion", data::Quantity::joint_angle, "rad", 1000.0 / 3.0, -1.5, 7));
  session.trials.push_back(std::move(test));
  return session;
}

inline void expect_equal(const data::SignalInfo& a, const data::SignalInfo& b) {
  EXPECT_EQ(a.name, b.name);
  EXPECT_EQ(a.quantity, b.quantity);
  EXPECT_EQ(a.unit, b.unit);
  EXPECT_EQ(a.rate_hz, b.rate_hz);
  EXPECT_EQ(a.start_time_s, b.start_time_s);
  EXPECT_EQ(a.count, b.count);
  EXPECT_EQ(a.muscle, b.muscle);
  EXPECT_EQ(a.coordinate, b.coordinate);
  EXPECT_EQ(a.attributes, b.attributes);
}

inline void expect_equal(const data::Session& a, const data::Session& b) {
  EXPECT_EQ(a.subject, b.subject);
  EXPECT_EQ(a.anthropometry, b.anthropometry);
  EXPECT_EQ(a.attributes, b.attributes);
  ASSERT_EQ(a.trials.size(), b.trials.size());
  for (std::size_t t = 0; t < a.trials.size(); ++t) {
    EXPECT_EQ(a.trials[t].name, b.trials[t].name);
    EXPECT_EQ(a.trials[t].kind, b.trials[t].kind);
    EXPECT_EQ(a.trials[t].conditions, b.trials[t].conditions);
    EXPECT_EQ(a.trials[t].attributes, b.trials[t].attributes);
    ASSERT_EQ(a.trials[t].signals.size(), b.trials[t].signals.size());
    for (std::size_t s = 0; s < a.trials[t].signals.size(); ++s) {
      expect_equal(a.trials[t].signals[s].info, b.trials[t].signals[s].info);
      EXPECT_EQ(a.trials[t].signals[s].samples, b.trials[t].signals[s].samples);
    }
  }
}

}  // namespace brachium::tests
