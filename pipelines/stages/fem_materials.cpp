/// Materials of fem.solve: named sets, laws with their parameters, resistance to change of volume.

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <limits>

#include "fem/material/material.hpp"
#include "fem/material/parameter_sets.hpp"
#include "pipelines/stages/common.hpp"
#include "pipelines/stages/fem_problem.hpp"

namespace brachium::pipelines {
namespace {

using data::InputError;

const std::vector<std::string> kCommon{"regions", "law", "incompressible", "bulk_modulus_pa",
                                       "volumetric_law"};
const std::vector<std::string> kForceLength{"optimal_stretch", "ascending_width", "ascending_exponent",
                                            "descending_width", "descending_exponent"};

/// A parameter by its key, where it is stored and how it is called in the report.
struct Parameter {
  std::string key;
  double* value;
};

std::string source_of(const std::string& set) {
  for (const auto& s : fem::muscle_tendon_sets())
    if (s.name == set) return s.source;
  for (const auto& s : fem::fibrous_tissue_sets())
    if (s.name == set) return s.source;
  for (const auto& s : fem::force_length_sets())
    if (s.name == set) return s.source;
  return {};
}

class Reader {
 public:
  Reader(const Options& entry, const std::string& owner, bool blended, Mistakes& mistakes)
      : entry_(entry), owner_(owner), blended_(blended), mistakes_(mistakes) {}

  std::string law() const { return entry_.maybe_text("law").value_or("muscle_tendon"); }
  const std::vector<std::string>& sources() const { return sources_; }
  std::string parameters() const { return parameters_; }

  std::optional<fem::RegionMaterial> read() {
    if (!entry_.has("law") && !entry_.has("set")) {
      error("missing-option", fmt::format("{} names neither a `set` nor a `law`", owner_),
            "for example set = \"sprenger\"");
      return std::nullopt;
    }
    fem::RegionMaterial out{};
    const std::string name = law();
    if (name == "muscle_tendon")
      out.material = muscle_tendon();
    else if (name == "neo_hooke")
      out.material = neo_hooke();
    else if (name == "mooney_rivlin")
      out.material = mooney_rivlin();
    else if (name == "fung_guccione")
      out.material = fung();
    else
      out.material = blemker();
    volumetric(out.volumetric);
    if (!good_) return std::nullopt;
    if (!mistakes_.guarded(entry_, owner_ + ": ", [&] { fem::check(out.material); })) return std::nullopt;
    return out;
  }

 private:
  void error(const char* code, std::string message, std::string help = {}) {
    good_ = false;
    mistakes_.error(entry_, code, std::move(message), std::move(help));
  }

  void show(const std::string& key, double value) {
    parameters_ += fmt::format("{}{} {:g}", parameters_.empty() ? "" : ", ", key, value);
  }

  /// Values that are given; then, unless a set gave them, all must be there.
  void fill(const std::vector<Parameter>& parameters, bool needed) {
    std::vector<std::string> missing;
    for (const Parameter& p : parameters) {
      if (const auto value = entry_.maybe_number(p.key)) *p.value = *value;
      if (std::isnan(*p.value))
        missing.push_back("`" + p.key + "`");
      else
        show(p.key, *p.value);
    }
    if (needed && !missing.empty())
      error("missing-option", fmt::format("{}: the law {} needs {}", owner_, law(), fmt::join(missing, ", ")),
            "no parameter has a default: give it, or a named set");
  }

  void use_set(const std::string& key, const auto& take) {
    const auto name = entry_.maybe_text(key);
    if (!name) return;
    if (mistakes_.guarded(entry_, "", [&] { take(*name); }))
      sources_.push_back(fmt::format("`{}`: {}", *name, source_of(*name)));
    else
      good_ = false;
  }

  void allow(std::vector<std::string> keys) {
    keys.insert(keys.end(), kCommon.begin(), kCommon.end());
    const std::size_t before = mistakes_.size();
    mistakes_.only_keys(entry_, keys, fmt::format("{} (law {})", owner_, law()));
    good_ = good_ && mistakes_.size() == before;
  }

