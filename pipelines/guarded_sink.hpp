#pragma once
/// The runner's hold on a stage that writes: only for runner.cpp.

#include <atomic>
#include <span>
#include <string>

#include "data/model/session.hpp"
#include "pipelines/runner.hpp"

namespace brachium::pipelines {

/// A stage's output on its way to the disk; ends the stage when the run is to stop.
class GuardedSink final : public data::SessionSink {
 public:
  GuardedSink(data::SessionSink& target, const std::atomic<bool>* stop) : target_(target), stop_(stop) {}
  void begin(const data::SessionInfo& session) override {
    begun_ = true;
    target_.begin(session);
  }
  void begin_trial(const data::TrialInfo& trial) override { target_.begin_trial(trial); }
  void begin_signal(const std::string& trial, const data::SignalInfo& info) override {
    check();
    target_.begin_signal(trial, info);
  }
  void write_samples(const std::string& trial, const std::string& signal, std::size_t first,
                     std::span<const double> samples) override {
    check();
    target_.write_samples(trial, signal, first, samples);
  }
  bool begun() const { return begun_; }

 private:
  void check() const {
    if (stop_ && *stop_) throw Interrupted();
  }
  data::SessionSink& target_;
  const std::atomic<bool>* stop_;
  bool begun_ = false;
};

}  // namespace brachium::pipelines
