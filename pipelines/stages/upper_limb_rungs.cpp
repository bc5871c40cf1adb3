#include "pipelines/stages/upper_limb_rungs.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "data/model/error.hpp"
#include "fem/limb/solve_map.hpp"
#include "pipelines/stages/fem_limb_map.hpp"
#include "pipelines/stages/fem_muscle_map.hpp"

namespace brachium::pipelines {
namespace {

class SurrogateRung final : public LimbRung {
 public:
  SurrogateRung(LimbMap map, std::string method) : map_(std::move(map)), method_(std::move(method)) {
    for (const MappedMuscle& m : map_.muscles) {
      names_.push_back(m.name);
      if (m.surrogate->bounds().activation_lower > 0.0)
        throw data::InputError(
            "outside-surrogate",
            fmt::format("the map of `{}` begins at activation {:.3g}: nothing is known of the passive muscle",
                        m.name, m.surrogate->bounds().activation_lower),
            "add activation 0 to the states of the map");
    }
  }

  const std::vector<std::string>& muscles() const override { return names_; }
  double lower_rad() const override {
    return bound([](const fem::StateBounds& b) { return -b.theta_lower_rad; }) * -1.0;
  }
  double upper_rad() const override {
    return bound([](const fem::StateBounds& b) { return b.theta_upper_rad; });
  }
  double upper_activation() const override {
    return bound([](const fem::StateBounds& b) { return b.activation_upper; });
  }
  std::string words() const override {
    return fmt::format("surrogates of `{}` ({})", map_.stage, map_.muscles.front().surrogate->method());
  }

  MuscleFrames evaluate(std::size_t muscle, const LimbFrames& frames) override {
    const fem::Surrogate& s = *map_.muscles[muscle].surrogate;
    const bool work = method_ == "virtual_work";
    const auto force = static_cast<Eigen::Index>(s.output("force_n")),
               other = static_cast<Eigen::Index>(s.output(work ? "moment_n_m" : method_ + "_m"));
    const std::vector<double> rest(frames.angle_rad.size(), 0.0);
    const auto now = s.evaluate_series(frames.angle_rad, frames.activation[muscle]);
    const auto passive = s.evaluate_series(frames.angle_rad, rest);
    MuscleFrames out;
    for (Eigen::Index i = 0; i < now.value.cols(); ++i) {
      const double f = now.value(force, i), x = now.value(other, i);
      out.force_n.push_back(f);
      out.moment_n_m.push_back(work ? x : x * f);
      out.arm_m.push_back(!work ? x : f != 0.0 ? x / f : 0.0);
      out.passive_n_m.push_back(work ? passive.value(other, i)
                                     : passive.value(other, i) * passive.value(force, i));
    }
    return out;
  }

 private:
  template <class Of>
  double bound(Of of) const {
    double least = of(map_.muscles.front().surrogate->bounds());
    for (const MappedMuscle& m : map_.muscles) least = std::min(least, of(m.surrogate->bounds()));
    return least;
  }

  LimbMap map_;
  std::string method_;
  std::vector<std::string> names_;
};

class SolvedRung final : public LimbRung {
 public:
  SolvedRung(PreparedLimb limb, std::string method) : limb_(std::move(limb)), method_(std::move(method)) {
    limb_.solving.slopes = false;
    names_ = limb_.scene.muscle_names();
    states_.resize(names_.size());
  }

  const std::vector<std::string>& muscles() const override { return names_; }
  double lower_rad() const override { return limb_.scene.range.lower_rad; }
  double upper_rad() const override { return limb_.scene.range.upper_rad; }
  double upper_activation() const override { return 1.0; }
  std::string words() const override { return fmt::format("every frame solved ({})", limb_.scene.title); }

  void begin(const StageContext& context) override { make_stress_free(limb_, names_, context); }

  MuscleFrames evaluate(std::size_t muscle, const LimbFrames& frames) override {
    MuscleFrames out;
    for (std::size_t i = 0; i < frames.time_s.size(); ++i) {
      const fem::MuscleState now = at(muscle, frames, i, frames.activation[muscle][i]);
      const fem::MuscleState passive = at(muscle, frames, i, 0.0);
      const double r = arm(now);
      out.force_n.push_back(now.force_n);
      out.arm_m.push_back(r);
      out.moment_n_m.push_back(r * now.force_n);
      out.passive_n_m.push_back(arm(passive) * passive.force_n);
      out.unstable += now.stability == fem::StateStability::unstable;
    }
    return out;
  }

 private:
  double arm(const fem::MuscleState& s) const {
    if (method_ == "vrla") return s.vrla_m.value();
    if (method_ == "vrla_plus") return s.vrla_plus_m.value();
    return s.force_n != 0.0 ? s.moment_n_m / s.force_n : 0.0;
  }

  fem::MuscleState at(std::size_t muscle, const LimbFrames& frames, std::size_t i, double activation) {
    try {
      auto& states = states_[muscle];
      if (!states)
        states = std::make_unique<fem::MuscleStates>(limb_.scene.muscles[muscle].body, limb_.scene.range,
                                                     limb_.scene.hinge, limb_.scene.humerus, limb_.solving);
      return fem::map_state(states->solve_state(frames.angle_rad[i], activation), limb_.scene.hinge);
    } catch (const data::ConvergenceFailure& failure) {
      data::ConvergenceFailure::Details details = failure.details();
      details.where =
          fmt::format("trial `{}` at {:.3f} s, {}", frames.trial, frames.time_s[i], details.where);
      throw data::ConvergenceFailure(std::move(details));
    }
  }

  PreparedLimb limb_;
  std::string method_;
  std::vector<std::string> names_;
  std::vector<std::unique_ptr<fem::MuscleStates>> states_;  ///< by muscle, from its first frame on
};

}  // namespace

void check_lever_arm(const Options& options) {
  if (options.has("limb") && options.text("lever_arm") == "tdm")
    throw data::InputError("contradiction",
                           "the lever arm by tendon displacement needs passive lengths at many angles",
                           "wire `map` to a stage fem.muscle_map, or choose another `lever_arm`");
}

std::unique_ptr<LimbRung> limb_rung(const StageContext& context) {
  const StageData* map = context.maybe_input("map");
  const bool limb = context.options->has("limb");
  if ((map != nullptr) == limb)
    throw data::InputError(
        limb ? "contradiction" : "missing-key",
        limb ? "muscles come from the input `map` or from the file `limb`, not from both"
             : "there are no muscles: neither the input `map` nor the file `limb`",
        "wire `map` to a stage fem.muscle_map (surrogates), or name a limb (every frame is solved)");
  check_lever_arm(*context.options);
  const std::string method = context.options->text("lever_arm");
  if (map) return std::make_unique<SurrogateRung>(limb_map_of(*map), method);
  return std::make_unique<SolvedRung>(prepare_limb(context), method);
}

}  // namespace brachium::pipelines
