#include "data/model/scene.hpp"

#include <fmt/format.h>

#include "data/model/subject.hpp"

namespace brachium::data {
namespace {

template <class Items>
const auto& find(const Items& items, const std::string& wanted, const char* code, const std::string& what) {
  std::vector<std::string> known;
  for (const auto& item : items) {
    if (item.name == wanted) return item;
    known.push_back(item.name);
  }
  throw InputError(code, fmt::format("{} `{}`", what, wanted), suggest(wanted, known));
}

}  // namespace

const Coordinate& Scene::coordinate(const std::string& name) const {
  return find(coordinates, name, "missing-coordinate", "the scene has no coordinate");
}

const SceneMuscle& Scene::muscle(const std::string& name) const {
  return find(muscles, name, "missing-muscle", "the scene has no muscle");
}

const SubjectMuscle& Subject::muscle(const std::string& wanted) const {
  return find(muscles, wanted, "missing-muscle", fmt::format("subject `{}` has no muscle", name));
}

}  // namespace brachium::data
