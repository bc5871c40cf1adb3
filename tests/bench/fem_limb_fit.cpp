// Fits the two muscles of the generic arm to the published forces of the Upper Limb Model, stage by stage,
// with the one-dimensional strap beside it.
//
//   fem_limb_fit FORCES.csv [biceps|triceps|both [belly_cells core_cells ring_cells [first_stage
//   [name=lower:upper | name=value ...]]]]
//
// The continuum is fitted from `first_stage` (1 ... 4) on, each time from the strap's result. A name with
// bounds is free between them, one with a value is held at it. FORCES.csv: columns theta_deg, alpha, FT_N,
// FB_N; lines that begin with # are skipped. Passive and maximal forces at seven angles come from
// fem/limb/published.hpp.

#include <fmt/format.h>

#include <cmath>
#include <cstdlib>
#include <fstream>
#include <iostream>
#include <map>
#include <numbers>
#include <sstream>
#include <tuple>

#include "fem/limb/body_parameters.hpp"
#include "fem/limb/published.hpp"
#include "fem/limb/strap.hpp"
#include "fem/limb/upper_limb.hpp"
#include "optimise/muscle_force_fit.hpp"
#include "optimise/verdicts.hpp"

namespace {

using namespace brachium;
using namespace brachium::optimise;

constexpr double degree = std::numbers::pi / 180.0;

std::vector<ReferenceForce> references(const std::string& file, bool biceps) {
  std::vector<ReferenceForce> out;
  std::ifstream in(file);
  for (std::string line; std::getline(in, line);) {
    if (line.empty() || line[0] == '#' || line[0] == 't') continue;
    double v[4] = {};
    char comma = 0;
    std::istringstream row(line);
    row >> v[0] >> comma >> v[1] >> comma >> v[2] >> comma >> v[3];
    const bool imputed = v[0] == 141.25 && v[1] == 0.5;
    out.push_back({v[0] * degree, v[1], biceps ? -v[3] : v[2], imputed ? 0.0 : 1.0, "samples"});
  }
  if (out.empty()) throw std::runtime_error("no forces in " + file);
  for (const fem::PublishedForce& f : fem::published_forces()) {
    // The passive triceps' force falls from 115 to 150 deg while its path lengthens: no elastic strap does.
    const double weight = !biceps && f.q_rad > 149.0 * degree ? 0.0 : 1.0;
    out.push_back({f.q_rad, f.activation, biceps ? f.biceps_n : f.triceps_n, weight,
                   f.activation == 0.0 ? "passive" : "maximal"});
  }
  return out;
}

void print(const std::string& what, const std::vector<ReferenceForce>& refs, const MuscleForceFit& fit) {
  fmt::print("  {}: {}\n", what, fit.summary.message());
  std::fflush(stdout);
  for (const ForceAgreement& a : agreement(refs, fit.force_n))
    fmt::print(
        "    {:<22} {:2d} states: relative L2 {:6.2f} %, rms {:6.2f} N, worst {:+7.1f} N at {:.1f} deg, "
        "{:.4g}\n",
        a.set, static_cast<int>(a.states), 100.0 * a.relative_l2, a.rms_n, a.worst_n, a.worst_q_rad / degree,
        a.worst_activation);
  data::Subject subject;
  subject.verdicts = fit.verdicts;
  std::istringstream lines(verdict_text(subject));
  for (std::string line; std::getline(lines, line);) fmt::print("      {}\n", line);
}

void passive_and_active(const std::vector<ReferenceForce>& refs, const Eigen::VectorXd& force) {
  fmt::print("    deg   passive N  published   active share N  published\n");
  for (std::size_t i = 0; i < refs.size(); ++i) {
    for (std::size_t k = 0; k < refs.size(); ++k) {
      if (refs[i].set != "passive" || refs[k].set != "maximal" || refs[i].q_rad != refs[k].q_rad) continue;
      const auto a = static_cast<Eigen::Index>(i), b = static_cast<Eigen::Index>(k);
      fmt::print("  {:5.0f} {:10.1f} {:10.1f} {:15.1f} {:11.1f}\n", refs[i].q_rad / degree, force[a],
                 refs[i].force_n, force[b] - force[a], refs[k].force_n - refs[i].force_n);
    }
  }
}

using Bounds = std::map<std::string, std::pair<double, double>>;

Bounds bounds_from(int argc, char** argv, int first) {
  Bounds bounds;
  for (int i = first; i < argc; ++i) {
    const std::string text = argv[i];
    const auto equal = text.find('='), colon = text.find(':');
    if (equal == std::string::npos) throw std::runtime_error("neither bounds nor a value: " + text);
    const std::string last = text.substr((colon == std::string::npos ? equal : colon) + 1);
    bounds[text.substr(0, equal)] = {std::stod(text.substr(equal + 1)), std::stod(last)};
  }
  return bounds;
}

void study(const std::string& file, const fem::UpperLimb& arm, bool biceps, int first_stage,
           const Bounds& bounds) {
  const auto refs = references(file, biceps);
  const auto strap = strap_force_model();
  ContinuumForceOptions continuum_options;
  continuum_options.range = arm.range;
  continuum_options.hinge = arm.hinge;
  continuum_options.bones = arm.humerus;
  const auto continuum = continuum_force_model(continuum_options);
  std::vector<FreeBodyParameter> free;
  fem::MuscleBody strap_body = biceps ? arm.biceps : arm.triceps;
  for (const auto& [name, values] : bounds)
    if (values.first == values.second) fem::set_body_value(strap_body, name, values.first);
  const std::vector<std::pair<std::string, std::vector<std::string>>> stages{
      {"geometry", {"belly_length_m", "greatest_radius_m", "pre_stretch"}},
      {"geometry and passive fibres", {"passive_stretch", "passive_exponent"}},
      {"geometry, passive fibres and active bell",
       {"optimal_stretch", "ascending_width", "descending_width"}},
      {"geometry, passive fibres, active bell and its exponents",
       {"ascending_exponent", "descending_exponent"}}};
  int stage = 0;
  for (const auto& [name, added] : stages) {
    for (const std::string& p : added) {
      FreeBodyParameter f{p};
      if (const auto given = bounds.find(p); given != bounds.end())
        std::tie(f.lower, f.upper) = given->second;
      if (f.lower == f.upper) continue;
      if (std::isfinite(f.lower))
        fem::set_body_value(strap_body, p, std::clamp(fem::body_value(strap_body, p), f.lower, f.upper));
      free.push_back(f);
      if (p != "passive_stretch") continue;
      fem::set_body_value(strap_body, "passive_stretch", 1.4);
      if (!bounds.contains("passive_exponent")) fem::set_body_value(strap_body, "passive_exponent", 5.0);
    }
    fmt::print("{}, free: {}\n", biceps ? "biceps" : "triceps", name);
    SolveOptions o;
    o.starts = 8;
    const MuscleForceFit s = fit_muscle_forces(strap_body, free, refs, *strap, o);
    strap_body = s.body;
    print("strap", refs, s);
    if (++stage < first_stage) continue;
    SolveOptions c;
    c.max_iterations = 12;
    c.cost_tolerance = 1e-4;
    c.progress = [](const Iteration& i) { fmt::print(stderr, "{}\n", log_row(i)); };
    const MuscleForceFit f = fit_muscle_forces(s.body, free, refs, *continuum, c);
    print("continuum", refs, f);
    passive_and_active(refs, f.force_n);
  }
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) {
    std::cerr << "usage: fem_limb_fit FORCES.csv [biceps|triceps|both [belly_cells core_cells ring_cells "
                 "[first_stage "
                 "[name=lower:upper | name=value ...]]]]\n";
    return 2;
  }
  const std::string which = argc > 2 ? argv[2] : "both";
  fem::LimbMesh mesh;
  if (argc > 5) mesh = {std::atoi(argv[3]), std::atoi(argv[4]), std::atoi(argv[5])};
  const int first_stage = argc > 6 ? std::atoi(argv[6]) : 1;
  try {
    const fem::UpperLimb arm = fem::generic_arm(mesh);
    const Bounds bounds = bounds_from(argc, argv, 7);
    if (which != "triceps") study(argv[1], arm, true, first_stage, bounds);
    if (which != "biceps") study(argv[1], arm, false, first_stage, bounds);
  } catch (const std::exception& e) {
    std::cerr << e.what() << '\n';
    return 1;
  }
}
