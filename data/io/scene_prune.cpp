#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <set>
#include <string>

#include "data/io/scene_parts.hpp"

namespace brachium::io::detail {
namespace {

using data::MuscleDrive;

// What the wanted quantities depend on.
struct Needed {
  std::set<std::string> coordinates;  ///< whose angle enters
  std::set<std::string> bodies;       ///< coordinates whose segments and loads enter
  std::set<std::string> muscles;      ///< whose force enters, or whose excitation another one's rule uses
};

bool is_descendant(const data::Scene& scene, const std::string& coordinate, const std::string& ancestor) {
  std::string at = coordinate;
  while (!at.empty()) {
    if (at == ancestor) return true;
    at = scene.coordinate(at).parent;
  }
  return false;
}

// A moment about a hinge holds what lies distal to it, and depends on the angles of all that lies proximal.
void need_coordinate(const data::Scene& scene, const std::string& name, Needed& needed) {
  for (const auto& c : scene.coordinates) {
    if (is_descendant(scene, c.name, name)) {
      needed.coordinates.insert(c.name);
      needed.bodies.insert(c.name);
    }
    if (is_descendant(scene, name, c.name)) needed.coordinates.insert(c.name);
  }
  for (const auto& m : scene.muscles) {
    if (m.path.coordinate == name) needed.muscles.insert(m.name);
  }
}

void need_muscle(const data::Scene& scene, const std::string& name, Needed& needed) {
  needed.muscles.insert(name);
  needed.coordinates.insert(scene.muscle(name).path.coordinate);
}

Needed needs_of(const data::Scene& scene) {
  Needed needed;
  for (const std::string& wanted : scene.wanted) {
    const std::string name = wanted.substr(0, wanted.rfind('.'));
    const bool coordinate = std::any_of(scene.coordinates.begin(), scene.coordinates.end(),
                                        [&](const auto& c) { return c.name == name; });
    coordinate ? need_coordinate(scene, name, needed) : need_muscle(scene, name, needed);
  }
  // Rules reach further muscles, whose own rules may reach others.
  for (bool grown = true; grown;) {
    grown = false;
    for (const auto& m : scene.muscles) {
      if (!needed.muscles.contains(m.name) || m.drive.kind != MuscleDrive::Kind::rule) continue;
      for (const std::string& source : m.drive.muscles) {
        if (needed.muscles.contains(source)) continue;
        need_muscle(scene, source, needed);
        grown = true;
      }
    }
  }
  return needed;
}

template <class Items, class Keep>
void keep_if(Items& items, const char* kind, data::Scene& scene, const Keep& keep) {
  for (const auto& item : items) {
    if (keep(item)) continue;
    scene.notes.push_back({data::Severity::note,
                           "left-out",
                           fmt::format("{} `{}` is left out: no wanted quantity ({}) depends on it", kind,
                                       item.name, fmt::join(scene.wanted, ", ")),
                           std::nullopt,
                           {}});
  }
  std::erase_if(items, [&](const auto& item) { return !keep(item); });
}

}  // namespace

void leave_out_unwanted(data::Scene& scene) {
  const Needed needed = needs_of(scene);
  const auto has_body = [&](const auto& body) { return needed.bodies.contains(body.coordinate); };
  keep_if(scene.muscles, "muscle", scene, [&](const auto& m) { return needed.muscles.contains(m.name); });
  keep_if(scene.segments, "segment", scene, has_body);
  keep_if(scene.loads, "load", scene, has_body);
  keep_if(scene.coordinates, "coordinate", scene,
          [&](const auto& c) { return needed.coordinates.contains(c.name); });
  for (const auto& m : scene.muscles) {
    if (m.drive.kind != MuscleDrive::Kind::undriven) continue;
    scene.notes.push_back(
        {data::Severity::note,
         "undriven-muscle",
         fmt::format("muscle `{}` has no drive and is modelled as passive: {}", m.name, m.drive.reason),
         std::nullopt,
         {}});
  }
}

}  // namespace brachium::io::detail
