#include "data/model/session.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "data/model/error.hpp"

namespace brachium::data {
namespace {

constexpr std::array<std::pair<TrialKind, const char*>, 5> kinds{{{TrialKind::mvc, "mvc"},
                                                                  {TrialKind::calibration, "calibration"},
                                                                  {TrialKind::test, "test"},
                                                                  {TrialKind::passive, "passive"},
                                                                  {TrialKind::rest, "rest"}}};

template <class Items, class NameOf>
std::size_t index_of(const Items& items, const std::string& wanted, NameOf name_of, const std::string& code,
                     const std::string& what) {
  std::vector<std::string> known;
  for (std::size_t i = 0; i < items.size(); ++i) {
    if (name_of(items[i]) == wanted) return i;
    known.push_back(name_of(items[i]));
  }
  throw InputError(code, fmt::format("{} `{}`", what, wanted), suggest(wanted, known));
}

std::size_t signal_at(const auto& signals, const std::string& trial, const std::string& wanted,
                      auto name_of) {
  return index_of(signals, wanted, name_of, "missing-signal", fmt::format("trial `{}` has no signal", trial));
}

}  // namespace

std::string to_string(TrialKind kind) {
  for (const auto& [k, name] : kinds) {
    if (k == kind) return name;
  }
  return "test";
}

TrialKind parse_trial_kind(const std::string& name) {
  std::vector<std::string> known;
  for (const auto& [k, n] : kinds) {
    if (name == n) return k;
    known.emplace_back(n);
  }
  throw InputError("unknown-trial-kind", fmt::format("`{}` is not a kind of trial", name),
                   suggest(name, known));
}

std::size_t TrialInfo::signal_index(const std::string& signal) const {
  return signal_at(signals, name, signal, [](const SignalInfo& s) { return s.name; });
}

bool TrialInfo::has_signal(const std::string& signal) const {
  return std::any_of(signals.begin(), signals.end(), [&](const SignalInfo& s) { return s.name == signal; });
}

std::size_t SessionInfo::trial_index(const std::string& trial) const {
  return index_of(
      trials, trial, [](const TrialInfo& t) { return t.name; }, "missing-trial", "the session has no trial");
}

const Signal& Trial::signal(const std::string& signal) const {
  return signals[signal_at(signals, name, signal, [](const Signal& s) { return s.info.name; })];
}

const Trial& Session::trial(const std::string& wanted) const {
  return trials[index_of(
      trials, wanted, [](const Trial& t) { return t.name; }, "missing-trial", "the session has no trial")];
}

std::vector<double> SessionSource::read(std::size_t trial, std::size_t signal) const {
  std::vector<double> samples(info().trials.at(trial).signals.at(signal).count);
  read(trial, signal, 0, samples);
  return samples;
}

Signal SessionSource::signal(std::size_t trial, std::size_t signal) const {
  return {info().trials.at(trial).signals.at(signal), read(trial, signal)};
}

Signal SessionSource::signal(const std::string& trial, const std::string& signal) const {
  const std::size_t t = info().trial_index(trial);
  return this->signal(t, info().trials[t].signal_index(signal));
}

void SessionSink::write(const std::string& trial, const Signal& signal) {
  SignalInfo info = signal.info;
  info.count = signal.samples.size();
  begin_signal(trial, info);
  write_samples(trial, info.name, 0, signal.samples);
}

MemorySession::MemorySession(Session session) : session_(std::move(session)), info_(info_of(session_)) {}

void MemorySession::read(std::size_t trial, std::size_t signal, std::size_t first,
                         std::span<double> out) const {
  const std::vector<double>& samples = session_.trials.at(trial).signals.at(signal).samples;
  if (first > samples.size() || out.size() > samples.size() - first) {
    throw std::out_of_range("MemorySession::read past the end of a signal");
  }
  std::copy_n(samples.begin() + static_cast<std::ptrdiff_t>(first), out.size(), out.begin());
}

void MemorySession::begin(const SessionInfo& session) {
  const std::lock_guard lock(mutex_);
  session_.subject = session.subject;
  session_.anthropometry = session.anthropometry;
  session_.attributes = session.attributes;
  info_ = info_of(session_);
}

void MemorySession::begin_trial(const TrialInfo& trial) {
  const std::lock_guard lock(mutex_);
  session_.trials.push_back({trial.name, trial.kind, trial.conditions, trial.attributes, {}});
  info_ = info_of(session_);
}

void MemorySession::begin_signal(const std::string& trial, const SignalInfo& info) {
  const std::lock_guard lock(mutex_);
  const std::size_t t = info_.trial_index(trial);
  session_.trials[t].signals.push_back({info, std::vector<double>(info.count)});
  info_.trials[t].signals.push_back(info);
}

void MemorySession::write_samples(const std::string& trial, const std::string& signal, std::size_t first,
                                  std::span<const double> samples) {
  const std::lock_guard lock(mutex_);
  const std::size_t t = info_.trial_index(trial);
  std::vector<double>& all = session_.trials[t].signals[info_.trials[t].signal_index(signal)].samples;
  if (first > all.size() || samples.size() > all.size() - first) {
    throw std::out_of_range("MemorySession::write_samples past the end of a signal");
  }
  std::copy(samples.begin(), samples.end(), all.begin() + static_cast<std::ptrdiff_t>(first));
}

SessionInfo info_of(const Session& session) {
  SessionInfo info{session.subject, session.anthropometry, session.attributes, {}};
  for (const Trial& t : session.trials) {
    TrialInfo trial{t.name, t.kind, t.conditions, t.attributes, {}};
    for (const Signal& s : t.signals) {
      trial.signals.push_back(s.info);
      trial.signals.back().count = s.samples.size();
    }
    info.trials.push_back(std::move(trial));
  }
  return info;
}

Session load(const SessionSource& source) {
  const SessionInfo& info = source.info();
  Session session{info.subject, info.anthropometry, info.attributes, {}};
  for (std::size_t t = 0; t < info.trials.size(); ++t) {
    const TrialInfo& trial = info.trials[t];
    session.trials.push_back({trial.name, trial.kind, trial.conditions, trial.attributes, {}});
    for (std::size_t s = 0; s < trial.signals.size(); ++s)
      session.trials.back().signals.push_back(source.signal(t, s));
  }
  return session;
}

void store(const Session& session, SessionSink& sink) {
  const SessionInfo info = info_of(session);
  sink.begin(info);
  for (std::size_t t = 0; t < session.trials.size(); ++t) {
    sink.begin_trial(info.trials[t]);
    for (const Signal& s : session.trials[t].signals) sink.write(session.trials[t].name, s);
  }
}

bool matches(const std::string& pattern, const std::string& name) {
  std::size_t p = 0, n = 0, star = std::string::npos, mark = 0;
  while (n < name.size()) {
    if (p < pattern.size() && (pattern[p] == '?' || pattern[p] == name[n]) && pattern[p] != '*') {
      ++p;
      ++n;
    } else if (p < pattern.size() && pattern[p] == '*') {
      star = p++;
      mark = n;
    } else if (star != std::string::npos) {
      p = star + 1;
      n = ++mark;
    } else {
      return false;
    }
  }
  while (p < pattern.size() && pattern[p] == '*') ++p;
  return p == pattern.size();
}

std::vector<std::string> match_names(std::span<const std::string> patterns,
                                     std::span<const std::string> names, const std::string& what) {
  std::vector<bool> taken(names.size(), false);
  std::vector<Diagnostic> mistakes;
  for (const std::string& pattern : patterns) {
    bool any = false;
    for (std::size_t i = 0; i < names.size(); ++i) {
      if (matches(pattern, names[i])) taken[i] = any = true;
    }
    if (!any) {
      mistakes.push_back({Severity::error, "no-match", fmt::format("no {} matches `{}`", what, pattern),
                          std::nullopt, suggest(pattern, names)});
    }
  }
  if (!mistakes.empty()) throw InputError(std::move(mistakes));
  std::vector<std::string> matched;
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (taken[i]) matched.push_back(names[i]);
  }
  return matched;
}

}  // namespace brachium::data
