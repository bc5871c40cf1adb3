#include "pipelines/stages/limb_groups.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <numeric>

#include "data/limb/muscle_path.hpp"
#include "data/model/curve.hpp"
#include "pipelines/stages/fem_option_kinds.hpp"

namespace brachium::pipelines {
namespace {

constexpr double degree = std::numbers::pi / 180.0;

std::vector<const data::SceneMuscle*> over(const data::Scene& scene, const data::Coordinate& coordinate) {
  std::vector<const data::SceneMuscle*> out;
  for (const data::SceneMuscle& m : scene.muscles) {
    if (m.path.kind != data::PathGeometry::Kind::none && m.path.coordinate == coordinate.name)
      out.push_back(&m);
  }
  return out;
}

/// V / L of the belly: mean of pi r^2 flatness along the profile.
double mean_section_m2(const fem::MuscleBody& body) {
  const auto n = body.profile_m.size();
  std::vector<double> at(n);
  for (std::size_t i = 0; i < n; ++i) at[i] = static_cast<double>(i) / static_cast<double>(n - 1);
  const data::PiecewiseCubic radius = data::PiecewiseCubic::monotone(at, body.profile_m);
  constexpr int steps = 200;
  double sum = 0.0;
  for (int i = 0; i < steps; ++i) {
    const double r = radius((i + 0.5) / steps).value;
    sum += r * r / steps;
  }
  return std::numbers::pi * body.flatness * sum;
}

void scale_lengths(fem::MuscleBody& b, double s) {
  b.cable.origin_m *= s;
  b.cable.distance_m *= s;
  b.cable.obstacle_m *= s;
  b.cable.radius_m *= s;
  b.belly_length_m *= s;
  for (double& r : b.profile_m) r *= s;
  b.tendon_origin_m *= s;
  b.tendon_insertion_m *= s;
  b.transition_m *= s;
  b.standoff_m *= s;
  if (!b.shape) return;
  fem::BodyShape shape = *b.shape;  // its mesh goes with belly_length_m and profile_m
  shape.origin_across_m *= s;
  shape.beside_path_m *= s;
  b.shape = std::make_shared<const fem::BodyShape>(std::move(shape));
}

void scale(fem::RigidShape& shape, double s, const std::string& bone) {
  if (auto* c = std::get_if<fem::Capsule>(&shape)) {
    c->from_m *= s, c->to_m *= s, c->radius_m *= s;
  } else if (auto* b = std::get_if<fem::Sphere>(&shape)) {
    b->centre_m *= s, b->radius_m *= s;
  } else if (auto* e = std::get_if<fem::Ellipsoid>(&shape)) {
    e->centre_m *= s, e->semi_axes_m *= s;
  } else {
    throw data::InputError(
        "unsupported-scaling",
        fmt::format("bone `{}` is a triangle mesh: the limb cannot be scaled with it", bone),
        "scale the mesh to the subject beforehand, and set `scale_to = \"none\"`");
  }
}

/// Excursion of a group's paths, members weighted by strength, over that of the tendon's path.
double excursion_ratio(const MuscleGroup& group, const fem::MuscleBody& body, const data::Scene& scene,
                       const data::Coordinate& coordinate, double from, double to) {
  double of_paths = 0.0;
  for (std::size_t k = 0; k < group.members.size(); ++k) {
    const data::SceneMuscle& m = scene.muscle(group.members[k]);
    const limb::MusclePath path(m.name, m.path, coordinate);
    of_paths += group.strength_n[k] / group.sum_n() * (path(from).length_m - path(to).length_m);
  }
  return of_paths / (fem::CablePath(body.cable, from).length_m() - fem::CablePath(body.cable, to).length_m());
}

}  // namespace

double MuscleGroup::sum_n() const {
  return std::accumulate(strength_n.begin(), strength_n.end(), 0.0);
}

std::vector<double> group_activation(const CommonFrames& frames, const MuscleGroup& group,
                                     const data::SessionSource& source, std::size_t trial, bool clamp,
                                     std::size_t& brought) {
  const data::TrialInfo& info = source.info().trials[trial];
  std::vector<double> mean(frames.time.count, 0.0);
  for (std::size_t k = 0; k < group.members.size(); ++k) {
    const std::vector<double> a =
        activation_at(frames, source, trial, info.signal_index(group.members[k]), clamp, brought);
    for (std::size_t i = 0; i < mean.size(); ++i) mean[i] += group.strength_n[k] / group.sum_n() * a[i];
  }
  return mean;
}

OptionSpec group_option() {
  return list_option(
      "group",
      {required_text("muscle", "muscle of the limb"),
       optional_texts("members", "lumped muscles of the scene that it stands for")},
      "which lumped muscles a continuum muscle stands for; absent: those whose strength group has its "
      "name. Its activation is the mean of theirs, weighted by strength times maximal isometric force");
}

Grouping group_muscles(const Options& options, const data::Scene& scene, const data::Coordinate& coordinate,
                       const data::Subject* subject, const std::vector<std::string>& muscles) {
  std::map<std::string, std::vector<std::string>> given;
  for (const Options& o : options.tables("group")) {
    const std::string& muscle = o.text("muscle");
    if (std::find(muscles.begin(), muscles.end(), muscle) == muscles.end())
      throw data::InputError("missing-muscle",
                             fmt::format("`group` names the muscle `{}`, which the limb lacks", muscle),
                             data::suggest(muscle, muscles));
    if (o.has("members")) given[muscle] = o.texts("members");
  }
  Grouping out;
  std::map<std::string, std::string> taken;
  for (const std::string& muscle : muscles) {
    MuscleGroup group{muscle, {}, {}};
    if (given.contains(muscle)) {
      group.members = given.at(muscle);
    } else {
      for (const data::SceneMuscle* m : over(scene, coordinate)) {
        if (m->group == muscle) group.members.push_back(m->name);
      }
    }
    if (group.members.empty())
      throw data::InputError("missing-muscle",
                             fmt::format("no muscle of scene `{}` is in the group `{}`", scene.title, muscle),
                             "say in `group` which lumped muscles it stands for");
    for (const std::string& member : group.members) {
      const auto& parameters = subject ? subject->muscle(member).parameters : scene.muscle(member).parameters;
      group.strength_n.push_back(parameters.strength * parameters.max_isometric_force_N);
      if (const auto [at, added] = taken.try_emplace(member, muscle); !added)
        throw data::InputError(
            "contradiction",
            fmt::format("muscle `{}` is in the groups of `{}` and of `{}`", member, at->second, muscle));
    }
    out.groups.push_back(std::move(group));
  }
  for (const data::SceneMuscle* m : over(scene, coordinate)) {
    if (!taken.contains(m->name)) out.left_out.push_back(m->name);
  }
  return out;
}

LimbScaling scale_limb(LimbScene& limb, const Grouping& grouping, const data::Scene& scene,
                       const data::Coordinate& coordinate, const std::string& strength) {
  const double from = std::max(limb.range.lower_rad, coordinate.lower_rad),
               to = std::min(limb.range.upper_rad, coordinate.upper_rad);
  if (!(from < to))
    throw data::InputError(
        "no-common-range",
        fmt::format("the limb's angles ({:.4g} to {:.4g} deg) and those of the scene's paths ({:.4g} to "
                    "{:.4g} deg) share none",
                    limb.range.lower_rad / degree, limb.range.upper_rad / degree,
                    coordinate.lower_rad / degree, coordinate.upper_rad / degree));
  LimbScaling scaling;
  double weighted = 0.0, weights = 0.0;
  std::vector<double> ratios;
  for (const MuscleGroup& g : grouping.groups) {
    ratios.push_back(excursion_ratio(g, limb.muscle(g.muscle).body, scene, coordinate, from, to));
    weighted += g.sum_n() * ratios.back();
    weights += g.sum_n();
  }
  const double s = scaling.length_factor = weighted / weights;
  for (fem::Bone& bone : limb.humerus) scale(bone.shape, s, bone.name);
  for (BoneSurface& surface : limb.surfaces) surface.points *= s;
  limb.load_arm_m *= s;
  limb.forearm_length_m *= s;
  TableBuilder table("the limb scaled to the subject");
  table.text("muscle")
      .text("stands_for")
      .number("excursion_ratio", "1")
      .number("length_factor", "1")
      .number("strength_N", "N")
      .number("mean_section_m2", "m^2")
      .number("radius_factor", "1")
      .number("max_stress_Pa", "Pa");
  for (LimbMuscle& m : limb.muscles) {
    const auto at = std::find_if(grouping.groups.begin(), grouping.groups.end(),
                                 [&](const MuscleGroup& g) { return g.muscle == m.body.name; });
    if (at == grouping.groups.end()) continue;
    scale_lengths(m.body, s);
    if (m.in_situ && strength == "cross_section")
      throw data::InputError(
          "contradiction",
          fmt::format("muscle `{}` is imported in situ: its cross-section is the mesh's", m.body.name),
          "take strength = \"max_stress\" or \"none\"");
    if (m.in_situ) m.in_situ->points *= s;
    double radius_factor = 1.0;
    const double force = at->sum_n(), section = mean_section_m2(m.body);
    if (strength == "max_stress") m.body.material.max_stress_pa = force / section;
    if (strength == "cross_section") {
      radius_factor = std::sqrt(force / (m.body.material.max_stress_pa * section));
      for (double& r : m.body.profile_m) r *= radius_factor;
    }
    table.row({m.body.name, fmt::format("{}", fmt::join(at->members, ", ")),
               ratios[static_cast<std::size_t>(at - grouping.groups.begin())], s, force,
               mean_section_m2(m.body), radius_factor, m.body.material.max_stress_pa});
    fem::check(m.body, limb.range);
  }
  scaling.table = table.take();
  return scaling;
}

}  // namespace brachium::pipelines
