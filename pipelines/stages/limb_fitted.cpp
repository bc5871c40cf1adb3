#include "pipelines/stages/limb_fitted.hpp"

#include <fmt/format.h>

#include "fem/limb/body_parameters.hpp"
#include "pipelines/stages/common.hpp"

namespace brachium::pipelines {

data::Table fitted_table(const std::vector<fem::MuscleBody>& bodies,
                         const std::vector<std::string>& parameters) {
  TableBuilder table("fitted");
  table.text("muscle").text("parameter").text("unit").number("value", "SI");
  for (const fem::MuscleBody& body : bodies) {
    for (const std::string& name : parameters) {
      std::string unit;
      for (const fem::BodyParameter& p : fem::body_parameters())
        if (p.name == name) unit = p.unit;
      table.row({body.name, name, unit, fem::body_value(body, name)});
    }
  }
  return table.take();
}

void apply_fitted(const StageData& fitted, LimbScene& limb) {
  if (!fitted.tables.contains("fitted"))
    throw data::InputError("missing-table", fmt::format("stage `{}` left no fitted parameters", fitted.stage),
                           "wire the input to a stage optimise.muscle_forces");
  const data::Table& table = fitted.tables.at("fitted");
  for (const std::string& name : table.texts("muscle")) limb.muscle(name);  // throws where there is none
  for (LimbMuscle& m : limb.muscles) {
    std::vector<std::pair<std::string, double>> values;
    for (std::size_t i = 0; i < table.rows(); ++i) {
      if (table.texts("muscle")[i] == m.body.name)
        values.emplace_back(table.texts("parameter")[i], table.numbers("value")[i]);
    }
    fem::set_body_values(m.body, values);
  }
  for (const LimbMuscle& m : limb.muscles) fem::check(m.body, limb.range);
}

}  // namespace brachium::pipelines