  fem::MuscleTendon muscle_tendon() {
    std::vector<std::string> keys{
        "set",      "muscle_set",    "tendon_set",     "force_length_set",         "max_stress_pa",
        "blending", "active_stress", "max_rate_per_s", "force_velocity_curvature", "eccentric_force"};
    keys.insert(keys.end(), kForceLength.begin(), kForceLength.end());
    for (const std::string tissue : {"muscle_", "tendon_"}) {
      for (const std::string c : {"c1_pa", "c2_pa", "c3_pa", "c4"}) keys.push_back(tissue + c);
    }
    allow(keys);
    fem::MuscleTendon m;
    use_set("set", [&](const std::string& name) { m = fem::muscle_tendon_named(name); });
    use_set("muscle_set", [&](const std::string& name) { m.muscle = fem::fibrous_tissue_named(name); });
    use_set("tendon_set", [&](const std::string& name) { m.tendon = fem::fibrous_tissue_named(name); });
    use_set("force_length_set", [&](const std::string& name) {
      m.force_length = fem::force_length_named(
          name,
          entry_.maybe_number("optimal_stretch")
              .value_or(std::isnan(m.force_length.optimal_stretch) ? 1.0 : m.force_length.optimal_stretch));
      if (!entry_.has("optimal_stretch") && !entry_.has("set"))
        error("missing-option", fmt::format("{} needs `optimal_stretch` beside `force_length_set`", owner_));
    });
    if (!good_) return m;
    fill({{"muscle_c1_pa", &m.muscle.c1_pa},
          {"muscle_c2_pa", &m.muscle.c2_pa},
          {"muscle_c3_pa", &m.muscle.c3_pa},
          {"muscle_c4", &m.muscle.c4}},
         true);
    const bool tendon = entry_.has("set") || entry_.has("tendon_set") || entry_.has("tendon_c1_pa") ||
                        entry_.has("tendon_c2_pa") || entry_.has("tendon_c3_pa") || entry_.has("tendon_c4");
    if (tendon || blended_) {
      fill({{"tendon_c1_pa", &m.tendon.c1_pa},
            {"tendon_c2_pa", &m.tendon.c2_pa},
            {"tendon_c3_pa", &m.tendon.c3_pa},
            {"tendon_c4", &m.tendon.c4}},
           true);
    } else {
      m.tendon = m.muscle;  // gamma_M is 1 wherever nothing blends: the tendon has no weight
    }
    fill({{"max_stress_pa", &m.max_stress_pa},
          {"optimal_stretch", &m.force_length.optimal_stretch},
          {"ascending_width", &m.force_length.ascending_width},
          {"ascending_exponent", &m.force_length.ascending_exponent},
          {"descending_width", &m.force_length.descending_width},
          {"descending_exponent", &m.force_length.descending_exponent}},
         true);
    if (const auto blending = entry_.maybe_text("blending"))
      m.blending = *blending == "parameters" ? fem::Blending::parameters : fem::Blending::energies;
    if (const auto active = entry_.maybe_text("active_stress"))
      m.active_stress = *active == "cauchy" ? fem::ActiveStress::cauchy : fem::ActiveStress::nominal;
    const bool rate = entry_.has("max_rate_per_s") || entry_.has("force_velocity_curvature") ||
                      entry_.has("eccentric_force");
    m.rate_dependent = m.rate_dependent || rate;
    if (rate)
      fill({{"max_rate_per_s", &m.force_velocity.max_rate_per_s},
            {"force_velocity_curvature", &m.force_velocity.curvature},
            {"eccentric_force", &m.force_velocity.eccentric_force}},
           true);
    parameters_ += fmt::format(", active stress {}",
                               m.active_stress == fem::ActiveStress::cauchy ? "cauchy" : "nominal");
    return m;
  }

  fem::NeoHooke neo_hooke() {
    allow({"shear_modulus_pa", "isochoric"});
    fem::NeoHooke m;
    fill({{"shear_modulus_pa", &m.shear_modulus_pa}}, true);
    m.isochoric = isochoric();
    return m;
  }

  fem::MooneyRivlin mooney_rivlin() {
    allow({"c10_pa", "c01_pa", "isochoric"});
    fem::MooneyRivlin m;
    fill({{"c10_pa", &m.c10_pa}, {"c01_pa", &m.c01_pa}}, true);
    m.isochoric = isochoric();
    return m;
  }

  fem::FungGuccione fung() {
    allow({"stiffness_pa", "bf", "bt", "bfs", "isochoric"});
    fem::FungGuccione m;
    fill({{"stiffness_pa", &m.stiffness_pa}, {"bf", &m.bf}, {"bt", &m.bt}, {"bfs", &m.bfs}}, true);
    m.isochoric = isochoric();
    return m;
  }

