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
  std::vector<double> time, moment, activation;
  for (std::size_t k = 0; k < group.members.size(); ++k) {
    const std::string& name = group.members[k];
    const data::Signal force = model.signals->signal(t, info.signal_index(name + "_force")),
                       arm = model.signals->signal(t, info.signal_index(name + "_moment_arm")),
                       a = activations.signals->signal(at, driven.signal_index(name));
    if (k == 0) {
      for (std::size_t i = 0; i < force.samples.size(); ++i) {
        const double s = force.info.time_s(i);
        if (s >= std::max(angle.info.start_time_s, a.info.start_time_s) &&
            s <= std::min(angle.info.end_time_s(), a.info.end_time_s()))
          time.push_back(s);
      }
      moment.assign(time.size(), 0.0);
      activation.assign(time.size(), 0.0);
    }
    const std::vector<double> f = data::evaluate_at(force, time), r = data::evaluate_at(arm, time),
                              own = data::evaluate_at(a, time);
    for (std::size_t i = 0; i < time.size(); ++i) {
      moment[i] += f[i] * r[i];
      activation[i] += group.strength_n[k] / group.sum_n() * std::clamp(own[i], 0.0, 1.0);
    }
  }
  const std::vector<double> q = data::evaluate_at(angle, time);
  std::vector<ReferenceForce> out;
  for (std::size_t i = 0; i < time.size(); ++i) {
    if (q[i] >= range.lower_rad && q[i] <= range.upper_rad)
      out.push_back({q[i], activation[i], moment[i], 1.0, "moments", Measure::moment});
  }
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
