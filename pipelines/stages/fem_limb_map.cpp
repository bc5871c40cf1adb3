#include "pipelines/stages/fem_limb_map.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>

#include "fem/surrogate/sparse_spline.hpp"
#include "fem/surrogate/tensor.hpp"

namespace brachium::pipelines {
namespace {

using fem::MapOutput;

/// Derivatives are kept only where the method uses them.
fem::SampleSet complete_samples(const fem::MuscleMap& map, const std::vector<MapOutput>& outputs) {
  fem::MapSamples samples = fem::samples_of(map, outputs);
  if (!samples.left_out.empty()) {
    const fem::FailedState& s = samples.left_out.front();
    throw data::InputError(
        "not-a-grid",
        fmt::format(
            "muscle `{}`: no surrogate without the state at {:.6g} deg, activation {:.4g}: {}{}", map.muscle,
            s.at.theta_rad * 57.29577951308232, s.at.activation, s.reason,
            samples.left_out.size() > 1 ? fmt::format(" (and {} more)", samples.left_out.size() - 1) : ""),
        "ask for other states, a smaller range of angles, or a finer mesh");
  }
  return std::move(samples.set);
}

double number(const StageData& data, const std::string& attribute) {
  return std::strtod(data.attributes.at(attribute).c_str(), nullptr);
}

}  // namespace

const std::vector<std::string>& moment_methods() {
  static const std::vector<std::string> all{"virtual_work", "tdm", "vrla", "vrla_plus"};
  return all;
}

std::string moment_method_words(const std::string& method) {
  return method == "virtual_work" ? "virtual work"
         : method == "tdm"        ? "tendon displacement (TDM)"
         : method == "vrla"       ? "resultant (VRLA)"
                                  : "line of action (VRLA+)";
}

std::vector<MapOutput> outputs_of(const fem::MuscleMap& map) {
  std::vector<MapOutput> out{MapOutput::force, MapOutput::moment};
  const bool tdm = std::all_of(map.states.begin(), map.states.end(),
                               [](const fem::MuscleState& s) { return s.tdm_m.has_value(); });
  if (tdm) out.push_back(MapOutput::tdm);
  for (const MapOutput o :
       {MapOutput::vrla, MapOutput::vrla_plus, MapOutput::contact_force, MapOutput::mean_fibre_stretch})
    out.push_back(o);
  return out;
}

fem::Surrogate make_map_surrogate(const fem::MuscleMap& map, const std::string& method) {
  const fem::SampleSet samples = complete_samples(map, outputs_of(map));
  if (method.starts_with("sparse_"))
    return fem::sparse_surrogate(
        samples, map.bounds,
        method == "sparse_included" ? fem::SparseBoundary::included : fem::SparseBoundary::modified);
  if (method == "hermite") {
    const fem::SampleSet exact = complete_samples(map, {MapOutput::force, MapOutput::moment});
    return fem::hermite_surrogate(fem::as_grid(fem::with_spline_slopes(samples, exact)));
  }
  fem::TensorOptions options;
  if (method == "quintic") options.theta = fem::ThetaCurve::quintic, options.alpha = fem::AlphaCurve::quintic;
  return fem::tensor_spline(fem::as_grid(samples), options);
}

LimbMap limb_map_of(const StageData& data) {
  if (!data.tables.contains("states") || !data.attributes.contains("surrogate_method"))
    throw data::InputError("not-a-muscle-map", fmt::format("stage `{}` leaves no muscle map", data.stage),
                           "wire the input to a stage fem.muscle_map");
  LimbMap out;
  out.stage = data.stage;
  out.variant = data.attributes.at("variant");
  out.load_arm_m = number(data, "load_arm_m");
  const data::Table& muscles = data.tables.at("muscles");
  for (std::size_t k = 0; k < muscles.rows(); ++k) {
    MappedMuscle m;
    m.name = muscles.texts("muscle")[k];
    m.flexor = muscles.texts("action")[k] == "flexor";
    m.map = muscle_map_of(data.tables.at("states"), m.name, out.variant);
    m.map.bounds = {number(data, "lower_rad"), number(data, "upper_rad"), number(data, "lower_activation"),
                    number(data, "upper_activation")};
    m.surrogate = std::make_shared<const fem::Surrogate>(
        make_map_surrogate(m.map, data.attributes.at("surrogate_method")));
    out.muscles.push_back(std::move(m));
  }
  return out;
}

fem::SurrogateModel model_of(const LimbMap& map, const std::string& method, const std::string& coordinate) {
  std::vector<fem::SurrogateMuscle> muscles;
  for (const MappedMuscle& m : map.muscles) {
    fem::SurrogateMuscle muscle{m.name, m.surrogate, "force_n", fem::MomentOutput{"moment_n_m"}};
    if (method != "virtual_work") muscle.arm = fem::ArmOutput{method + "_m", 1.0};
    muscles.push_back(std::move(muscle));
  }
  return fem::SurrogateModel(coordinate, std::move(muscles));
}

}  // namespace brachium::pipelines