  fem::BlemkerMuscle blemker() {
    allow({"along_fibre_shear_pa", "cross_fibre_shear_pa", "passive_coefficient", "passive_exponent",
           "optimal_stretch", "max_stress_pa", "straightening_stretch"});
    fem::BlemkerMuscle m;
    fill({{"along_fibre_shear_pa", &m.along_fibre_shear_pa},
          {"cross_fibre_shear_pa", &m.cross_fibre_shear_pa},
          {"passive_coefficient", &m.passive_coefficient},
          {"passive_exponent", &m.passive_exponent},
          {"optimal_stretch", &m.optimal_stretch},
          {"max_stress_pa", &m.max_stress_pa},
          {"straightening_stretch", &m.straightening_stretch}},
         true);
    return m;
  }

  bool isochoric() const { return entry_.has("isochoric") && entry_.boolean("isochoric"); }

  void volumetric(fem::Volumetric& out) {
    const bool incompressible = entry_.has("incompressible") && entry_.boolean("incompressible");
    const auto bulk = entry_.maybe_number("bulk_modulus_pa");
    if (incompressible == bulk.has_value())
      error("missing-option", fmt::format("{} needs {} `incompressible = true` {} `bulk_modulus_pa`", owner_,
                                          bulk ? "one of" : "either", bulk ? "and" : "or"));
    out.law = entry_.text("volumetric_law") == "logarithmic" ? fem::VolumetricLaw::logarithmic
                                                             : fem::VolumetricLaw::quadratic;
    out.bulk_modulus_pa = bulk.value_or(std::numeric_limits<double>::infinity());
  }

  const Options& entry_;
  const std::string owner_;
  const bool blended_;
  Mistakes& mistakes_;
  bool good_ = true;
  std::vector<std::string> sources_;
  std::string parameters_;
};

}  // namespace

std::vector<fem::RegionMaterial> fem_materials(const Options& options, const data::Mesh& mesh,
                                               Mistakes& mistakes, data::Table& notes) {
  const std::vector<Options>& entries = options.tables("material");
  bool blended = false;
  for (const Options& blend : options.tables("blend")) blended = blended || blend.text("of") == "muscle";
  std::vector<int> entry_of(mesh.regions.size(), -1);
  const auto claim = [&](std::size_t k, std::size_t r) {
    if (entry_of[r] >= 0)
      mistakes.error(entries[k], "twice-given",
                     fmt::format("region `{}` has two materials: entries {} and {} of `material`",
                                 mesh.regions[r], entry_of[r] + 1, k + 1));
    entry_of[r] = static_cast<int>(k);
  };
  for (const bool named : {true, false}) {  // those without names take what is left
    for (std::size_t k = 0; k < entries.size(); ++k) {
      if (entries[k].has("regions") != named) continue;
      std::vector<std::string> regions;
      mistakes.guarded(entries[k], "", [&] {
        regions = regions_of(entries[k], mesh, fmt::format("entry {} of `material`", k + 1));
      });
      for (std::size_t r = 0; r < mesh.regions.size(); ++r) {
        const bool wanted = std::find(regions.begin(), regions.end(), mesh.regions[r]) != regions.end();
        if (wanted && (named || entry_of[r] < 0)) claim(k, r);
      }
    }
  }
  std::vector<std::optional<fem::RegionMaterial>> read(entries.size());
  std::vector<std::array<std::string, 3>> said(entries.size());  // law, parameters, sources
  for (std::size_t k = 0; k < entries.size(); ++k) {
    Reader reader(entries[k], fmt::format("entry {} of `material`", k + 1), blended, mistakes);
    read[k] = reader.read();
    said[k] = {reader.law(), reader.parameters(), fmt::format("{}", fmt::join(reader.sources(), "; "))};
  }
  TableBuilder table("Materials");
  table.text("region").text("law").text("parameters").text("source").text("volume");
  std::vector<fem::RegionMaterial> out;
  for (std::size_t r = 0; r < mesh.regions.size(); ++r) {
    if (entry_of[r] < 0) {
      mistakes.error(
          options, "missing-material",
          fmt::format("region `{}` has no material: no entry of `material` names it", mesh.regions[r]),
          "add one with it in `regions`");
      continue;
    }
    const auto k = static_cast<std::size_t>(entry_of[r]);
    if (!read[k]) continue;
    out.push_back(*read[k]);
    const double bulk = read[k]->volumetric.bulk_modulus_pa;
    table.row({mesh.regions[r], said[k][0], said[k][1],
               said[k][2].empty() ? "given in the definition" : said[k][2],
               std::isinf(bulk) ? std::string("incompressible") : fmt::format("bulk modulus {:g} Pa", bulk)});
  }
  notes = table.take();
  return out;
}

}  // namespace brachium::pipelines
