#include "optimise/prepare.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "data/model/error.hpp"

namespace brachium::optimise {

UsableSpan usable_span(const CalibrationTrial& trial, double edge_s) {
  if (!trial.use.empty() && trial.use.size() != trial.moment.samples.size()) {
    throw data::InputError("wrong-size",
                           fmt::format("trial `{}`: {} samples of the moment, {} marks of use", trial.name,
                                       trial.moment.samples.size(), trial.use.size()));
  }
  double from = trial.moment.info.start_time_s, to = trial.moment.info.end_time_s();
  const auto narrow = [&](const data::Signal& signal) {
    from = std::max(from, signal.info.start_time_s);
    to = std::min(to, signal.info.end_time_s());
  };
  narrow(trial.angle);
  if (trial.velocity) narrow(*trial.velocity);
  for (const data::Signal& signal : trial.excitations) narrow(signal);
  const auto& info = trial.moment.info;
  const double tolerance = 1e-6;
  const auto lowest = [&](double t) { return std::ceil((t - info.start_time_s) * info.rate_hz - tolerance); };
  const auto highest = [&](double t) {
    return std::floor((t - info.start_time_s) * info.rate_hz + tolerance);
  };
  const double frame0 = lowest(from), frame1 = highest(to), row0 = lowest(from + edge_s),
               row1 = highest(to - edge_s);
  if (!(row1 - row0 >= 7.0))
    throw data::InputError(
        "empty-window",
        fmt::format("trial `{}`: excitation, angle and moment share {:.3f} s ({:.3f} to {:.3f} s), too "
                    "little after {:.3f} s are dropped at each end",
                    trial.name, std::max(to - from, 0.0), from, to, edge_s),
        "check the signals' start times, or drop less at the edges");
  return {static_cast<std::size_t>(frame0), static_cast<std::size_t>(frame1), static_cast<std::size_t>(row0),
          static_cast<std::size_t>(row1)};
}

void motion_at(const CalibrationTrial& trial, std::span<const double> times_s, std::vector<double>& angle,
               std::vector<double>& velocity) {
  angle.resize(times_s.size());
  velocity.resize(times_s.size());
  if (trial.velocity) {
    Resampling(trial.angle.info, times_s).apply(trial.angle.samples, angle);
    Resampling(trial.velocity->info, times_s).apply(trial.velocity->samples, velocity);
    return;
  }
  std::vector<double> knots(trial.angle.samples.size());
  for (std::size_t i = 0; i < knots.size(); ++i) knots[i] = trial.angle.info.time_s(i);
  const auto spline = data::PiecewiseCubic::forsythe(knots, trial.angle.samples);
  for (std::size_t i = 0; i < times_s.size(); ++i) {
    const data::CurveValue value = spline(times_s[i]);
    angle[i] = value.value;
    velocity[i] = value.slope;
  }
}

std::vector<std::vector<double>> channel_samples(const CalibrationTrial& trial,
                                                 const std::vector<std::string>& channels) {
  std::vector<std::vector<double>> out;
  std::vector<std::string> known;
  for (const data::Signal& signal : trial.excitations) known.push_back(signal.info.name);
  for (const std::string& channel : channels) {
    const auto found = std::find(known.begin(), known.end(), channel);
    if (found == known.end())
      throw data::InputError("unmapped-channel",
                             fmt::format("trial `{}` has no excitation of channel `{}`", trial.name, channel),
                             data::suggest(channel, known));
    out.push_back(trial.excitations[static_cast<std::size_t>(found - known.begin())].samples);
  }
  return out;
}

std::shared_ptr<PreparedTrial> prepare_trial(const CalibrationTrial& trial, const Chain& chain,
                                             const std::vector<limb::MusclePath>& paths) {
  std::vector<data::Diagnostic> found;
  const auto collect = [&](const auto& task) {
    try {
      task();
    } catch (const data::InputError& error) {
      found.insert(found.end(), error.diagnostics().begin(), error.diagnostics().end());
    }
  };
  const std::string what = fmt::format("trial `{}`", trial.name);
  if (trial.moment.samples.empty())
    throw data::InputError("missing-moment", fmt::format("trial `{}` has no reference moment", trial.name),
                           "wire a measured moment or one from inverse dynamics, or leave the trial out");
  for (const data::Signal& signal : trial.excitations) collect([&] { check_samples(signal, what); });
  collect([&] { check_samples(trial.angle, what); });
  if (trial.velocity) collect([&] { check_samples(*trial.velocity, what); });
  collect([&] { check_samples(trial.moment, what); });
  for (std::size_t k = 1; k < trial.excitations.size() && found.empty(); ++k) {
    const auto &a = trial.excitations[0].info, &b = trial.excitations[k].info;
    if (a.rate_hz != b.rate_hz || a.start_time_s != b.start_time_s || a.count != b.count)
      found.push_back(
          {data::Severity::error,
           "rate-mismatch",
           fmt::format(
               "trial `{}`: excitations `{}` ({} Hz, {} samples from {} s) and `{}` ({} Hz, {} samples from "
               "{} s) are not on one grid",
               trial.name, a.name, a.rate_hz, a.count, a.start_time_s, b.name, b.rate_hz, b.count,
               b.start_time_s),
           {},
           "resample them first"});
  }
  if (!found.empty()) throw data::InputError(std::move(found));

  auto out = std::make_shared<PreparedTrial>();
  const UsableSpan span = usable_span(trial, chain.options.edge_s);
  out->name = trial.name;
  out->frame_rate_hz = trial.moment.info.rate_hz;
  for (std::size_t i = span.first_frame; i <= span.last_frame; ++i)
    out->frame_time_s.push_back(trial.moment.info.time_s(i));
  motion_at(trial, out->frame_time_s, out->angle_rad, out->velocity_rad_s);
  const std::size_t n = out->frame_time_s.size();
  for (const limb::MusclePath& path : paths) {
    auto& length = out->length_m.emplace_back(n);
    auto& arm = out->arm_m.emplace_back(n);
    auto& velocity = out->velocity_m_s.emplace_back(n);
    collect([&] {
      try {
        path.evaluate(out->angle_rad, out->velocity_rad_s, length, arm, velocity);
      } catch (const data::InputError& error) {
        std::vector<data::Diagnostic> named = error.diagnostics();
        for (auto& diagnostic : named) diagnostic.message = what + ": " + diagnostic.message;
        throw data::InputError(std::move(named));
      }
    });
  }
  if (!found.empty()) throw data::InputError(std::move(found));

  if (!trial.excitations.empty()) {
    const auto& info = trial.excitations.front().info;
    out->excitation_rate_hz = info.rate_hz;
    out->excitation_count = info.count;
    out->to_frames = Resampling(info, out->frame_time_s);
  }
  for (std::size_t i = span.first_row; i <= span.last_row; i += chain.options.decimate) {
    if (!trial.use.empty() && !trial.use[i]) {
      ++out->window.masked;
      continue;
    }
    out->rows.push_back(i - span.first_frame);
    out->reference.push_back(trial.moment.samples[i]);
  }
  if (out->rows.size() < 8) {
    throw data::InputError(
        "empty-window",
        fmt::format("trial `{}`: {} frames are left to compare, {} are marked as not to be used", trial.name,
                    out->rows.size(), out->window.masked),
        "see what marked them in the stage that made the moment, or leave the trial out");
  }
  out->window.name = trial.name;
  out->window.first_time_s = trial.moment.info.time_s(span.first_row);
  out->window.last_time_s = trial.moment.info.time_s(span.last_row);
  out->window.used = out->rows.size();
  out->window.before = span.first_row;
  out->window.after = trial.moment.samples.size() - 1 - span.last_row;
  const auto samples = channel_samples(trial, chain.drive.channels);
  for (std::size_t k = 0; k < samples.size(); ++k) {
    for (double value : samples[k]) {
      out->window.above_one += value * chain.start.gains[k] > 1.0 ? 1 : 0;
      out->window.below_zero += value < 0.0 ? 1 : 0;
    }
  }
  return out;
}

}  // namespace brachium::optimise
