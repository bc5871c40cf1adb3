/// The equivalent static systems that optimise.scenario is asked about: of forces that the definition gives, or of the
/// muscle maps that are wired, once a lever arm.

#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "fem/surrogate/tensor.hpp"
#include "optimise/scenario_signs.hpp"
#include "pipelines/stages/common.hpp"
#include "pipelines/stages/fem_limb_map.hpp"
#include "pipelines/stages/optimise_scenario.hpp"

namespace brachium::pipelines {
namespace {

constexpr double deg = std::numbers::pi / 180.0;
using optimise::thesis::Action;

/// Σ c_k theta^k in mm, theta in degrees, as metres over radians.
data::CurveValue lever(const std::vector<double>& coefficients, double q) {
  const double t = q / deg;
  data::CurveValue v;
  for (std::size_t k = coefficients.size(); k-- > 0;) {
    v.slope = v.slope * t + v.value;
    v.value = v.value * t + coefficients[k];
  }
  return {1e-3 * v.value, 1e-3 * v.slope / deg};
}

fem::SurrogateMuscle muscle_of(const Options& o, const std::string& curve) {
  const std::string& name = o.text("name");
  const std::vector<double>&angle = o.numbers("angle_deg"), &activation = o.numbers("activation"),
        &force = o.numbers("force_N");
  if (force.size() != angle.size() * activation.size()) {
    throw data::InputError("wrong-size",
                           fmt::format("muscle `{}` has {} forces for {} angles and {} activations", name,
                                       force.size(), angle.size(), activation.size()),
                           "give the forces at all angles for the first activation, then for the next");
  }
  fem::SampleSet set{{"force_n"}, {}};
  for (std::size_t j = 0; j < activation.size(); ++j) {
    for (std::size_t i = 0; i < angle.size(); ++i)
      set.samples.push_back(
          {{angle[i] * deg, activation[j]}, Eigen::VectorXd::Constant(1, force[j * angle.size() + i])});
  }
  fem::TensorOptions options;
  options.theta = curve == "monotone" ? fem::ThetaCurve::monotone
                  : curve == "linear" ? fem::ThetaCurve::linear
                                      : fem::ThetaCurve::cubic;
  options.alpha = activation.size() > 2 ? fem::AlphaCurve::cubic : fem::AlphaCurve::linear;
  const Action action = o.text("action") == "flexor" ? Action::flexor : Action::extensor;
  const std::vector<double> coefficients = o.numbers("lever_arm_mm");
  return {name, std::make_shared<fem::Surrogate>(fem::tensor_spline(fem::as_grid(set), options)), "force_n",
          fem::ArmOfAngle{[action, coefficients](double q) {
            return optimise::thesis::moment_arm(action, lever(coefficients, q));
          }}};
}

fem::SurrogateModel model_of(const Options& options) {
  std::vector<fem::SurrogateMuscle> muscles;
  for (const Options& o : options.tables("muscle"))
    muscles.push_back(muscle_of(o, options.text("force_curve")));
  return fem::SurrogateModel("angle", std::move(muscles));
}

optimise::StaticSystem system_of(const Options& options, const fem::SurrogateModel& model,
                                 double limb_arm_m) {
  optimise::StaticSystem system;
  system.model = &model;
  const auto arm = options.maybe_number("load_arm_mm");
  if (arm || limb_arm_m > 0.0) {
    const double metres = arm ? 1e-3 * *arm : limb_arm_m;
    system.load_arm = [metres](double q) {
      return optimise::thesis::load_arm({metres * std::sin(q), metres * std::cos(q)});
    };
  }
  const data::Domain range = model.angles();
  const auto lower = options.maybe_number("lower_deg"), upper = options.maybe_number("upper_deg");
  system.lower_rad = lower ? *lower * deg : range.lower;
  system.upper_rad = upper ? *upper * deg : range.upper;
  return system;
}

}  // namespace

std::vector<ScenarioSystem> scenario_systems(const StageContext& context) {
  const Options& options = *context.options;
  const auto wired = context.inputs.find("map");
  const bool maps = wired != context.inputs.end() && !wired->second.empty();
  if (maps == !options.tables("muscle").empty())
    throw data::InputError(maps ? "contradiction" : "missing-key",
                           maps ? "forces come from `muscle` or from the input `map`, not from both"
                                : "there are no muscles: neither `muscle` nor the input `map`",
                           "give the forces in `muscle`, or wire `map` to a stage fem.muscle_map");
  std::vector<ScenarioSystem> systems;
  const auto add = [&](const std::string& name, fem::SurrogateModel model, double load_arm_m) {
    auto kept = std::make_shared<const fem::SurrogateModel>(std::move(model));
    systems.push_back({name, kept, system_of(options, *kept, load_arm_m)});
  };
  if (!maps) {
    add("given forces", model_of(options), 0.0);
    return systems;
  }
  for (const StageData* input : wired->second) {
    const LimbMap map = limb_map_of(*input);
    for (const std::string& method : options.texts("lever_arm"))
      add(fmt::format("{}: {}", map.stage, moment_method_words(method)), model_of(map, method, "angle"),
          map.load_arm_m);
  }
  return systems;
}

}  // namespace brachium::pipelines
