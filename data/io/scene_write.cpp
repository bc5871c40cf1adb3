#include <fmt/format.h>

#include <numbers>
#include <string>
#include <vector>

#include "data/io/scene_file.hpp"

namespace brachium::io {
namespace {

// Twelve digits: so that 165 deg, which passed through radians, is written as 165 again.
double degrees(double radians) {
  return std::stod(fmt::format("{:.12g}", radians * 180.0 / std::numbers::pi));
}

void put(TomlNode& table, const char* key, const std::string& value) {
  table.member(key) = TomlNode::of(value);
}
void put(TomlNode& table, const char* key, double value) {
  table.member(key) = TomlNode::of(value);
}
void put_unless_zero(TomlNode& table, const char* key, double value) {
  if (value != 0.0) put(table, key, value);
}

TomlNode list_of(std::vector<TomlNode> items) {
  TomlNode list;
  list.kind = TomlNode::Kind::array;
  list.items = std::move(items);
  return list;
}

TomlNode coordinate_node(const data::Coordinate& c) {
  TomlNode t = TomlNode::table();
  put(t, "name", c.name);
  t.member("range_deg") = TomlNode::of(std::vector<double>{degrees(c.lower_rad), degrees(c.upper_rad)});
  put(t, "angle_signal", c.angle_signal);
  if (!c.parent.empty()) {
    put(t, "parent", c.parent);
    put(t, "distance_from_parent_m", c.distance_from_parent_m);
  }
  return t;
}

TomlNode segment_node(const data::Segment& s) {
  TomlNode t = TomlNode::table();
  put(t, "name", s.name);
  put(t, "coordinate", s.coordinate);
  // The fraction is kept where there is one: it ties the segments' uncertainties together.
  s.body_mass_fraction > 0.0 ? put(t, "mass_fraction_of_body", s.body_mass_fraction)
                             : put(t, "mass_kg", s.mass_kg);
  put_unless_zero(t, "mass_relative_sd", s.mass_relative_sd);
  put(t, "centre_of_mass_m", s.centre_of_mass_m);
  put_unless_zero(t, "centre_of_mass_sd_m", s.centre_of_mass_sd_m);
  put(t, "inertia_kg_m2", s.inertia_kg_m2);
  put_unless_zero(t, "inertia_relative_sd", s.inertia_relative_sd);
  put(t, "source", s.source);
  return t;
}

TomlNode load_node(const data::Load& l) {
  TomlNode t = TomlNode::table();
  put(t, "name", l.name);
  put(t, "coordinate", l.coordinate);
  l.mass_condition.empty() ? put(t, "mass_kg", l.mass_kg) : put(t, "mass_condition", l.mass_condition);
  put_unless_zero(t, "mass_relative_sd", l.mass_relative_sd);
  put(t, "distance_m", l.distance_m);
  put_unless_zero(t, "distance_sd_m", l.distance_sd_m);
  put(t, "source", l.source);
  return t;
}

TomlNode geometry_node(const data::PathGeometry& g) {
  TomlNode t = TomlNode::table();
  put(t, "coordinate", g.coordinate);
  const bool polynomial = g.kind == data::PathGeometry::Kind::polynomial;
  if (!polynomial) {
    std::vector<double> angles;
    for (const double q : g.angle_rad) angles.push_back(degrees(q));
    t.member("angle_deg") = TomlNode::of(std::move(angles));
  }
  if (!g.length_m.empty())
    t.member(polynomial ? "length_polynomial_m" : "length_m") = TomlNode::of(g.length_m);
  if (!g.moment_arm_m.empty())
    t.member(polynomial ? "moment_arm_polynomial_m" : "moment_arm_m") = TomlNode::of(g.moment_arm_m);
  if (g.reference_length_m > 0.0) {
    put(t, "reference_length_m", g.reference_length_m);
    put(t, "reference_angle_deg", degrees(g.reference_angle_rad));
  }
  put(t, "consistency_tolerance_m", g.consistency_tolerance_m);
  return t;
}

TomlNode drive_node(const data::MuscleDrive& d) {
  TomlNode t = TomlNode::table();
  switch (d.kind) {
    case data::MuscleDrive::Kind::channels:
      for (const auto& [channel, weight] : d.channels)
        t.member("channels").member(channel) = TomlNode::of(weight);
      break;
    case data::MuscleDrive::Kind::rule:
      t.member(d.rule) = TomlNode::of(d.muscles);
      break;
    case data::MuscleDrive::Kind::undriven:
      put(t, "none", d.reason);
      break;
  }
  return t;
}

TomlNode muscle_node(const data::SceneMuscle& m) {
  TomlNode t = TomlNode::table();
  put(t, "name", m.name);
  put(t, "group", m.group);
  put(t, "source", m.source);
  TomlNode& p = t.member("parameters");
  put(p, "max_isometric_force_N", m.parameters.max_isometric_force_N);
  put(p, "optimal_fibre_length_m", m.parameters.optimal_fibre_length_m);
  put(p, "tendon_slack_length_m", m.parameters.tendon_slack_length_m);
  put(p, "pennation_at_optimal_deg", degrees(m.parameters.pennation_at_optimal_rad));
  put(p, "max_contraction_velocity", m.parameters.max_contraction_velocity);
  put(p, "fibre_damping", m.parameters.fibre_damping);
  put(p, "strength", m.parameters.strength);
  TomlNode& a = t.member("activation");
  put(a, "delay_s", m.activation.delay_s);
  put(a, "time_constant_1_s", m.activation.time_constant_1_s);
  put(a, "time_constant_2_s", m.activation.time_constant_2_s);
  put(a, "shape", m.activation.shape);
  t.member("geometry") = geometry_node(m.path);
  t.member("drive") = drive_node(m.drive);
  return t;
}

}  // namespace

TomlNode scene_tree(const data::Scene& scene) {
  TomlNode root = TomlNode::table();
  TomlNode& header = root.member("scene");
  put(header, "title", scene.title);
  header.member("wanted") = TomlNode::of(scene.wanted);
  if (scene.body_mass_kg > 0.0) {
    put(header, "body_mass_kg", scene.body_mass_kg);
    put(header, "body_mass_source", scene.body_mass_source);
  }
  put_unless_zero(header, "body_mass_relative_sd", scene.body_mass_relative_sd);
  put(header, "upper_arm_inclination_deg", degrees(scene.upper_arm_inclination_rad));
  const auto add = [&root](const char* key, const auto& items, const auto& node_of) {
    if (items.empty()) return;
    std::vector<TomlNode> nodes;
    for (const auto& item : items) nodes.push_back(node_of(item));
    root.member(key) = list_of(std::move(nodes));
  };
  add("coordinate", scene.coordinates, coordinate_node);
  add("segment", scene.segments, segment_node);
  add("load", scene.loads, load_node);
  add("muscle", scene.muscles, muscle_node);
  return root;
}

std::string write_scene(const data::Scene& scene) {
  return write_toml(scene_tree(scene));
}

}  // namespace brachium::io
