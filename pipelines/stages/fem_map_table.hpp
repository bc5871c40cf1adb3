#pragma once
/// A muscle map as tables: one row a state, with everything that was read off it; and the way back.
///
/// | table         | rows                                                              |
/// |---------------|-------------------------------------------------------------------|
/// | states        | states of all muscles, by muscle, angle, activation               |
/// | contacts      | states by bone that is modelled                                   |
/// | fibre_stretch | states by interval of fibre stretch: its share of the muscle      |

#include <limits>
#include <string>
#include <vector>

#include "data/model/table.hpp"
#include "fem/limb/solve_map.hpp"
#include "fem/surrogate/surrogate.hpp"

namespace brachium::pipelines {

struct MapRow {
  std::string muscle;
  fem::SolvedMuscle reading;
  bool asked = true;  ///< else solved for the passive lengths only
  double stretch_deviation = 0.0;
  double contact_force_n = 0.0;  ///< sum over the bones
  double greatest_pressure_pa = 0.0, greatest_penetration_m = 0.0;
  double tdm_m = std::numeric_limits<double>::quiet_NaN();
  std::string outcome;  ///< "stable", "unstable", "not checked", "failed: ..." (then without figures)
};

MapRow map_row(const std::string& muscle, const fem::MapState& state);
MapRow failed_row(const std::string& muscle, const fem::FailedState& failed);

/// Sorted by muscle (in their order of appearance), angle, activation.
data::Table map_table(const std::vector<MapRow>& rows);
std::vector<MapRow> map_rows(const data::Table& table);

data::Table contact_rows(const std::string& muscle, const fem::MapState& state);
/// Intervals of .02; shares by reference volume of muscle tissue.
data::Table stretch_rows(const std::string& muscle, const fem::MapState& state);

/// Gives every row its lever arm by tendon displacement, from the passive states of its muscle.
void add_tendon_displacement(std::vector<MapRow>& rows);

/// One muscle of the table `states`. Throws InputError("missing-muscle") with the nearest name.
fem::MuscleMap muscle_map_of(const data::Table& states, const std::string& muscle,
                             const std::string& variant);
std::vector<std::string> muscles_of(const data::Table& states);

}  // namespace brachium::pipelines
