/// Fibre fields and blending of fem.solve.

#include <fmt/format.h>

#include <numbers>

#include "fem/fibre/tissue.hpp"
#include "pipelines/stages/fem_problem.hpp"

namespace brachium::pipelines {
namespace {

std::optional<fem::Pennation> pennation(const Options& entry, const std::string& owner, Mistakes& mistakes) {
  if (!entry.has("pennation_deg") && !entry.has("pennation_axis")) return std::nullopt;
  const std::string beside = "the two go together";
  mistakes.need(entry, "pennation_deg", owner, beside);
  mistakes.need(entry, "pennation_axis", owner, beside);
  return fem::Pennation{entry.maybe_number("pennation_deg").value_or(0.0) * std::numbers::pi / 180.0,
                        vector_of(entry, "pennation_axis")};
}

fem::FibreRule fibre_rule(const Options& entry, const data::Mesh& mesh, const std::string& owner,
                          Mistakes& mistakes) {
  const std::string kind = entry.text("kind");
  fem::FibreRule rule;
  if (entry.has("regions")) rule.regions = regions_of(entry, mesh, owner);
  std::vector<std::string> keys{"regions", "kind"};
  if (kind == "constant") {
    keys.push_back("direction");
    mistakes.need(entry, "direction", owner);
    rule.source = fem::ConstantFibres{vector_of(entry, "direction")};
  } else if (kind == "mesh_field") {
    keys.push_back("field");
    mistakes.need(entry, "field", owner);
    rule.source = fem::MeshFieldFibres{entry.maybe_text("field").value_or("")};
  } else if (kind == "mesh_lines") {
    keys.push_back("axis");
    mistakes.need(entry, "axis", owner);
    const std::string axis = entry.maybe_text("axis").value_or("first");
    rule.source = fem::MeshLineFibres{axis == "second" ? 1 : axis == "third" ? 2 : 0};
  } else {
    keys.insert(keys.end(), {"origin", "insertion", "pennation_deg", "pennation_axis"});
    mistakes.need(entry, "origin", owner);
    mistakes.need(entry, "insertion", owner);
    rule.source =
        fem::HarmonicFibres{entry.maybe_text("origin").value_or(""),
                            entry.maybe_text("insertion").value_or(""), pennation(entry, owner, mistakes)};
  }
  mistakes.only_keys(entry, keys, owner);
  return rule;
}

fem::FractionRule fraction_rule(const Options& entry, const data::Mesh& mesh, const std::string& owner,
                                Mistakes& mistakes) {
  fem::FractionRule rule;
  if (entry.has("regions")) rule.regions = regions_of(entry, mesh, owner);
  if (entry.has("value") == entry.has("field"))
    mistakes.error(entry, "missing-option", owner + " needs either `value` or `field`");
  if (const auto field = entry.maybe_text("field"))
    rule.source = *field;
  else
    rule.source = entry.maybe_number("value").value_or(0.0);
  return rule;
}

/// A rule, and the entry of the definition that it comes from.
struct Part {
  const Options* entry;
  std::string owner;
  fem::TissueRules rule;
};

std::vector<Part> parts_of(const Options& options, const data::Mesh& mesh, Mistakes& mistakes) {
  std::vector<Part> parts;
  int k = 0;
  for (const Options& entry : options.tables("fibre")) {
    const std::string owner = fmt::format("entry {} of `fibre` (kind {})", ++k, entry.text("kind"));
    mistakes.guarded(entry, "", [&] {
      parts.push_back({&entry, owner, {{fibre_rule(entry, mesh, owner, mistakes)}, {}, {}}});
    });
  }
  k = 0;
  for (const Options& entry : options.tables("blend")) {
    const std::string owner = fmt::format("entry {} of `blend`", ++k);
    mistakes.guarded(entry, "", [&] {
      Part part{&entry, owner, {}};
      (entry.text("of") == "muscle" ? part.rule.muscle
                                    : part.rule.soft_tissue) = {fraction_rule(entry, mesh, owner, mistakes)};
      parts.push_back(std::move(part));
    });
  }
  return parts;
}

}  // namespace

bool fem_tissue(const Options& options, const data::Mesh& mesh, fem::Formulation formulation,
                Mistakes& mistakes, fem::TissueField& field, data::Table& directions) {
  const std::size_t before = mistakes.size();
  const std::vector<Part> parts = parts_of(options, mesh, mistakes);
  if (mistakes.size() != before) return false;
  fem::TissueRules rules;
  for (const Part& part : parts) {
    rules.fibres.insert(rules.fibres.end(), part.rule.fibres.begin(), part.rule.fibres.end());
    rules.muscle.insert(rules.muscle.end(), part.rule.muscle.begin(), part.rule.muscle.end());
    rules.soft_tissue.insert(rules.soft_tissue.end(), part.rule.soft_tissue.begin(),
                             part.rule.soft_tissue.end());
  }
  try {
    fem::Tissue built = fem::build_tissue(mesh, formulation, rules);
    field = std::move(built.field);
    directions = std::move(built.directions);
    return true;
  } catch (const data::InputError& e) {
    // Which rules are wrong by themselves? Where none is, they contradict each other.
    for (const Part& part : parts)
      mistakes.guarded(*part.entry, part.owner + ": ",
                       [&] { fem::build_tissue(mesh, formulation, part.rule); });
    if (mistakes.size() == before) mistakes.take(e, *parts.back().entry);
    return false;
  }
}

}  // namespace brachium::pipelines
