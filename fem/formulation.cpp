#include "fem/formulation.hpp"

#include <array>

namespace brachium::fem {
namespace {

struct Entry {
  Formulation formulation;
  const char* name;
  data::CellType cell;
  PressureSpace pressure;
};

constexpr std::array<Entry, 7> entries{{
    {Formulation::q2_p1_discontinuous, "q2_p1_discontinuous", data::CellType::hex27,
     PressureSpace::linear_discontinuous},
    {Formulation::q2_q1_taylor_hood, "q2_q1_taylor_hood", data::CellType::hex27, PressureSpace::continuous},
    {Formulation::q1_p0, "q1_p0", data::CellType::hex8, PressureSpace::constant},
    {Formulation::p2_p1_taylor_hood, "p2_p1_taylor_hood", data::CellType::tet10, PressureSpace::continuous},
    {Formulation::p2b_p1_discontinuous, "p2b_p1_discontinuous", data::CellType::tet10,
     PressureSpace::linear_discontinuous},
    {Formulation::q1_displacement, "q1_displacement", data::CellType::hex8, PressureSpace::none},
    {Formulation::q2_displacement, "q2_displacement", data::CellType::hex27, PressureSpace::none},
}};

const Entry& entry(Formulation formulation) {
  return entries.at(static_cast<std::size_t>(formulation));
}

}  // namespace

data::CellType cell_type(Formulation formulation) {
  return entry(formulation).cell;
}
PressureSpace pressure_space(Formulation formulation) {
  return entry(formulation).pressure;
}
bool has_bubble(Formulation formulation) {
  return formulation == Formulation::p2b_p1_discontinuous;
}
std::string to_string(Formulation formulation) {
  return entry(formulation).name;
}

Formulation formulation_named(const std::string& name) {
  for (const Entry& e : entries) {
    if (name == e.name) return e.formulation;
  }
  throw data::InputError("unknown-formulation", "there is no finite element named `" + name + "`",
                         data::suggest(name, formulation_names()));
}

const std::vector<std::string>& formulation_names() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> list;
    for (const Entry& e : entries) list.emplace_back(e.name);
    return list;
  }();
  return names;
}

}  // namespace brachium::fem
