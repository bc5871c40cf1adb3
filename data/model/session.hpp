#pragma once
/// A session: one subject's recordings, trial by trial. Also the shape in which stages hand time series on.
///
/// A Session is a plain value with all samples in memory. Stages, however, read through SessionSource and write
/// through SessionSink, one signal or chunk at a time, so that memory does not grow with a recording's length.

#include <cstddef>
#include <map>
#include <mutex>
#include <span>
#include <string>
#include <vector>

#include "data/model/signal.hpp"

namespace brachium::data {

/// What a trial was recorded for.
enum class TrialKind { mvc, calibration, test, passive, rest };
std::string to_string(TrialKind kind);
TrialKind parse_trial_kind(const std::string& name);  ///< throws InputError("unknown-trial-kind")

/// Everything about a trial but its samples.
struct TrialInfo {
  std::string name;  ///< unique in its session
  TrialKind kind = TrialKind::test;
  std::map<std::string, double> conditions;  ///< numbers known of the trial, unit in the name: "load_mass_kg"
  std::map<std::string, std::string> attributes;  ///< texts known of the trial
  std::vector<SignalInfo> signals;

  /// Index of the signal of that name; throws InputError("missing-signal") naming trial and nearest signal.
  std::size_t signal_index(const std::string& signal) const;
  bool has_signal(const std::string& signal) const;
};

struct SessionInfo {
  std::string subject;
  std::map<std::string, double> anthropometry;    ///< unit in the name: "body_mass_kg", "height_m"
  std::map<std::string, std::string> attributes;  ///< source, licence, citation, ...
  std::vector<TrialInfo> trials;

  std::size_t trial_index(const std::string& trial) const;  ///< throws InputError("missing-trial")
};

struct Trial {
  std::string name;
  TrialKind kind = TrialKind::test;
  std::map<std::string, double> conditions;
  std::map<std::string, std::string> attributes;
  std::vector<Signal> signals;

  const Signal& signal(const std::string& signal) const;  ///< throws InputError("missing-signal")
};

struct Session {
  std::string subject;
  std::map<std::string, double> anthropometry;
  std::map<std::string, std::string> attributes;
  std::vector<Trial> trials;

  const Trial& trial(const std::string& name) const;  ///< throws InputError("missing-trial")
};

/// Where signals are read from. Implementations are safe to call from several threads.
class SessionSource {
 public:
  virtual ~SessionSource() = default;
  virtual const SessionInfo& info() const = 0;
  /// Samples [first, first + out.size()) of a signal.
  virtual void read(std::size_t trial, std::size_t signal, std::size_t first,
                    std::span<double> out) const = 0;

  std::vector<double> read(std::size_t trial, std::size_t signal) const;
  Signal signal(std::size_t trial, std::size_t signal) const;
  Signal signal(const std::string& trial, const std::string& signal) const;
};

/// Where signals are written to. Trials appear in the order of begin_trial; safe to call from several threads
/// once a trial has been begun.
class SessionSink {
 public:
  virtual ~SessionSink() = default;
  virtual void begin(const SessionInfo& session) = 0;  ///< subject, anthropometry, attributes; trials ignored
  virtual void begin_trial(const TrialInfo& trial) = 0;  ///< all but signals
  /// Announces a signal of info.count samples; samples follow by write_samples in any order of chunks.
  virtual void begin_signal(const std::string& trial, const SignalInfo& info) = 0;
  virtual void write_samples(const std::string& trial, const std::string& signal, std::size_t first,
                             std::span<const double> samples) = 0;

  void write(const std::string& trial, const Signal& signal);
};

/// A Session behind the streaming interfaces: for tests, small studies, and stages' intermediate results.
/// Writing locks; reading while another thread still writes the same session is not meant to be.
class MemorySession final : public SessionSource, public SessionSink {
 public:
  MemorySession() = default;
  explicit MemorySession(Session session);

  const SessionInfo& info() const override { return info_; }
  using SessionSource::read;
  void read(std::size_t trial, std::size_t signal, std::size_t first, std::span<double> out) const override;

  void begin(const SessionInfo& session) override;
  void begin_trial(const TrialInfo& trial) override;
  void begin_signal(const std::string& trial, const SignalInfo& info) override;
  void write_samples(const std::string& trial, const std::string& signal, std::size_t first,
                     std::span<const double> samples) override;

  const Session& session() const { return session_; }

 private:
  mutable std::mutex mutex_;
  Session session_;
  SessionInfo info_;
};

/// The info part of a session in memory.
SessionInfo info_of(const Session& session);
/// A whole session read into memory (for sessions known to be small).
Session load(const SessionSource& source);
/// A whole session written to a sink.
void store(const Session& session, SessionSink& sink);

/// Names that match any of the shell patterns (`*`, `?`); every pattern must match at least one name,
/// else InputError("no-match"). The order is that of `names`.
std::vector<std::string> match_names(std::span<const std::string> patterns,
                                     std::span<const std::string> names, const std::string& what);
/// Does `name` match the shell pattern (`*` any run, `?` one character)?
bool matches(const std::string& pattern, const std::string& name);

}  // namespace brachium::data
