#pragma once
/// A scene: what is modelled. Joint coordinates, rigid segments, muscles and their drive, loads, and what is wanted.

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "data/model/error.hpp"
#include "data/model/muscle.hpp"

namespace brachium::data {

/// One entry of q.
struct Coordinate {
  std::string name;
  double lower_rad = 0.0;  ///< range the scene's geometry is valid for
  double upper_rad = 0.0;
  std::string angle_signal;  ///< signal of a session that records it (default: the coordinate's name)
  std::string parent;        ///< proximal neighbour in a planar chain of hinges; empty: fixed to the ground
  double distance_from_parent_m = 0.0;  ///< from the parent's hinge to this one, along the parent's segment
};

/// A rigid segment distal to a hinge, described along its long axis from the joint.
struct Segment {
  std::string name;
  std::string coordinate;         ///< hinge it rotates about
  double mass_kg = 0.0;           ///< > 0; resolved from the body-mass fraction where the scene gives one
  double mass_relative_sd = 0.0;  ///< relative standard uncertainty of the mass
  double centre_of_mass_m = 0.0;  ///< distance from the joint along the segment
  double inertia_kg_m2 = 0.0;     ///< about the centre of mass, about the hinge axis
  std::string source;
  double body_mass_fraction =
      0.0;  ///< mass_kg / body mass where the scene gives that; 0: mass given by itself
  double centre_of_mass_sd_m = 0.0;  ///< standard uncertainty
  double inertia_relative_sd = 0.0;  ///< relative standard uncertainty
};

/// A mass or force held by a segment.
struct Load {
  std::string name;
  std::string coordinate;
  double mass_kg = 0.0;        ///< fixed mass, or ...
  std::string mass_condition;  ///< ... the trial condition it is read from ("load_mass_kg")
  double mass_relative_sd = 0.0;
  double distance_m = 0.0;  ///< from the joint along the segment
  double distance_sd_m = 0.0;
  std::string source;
};

struct SceneMuscle {
  std::string name;
  std::string group;  ///< strength group; the muscle's own name where none is given
  MuscleParameters parameters;
  ActivationParameters activation;
  PathGeometry path;
  MuscleDrive drive;
  std::string source;
};

struct Scene {
  std::string title;
  std::string file;                 ///< where it was read from
  std::vector<std::string> wanted;  ///< wanted quantities, e.g. "elbow_flexion.moment"
  double body_mass_kg = 0.0;        ///< assumed or measured; 0 where not needed
  double body_mass_relative_sd =
      0.0;  ///< relative standard uncertainty, shared by all fractions of the body mass
  std::string body_mass_source;
  double upper_arm_inclination_rad = 0.0;  ///< from vertical, used only where no orientation is recorded
  std::vector<Coordinate> coordinates;
  std::vector<Segment> segments;
  std::vector<Load> loads;
  std::vector<SceneMuscle> muscles;
  std::vector<Diagnostic> notes;  ///< warnings and what was left out of the model, and why

  const Coordinate& coordinate(const std::string& name) const;  ///< throws InputError("missing-coordinate")
  const SceneMuscle& muscle(const std::string& name) const;     ///< throws InputError("missing-muscle")
};

}  // namespace brachium::data
