#include "pipelines/stages/muscle_moment_references.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "data/model/resample.hpp"
#include "pipelines/stages/common.hpp"

namespace brachium::pipelines {
namespace {

using optimise::Measure;
using optimise::ReferenceForce;

constexpr double degree = std::numbers::pi / 180.0;

/// Frames of one trial: angle, activation and moment of the group.
std::vector<ReferenceForce> frames_of(const StageContext& context, const std::string& trial,
                                      const MuscleGroup& group, const fem::AngleRange& range) {
  const StageData &model = context.input("moments"), &activations = context.input("activation");
  const data::Coordinate& coordinate =
      coordinate_of(context.need_scene(), context.options->maybe_text("coordinate").value_or(""));
  const data::Signal angle =
      signal_of(context.input("kinematics"), trial, data::Quantity::joint_angle, coordinate.name);
  const std::size_t t = trial_index(model, trial), at = trial_index(activations, trial);
  const data::TrialInfo &info = model.signals->info().trials[t],
                        &driven = activations.signals->info().trials[at];
  const auto signal = [&](const std::string& name) {
    return model.signals->signal(t, info.signal_index(name));
  };
  const std::string& first = group.members.front();
  const MomentFrames frames = kinematics_at(
      common_frames(driven.signals[driven.signal_index(first)], angle, signal(first + "_force"), trial),
      angle, std::nullopt);
  std::vector<double> time(frames.time.count), moment(frames.time.count, 0.0);
  for (std::size_t i = 0; i < time.size(); ++i) time[i] = frames.time.time_s(i);
  for (const std::string& name : group.members) {
    const std::vector<double> f = data::evaluate_at(signal(name + "_force"), time),
                              r = data::evaluate_at(signal(name + "_moment_arm"), time);
    for (std::size_t i = 0; i < time.size(); ++i) moment[i] += f[i] * r[i];
  }
  std::size_t brought = 0;
  const std::vector<double> a = group_activation(frames, group, *activations.signals, at, true, brought);
  std::vector<ReferenceForce> out;
  for (std::size_t i = 0; i < time.size(); ++i) {
    const double q = frames.angle_rad[i];
    if (q >= range.lower_rad && q <= range.upper_rad)
      out.push_back({q, a[i], moment[i], 1.0, "moments", Measure::moment});
  }
  if (context.say && (brought > 0 || out.size() < time.size()))
    context.say(
        fmt::format("{}, trial `{}`: {} samples of activation brought into [0, 1], {} of {} frames outside "
                    "the limb's angles left out",
                    group.muscle, trial, brought, time.size() - out.size(), time.size()));
  return out;
}

}  // namespace

std::vector<OptionSpec> moment_reference_options() {
  return {number_option("moment_angle_cell_deg", "deg", 20.0, above(0),
                        "the input `moments` gives one reference a cell of angle and activation: its width"),
          number_option("moment_activation_cell", "1", 0.2, above(0), "and its height"),
          optional_text("coordinate", "joint coordinate of the scene, where the input `moments` is wired")};
}

std::vector<ReferenceForce> moment_references(const StageContext& context, const MuscleGroup& group,
                                              const fem::AngleRange& range) {
  const double width = context.options->number("moment_angle_cell_deg") * degree,
               height = context.options->number("moment_activation_cell");
  std::map<std::pair<long, long>, std::vector<ReferenceForce>> cells;
  for (const std::string& trial : context.trials) {
    for (const ReferenceForce& r : frames_of(context, trial, group, range))
      cells[{std::lround(std::floor(r.activation / height)),
             std::lround(std::floor((r.q_rad - range.lower_rad) / width))}]
          .push_back(r);
  }
  if (cells.empty())
    throw data::InputError(
        "no-references",
        fmt::format("muscle `{}`: no frame of the moments lies between {:.4g} and {:.4g} deg", group.muscle,
                    range.lower_rad / degree, range.upper_rad / degree),
        "choose trials inside the limb's range");
  std::vector<ReferenceForce> out;
  for (const auto& [cell, frames] : cells) {
    const auto n = static_cast<double>(frames.size());
    double q = 0.0, a = 0.0;
    for (const ReferenceForce& r : frames) q += r.q_rad / n, a += r.activation / n;
    const auto away = [&](const ReferenceForce& r) {
      return std::hypot((r.q_rad - q) / width, (r.activation - a) / height);
    };
    out.push_back(*std::min_element(frames.begin(), frames.end(),
                                    [&](const auto& x, const auto& y) { return away(x) < away(y); }));
  }
  return out;
}

}  // namespace brachium::pipelines
