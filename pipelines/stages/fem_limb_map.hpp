#pragma once
/// The output of fem.muscle_map as later stages use it: surrogates of the limb's muscles, with what they
/// belong to.

#include <memory>
#include <string>
#include <vector>

#include "fem/surrogate/surrogate_model.hpp"
#include "pipelines/stage.hpp"
#include "pipelines/stages/fem_map_table.hpp"

namespace brachium::pipelines {

/// Where a muscle's moment comes from: "virtual_work" (of the reactions on the end's motion), "tdm", "vrla",
/// "vrla_plus".
const std::vector<std::string>& moment_methods();
std::string moment_method_words(const std::string& method);  ///< "tendon displacement (TDM)", ...

struct MappedMuscle {
  std::string name;
  bool flexor = true;
  fem::MuscleMap map;
  std::shared_ptr<const fem::Surrogate>
      surrogate;  ///< outputs force_n, moment_n_m, tdm_m, vrla_m, vrla_plus_m, ...
};

struct LimbMap {
  std::string stage, variant;
  double load_arm_m = 0.0;  ///< 0: none
  std::vector<MappedMuscle> muscles;
};

/// Outputs that every state has, force and moment first.
std::vector<fem::MapOutput> outputs_of(const fem::MuscleMap& map);

/// `method`: "hermite" (by the exact slopes of force and moment), "cubic", "quintic", "sparse_included",
/// "sparse_modified". Throws InputError as the makers of
/// surrogates do: "missing-derivative", "not-a-grid" naming a state that is missing or failed.
fem::Surrogate make_map_surrogate(const fem::MuscleMap& map, const std::string& method);

/// Throws InputError("not-a-muscle-map") where the stage left no map, and as make_map_surrogate.
LimbMap limb_map_of(const StageData& data);

/// The limb's muscles as a model over one coordinate, each with its moment by the method.
fem::SurrogateModel model_of(const LimbMap& map, const std::string& method, const std::string& coordinate);

}  // namespace brachium::pipelines
