#include <fmt/format.h>
#include <vector>

#include "data/model/error.hpp"
#include "fem/material/material.hpp"

namespace brachium::fem {
namespace {

class Check {
 public:
  explicit Check(std::string owner) : owner_(std::move(owner)) {}

  // Pass the comparison itself, so that NaN fails it.
  void require(bool inside, const std::string& parameter, double value, const char* range) {
    if (inside) return;
    data::Diagnostic d;
    d.code = "bad-parameter";
    d.message = value != value ? fmt::format("`{}` of {} is not given", parameter, owner_)
                               : fmt::format("`{}` of {} is {}", parameter, owner_, value);
    d.help = fmt::format("it must be {}", range);
    mistakes_.push_back(std::move(d));
  }
  void positive(const std::string& parameter, double value) {
    require(value > 0.0 && value < infinity, parameter, value, "above 0");
  }
  void not_negative(const std::string& parameter, double value) {
    require(value >= 0.0 && value < infinity, parameter, value, "0 or above");
  }
  void between(const std::string& parameter, double value, double low, double high, const char* range) {
    require(value >= low && value <= high, parameter, value, range);
  }
  void finish() const {
    if (!mistakes_.empty()) throw data::InputError(mistakes_);
  }

 private:
  static constexpr double infinity = std::numeric_limits<double>::infinity();
  std::string owner_;
  std::vector<data::Diagnostic> mistakes_;
};

void check_tissue(Check& c, const std::string& tissue, const FibrousTissue& t) {
  c.not_negative(tissue + ".c1_pa", t.c1_pa);
  c.not_negative(tissue + ".c2_pa", t.c2_pa);
  c.require(!(t.c1_pa + t.c2_pa <= 0.0), tissue + ".c1_pa + c2_pa", t.c1_pa + t.c2_pa, "above 0");
  c.not_negative(tissue + ".c3_pa", t.c3_pa);
  c.between(tissue + ".c4", t.c4, 1.0, 200.0, "in [1, 200]");
}

void check_law(Check& c, const MuscleTendon& m) {
  check_tissue(c, "muscle", m.muscle);
  check_tissue(c, "tendon", m.tendon);
  c.not_negative("max_stress_pa", m.max_stress_pa);
  const ForceLength& f = m.force_length;
  c.require(f.optimal_stretch > 0.0 && f.optimal_stretch <= 10.0, "force_length.optimal_stretch",
            f.optimal_stretch, "in (0, 10]");
  c.positive("force_length.ascending_width", f.ascending_width);
  c.between("force_length.ascending_exponent", f.ascending_exponent, 1.2, 10.0, "in [1.2, 10]");
  c.positive("force_length.descending_width", f.descending_width);
  c.between("force_length.descending_exponent", f.descending_exponent, 1.2, 10.0, "in [1.2, 10]");
  if (!m.rate_dependent) return;
  c.positive("force_velocity.max_rate_per_s", m.force_velocity.max_rate_per_s);
  c.positive("force_velocity.curvature", m.force_velocity.curvature);
  const double e = m.force_velocity.eccentric_force;
  c.require(e > 1.0 && e <= 10.0, "force_velocity.eccentric_force", e, "in (1, 10]");
}

void check_law(Check& c, const NeoHooke& m) {
  c.positive("shear_modulus_pa", m.shear_modulus_pa);
}

void check_law(Check& c, const MooneyRivlin& m) {
  c.not_negative("c10_pa", m.c10_pa);
  c.not_negative("c01_pa", m.c01_pa);
  c.require(!(m.c10_pa + m.c01_pa <= 0.0), "c10_pa + c01_pa", m.c10_pa + m.c01_pa, "above 0");
}

void check_law(Check& c, const FungGuccione& m) {
  c.positive("stiffness_pa", m.stiffness_pa);
  c.positive("bf", m.bf);
  c.positive("bt", m.bt);
  c.positive("bfs", m.bfs);
}

void check_law(Check& c, const BlemkerMuscle& m) {
  c.not_negative("along_fibre_shear_pa", m.along_fibre_shear_pa);
  c.positive("cross_fibre_shear_pa", m.cross_fibre_shear_pa);
  c.not_negative("passive_coefficient", m.passive_coefficient);
  c.positive("passive_exponent", m.passive_exponent);
  c.positive("optimal_stretch", m.optimal_stretch);
  c.not_negative("max_stress_pa", m.max_stress_pa);
  c.require(m.straightening_stretch > m.optimal_stretch && m.straightening_stretch <= 100.0,
            "straightening_stretch", m.straightening_stretch, "above `optimal_stretch` and at most 100");
}

}  // namespace

std::string law_name(const Material& material) {
  struct Name {
    std::string operator()(const MuscleTendon&) const { return "muscle_tendon"; }
    std::string operator()(const NeoHooke&) const { return "neo_hooke"; }
    std::string operator()(const MooneyRivlin&) const { return "mooney_rivlin"; }
    std::string operator()(const FungGuccione&) const { return "fung_guccione"; }
    std::string operator()(const BlemkerMuscle&) const { return "blemker_muscle"; }
  };
  return std::visit(Name{}, material);
}

bool needs_fibres(const Material& material) {
  return !std::holds_alternative<NeoHooke>(material) && !std::holds_alternative<MooneyRivlin>(material);
}

bool is_active(const Material& material) {
  if (const auto* m = std::get_if<MuscleTendon>(&material)) return m->max_stress_pa > 0.0;
  if (const auto* b = std::get_if<BlemkerMuscle>(&material)) return b->max_stress_pa > 0.0;
  return false;
}

bool is_rate_dependent(const Material& material) {
  const auto* m = std::get_if<MuscleTendon>(&material);
  return m != nullptr && m->rate_dependent && m->max_stress_pa > 0.0;
}

void check(const Material& material) {
  Check c("material law `" + law_name(material) + "`");
  std::visit([&](const auto& law) { check_law(c, law); }, material);
  c.finish();
}

void check(const Volumetric& volumetric) {
  Check c("the volumetric law");
  c.require(volumetric.bulk_modulus_pa > 0.0, "bulk_modulus_pa", volumetric.bulk_modulus_pa,
            "above 0 (infinity: incompressible)");
  c.finish();
}

}  // namespace brachium::fem
