#pragma once
/// A small catalogue for tests of the runner, and short ways to write and run definitions over it.

#include <filesystem>
#include <string>
#include <vector>

#include "pipelines/runner.hpp"

namespace brachium::pipelines::tests {

/// fake.source (signals from nothing), fake.scale (signals to signals, by trials in parallel), fake.sum
/// (tables of one or more), fake.fit (a subject), fake.predict (signals and a subject), fake.fail, fake.slow.
Catalogue fake_catalogue();

/// What an observer was told.
class Watcher final : public RunObserver {
 public:
  void stage_begins(const StageRecord& stage, std::size_t, std::size_t) override {
    began.push_back(stage.name);
  }
  void stage_progress(const StageRecord&, double, const std::string&) override {}
  void stage_ends(const StageRecord&, const std::vector<data::Diagnostic>&) override {}
  void message(const std::string& text) override { messages.push_back(text); }
  std::vector<std::string> began, messages;
};

void write_file(const std::filesystem::path& file, const std::string& text);
std::string file_text(const std::filesystem::path& file);

/// Runs `definition` of the folder into folder/run; a new watcher each time.
struct Study {
  explicit Study(std::filesystem::path folder);
  void define(const std::string& text) const { write_file(folder / "study.toml", text); }
  RunResult run(const std::vector<std::string>& settings = {});
  std::string reason(const RunResult& result, const std::string& stage) const {
    return result.find(stage)->reason;
  }

  std::filesystem::path folder;
  RunRequest request;
  Watcher watcher;
};

/// source -> scaled -> total
inline const std::string chain = R"([pipeline]
title = "A chain"

[[stage]]
name = "source"
run = "fake.source"
value = 3.0

[[stage]]
name = "scaled"
run = "fake.scale"
input = { signal = "source" }
factor = 2.0

[[stage]]
name = "total"
run = "fake.sum"
input = { parts = ["scaled"] }
)";

/// The rendered mistakes of what `f` throws; "" if it throws nothing.
template <class F>
std::string mistakes_of(F f) {
  try {
    f();
  } catch (const data::InputError& error) {
    return data::render(error.diagnostics());
  }
  return {};
}

}  // namespace brachium::pipelines::tests
