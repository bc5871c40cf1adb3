#pragma once
/// The single questions that check(problem) asks.

#include <string>
#include <vector>

#include "fem/solve/holds.hpp"

namespace brachium::fem {

/// Mistakes found so far.
struct Findings {
  std::vector<data::Diagnostic> list;
  bool conditions_sound = true;  ///< every condition is understood, and so is every release

  void error(std::string code, std::string message, std::string help) {
    list.push_back(
        {data::Severity::error, std::move(code), std::move(message), std::nullopt, std::move(help)});
  }
  void warning(std::string code, std::string message, std::string help) {
    list.push_back(
        {data::Severity::warning, std::move(code), std::move(message), std::nullopt, std::move(help)});
  }
  void add(const data::InputError& e) {
    list.insert(list.end(), e.diagnostics().begin(), e.diagnostics().end());
  }
  bool any_error() const {
    for (const data::Diagnostic& d : list) {
      if (d.severity == data::Severity::error) return true;
    }
    return false;
  }
};

/// One material a region, parameters in range, bulk moduli that the formulation can take.
void check_materials(const Problem& problem, Findings& found);
/// Sizes of the fields at quadrature points; unit fibres where a law needs them; blending in [0, 1].
void check_tissue(const Problem& problem, Findings& found);
/// Names, surfaces, values. Returns what each condition holds.
std::vector<std::vector<Hold>> check_conditions(const Problem& problem, Findings& found);
/// Phases: known names, values in range, something that changes, releases of constraints that still hold.
void check_programme(const Problem& problem, Findings& found);

}  // namespace brachium::fem
