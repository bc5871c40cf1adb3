#include "pipelines/stages/fem_quantities.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <stdexcept>

#include "pipelines/stages/common.hpp"

namespace brachium::pipelines {
namespace {

using data::Diagnostic;
using data::InputError;
using data::Severity;

bool is_field(const std::string& kind) {
  return kind == "fibre_stretch" || kind == "fibre_stress" || kind == "active_stress" ||
         kind == "von_mises" || kind == "pressure" || kind == "jacobian";
}

std::string field_unit(const std::string& kind) {
  return kind == "fibre_stretch" || kind == "jacobian" ? "1" : "Pa";
}

const Eigen::VectorXd& field_of(const fem::PointFields& fields, const std::string& kind) {
  if (kind == "fibre_stretch") return fields.fibre_stretch;
  if (kind == "fibre_stress") return fields.fibre_stress_pa;
  if (kind == "active_stress") return fields.active_stress_pa;
  if (kind == "von_mises") return fields.von_mises_pa;
  if (kind == "pressure") return fields.pressure_pa;
  return fields.jacobian;
}

Eigen::Vector3d vector_or_zero(const Options& o, const std::string& key) {
  if (!o.has(key)) return Eigen::Vector3d::Zero();
  const std::vector<double>& v = o.numbers(key);
  return {v[0], v[1], v[2]};
}

/// One row, column by column.
class Row {
 public:
  void text(const std::string& name, const std::string& value) {
    table_.columns.push_back({name, "", std::vector<std::string>{value}});
  }
  void number(const std::string& name, const std::string& unit, double value) {
    table_.columns.push_back({name, unit, std::vector<double>{value}});
  }
  void wrench(const std::string& name, const fem::Wrench& w) {
    const char* const axes[] = {"x", "y", "z"};
    for (int a = 0; a < 3; ++a) number(fmt::format("{}_{}_N", name, axes[a]), "N", w.force_n[a]);
    number(name + "_N", "N", w.force_n.norm());
    for (int a = 0; a < 3; ++a)
      number(fmt::format("{}_moment_{}_N_m", name, axes[a]), "N m", w.moment_n_m[a]);
  }
  data::Table take() { return std::move(table_); }

 private:
  data::Table table_{"Wanted quantities by accepted state", {}};
};

}  // namespace

void check_outputs(const Options& options, const data::Mesh& mesh, std::vector<Diagnostic>& mistakes) {
  std::set<std::string> names;
  for (const Options& entry : options.tables("output")) {
    const std::string name = entry.text("name"), kind = entry.text("kind"),
                      owner = fmt::format("output `{}` (kind {})", name, kind);
    const auto error = [&](const char* code, std::string message, std::string help = {}) {
      mistakes.push_back({Severity::error, code, std::move(message), std::nullopt, std::move(help)});
    };
    if (!names.insert(name).second) error("twice-given", fmt::format("two outputs are called `{}`", name));
    if (name.empty() ||
        !std::all_of(name.begin(), name.end(), [](unsigned char c) { return std::isalnum(c) || c == '_'; }))
      error("bad-name", fmt::format("`{}` cannot name an output", name),
            "use letters, digits and `_`: the name becomes part of a column's name");
    std::vector<std::string> keys{"name", "kind"}, needed;
    if (kind == "reaction" || kind == "stress_resultant") {
      keys.insert(keys.end(), {"surface", "point_m"});
      needed = {"surface"};
    } else if (kind == "volume" || is_field(kind)) {
      keys.push_back("regions");
    } else if (kind == "section") {
      needed = {"point_m", "normal"};
      keys.push_back("direction");
    } else {
      needed = {"point_m"};
    }
    keys.insert(keys.end(), needed.begin(), needed.end());
    only_keys(entry, keys, owner, mistakes);
    for (const std::string& key : needed) {
      if (!entry.has(key)) error("missing-option", fmt::format("{} needs `{}`", owner, key));
    }
    try {
      if (const auto surface = entry.maybe_text("surface"); surface && !mesh.node_sets.contains(*surface))
        mesh.surface(*surface);
      regions_of(entry, mesh, owner);
    } catch (const InputError& e) {
      mistakes.insert(mistakes.end(), e.diagnostics().begin(), e.diagnostics().end());
    }
    for (const std::string key : {"normal", "direction"}) {
      if (entry.has(key) && vector_or_zero(entry, key).norm() == 0.0)
        error("zero-direction", fmt::format("{}: `{}` has no direction", owner, key));
    }
  }
}

FemQuantities::FemQuantities(const Options& options, const fem::Problem& problem,
                             const fem::Discretisation& discretisation)
    : options_(options), problem_(problem), discretisation_(discretisation) {
  const int n_q = discretisation.quadrature().size();
  weights_.resize(static_cast<Eigen::Index>(n_q) * discretisation.cell_count());
  Eigen::MatrixX3d gradient;
  for (int c = 0; c < discretisation.cell_count(); ++c) {
    for (int q = 0; q < n_q; ++q)
      discretisation.reference_gradients(c, q, gradient, weights_[q + static_cast<Eigen::Index>(n_q) * c]);
  }
  std::set<std::string> moved;
  for (const fem::Phase& phase : problem.programme) {
    for (const auto& [name, value] : phase.amplitude) moved.insert(name);
  }
  moved_.assign(moved.begin(), moved.end());
  for (std::size_t r = 0; r < problem.materials.size(); ++r) {
    if (fem::is_active(problem.materials[r].material)) active_.push_back(r);
  }
}

void FemQuantities::check_places() const {
  fem::Configuration rest;
  rest.dofs = Eigen::VectorXd::Zero(discretisation_.dof_count());
  std::vector<Diagnostic> mistakes;
  for (const Options& entry : options_.tables("output")) {
    try {
      const std::string kind = entry.text("kind");
      if (kind == "section")
        fem::section(discretisation_, rest, vector_or_zero(entry, "point_m"),
                     vector_or_zero(entry, "normal"));
      if (kind == "displacement")
        fem::displacement_at(discretisation_, rest, vector_or_zero(entry, "point_m"));
    } catch (const InputError& e) {
      for (Diagnostic d : e.diagnostics()) {
        d.message = fmt::format("output `{}`: {}", entry.text("name"), d.message);
        mistakes.push_back(std::move(d));
      }
    }
  }
  if (!mistakes.empty()) throw InputError(std::move(mistakes));
}

data::Table FemQuantities::row(int state, const fem::AcceptedState& accepted,
                               const fem::PointFields& fields) const {
  const fem::Configuration& configuration = accepted.state.configuration;
  const data::Mesh& mesh = *problem_.mesh;
  Row row;
  row.number("state", "1", state);
  row.text("phase", accepted.record.phase);
  row.number("phase_time", "1", accepted.record.phase_time);
  for (const std::size_t r : active_)
    row.number("activation_" + mesh.regions[r], "1", configuration.activation[static_cast<Eigen::Index>(r)]);
  for (const std::string& name : moved_) {
    const auto at = accepted.state.amplitude.find(name);
    row.number("amplitude_" + name, "1", at == accepted.state.amplitude.end() ? 0.0 : at->second);
  }
  row.number("energy_J", "J", accepted.record.energy);
  row.number("volume_m3", "m3", accepted.record.volume);
  row.number("volume_change", "1", accepted.record.volume / discretisation_.volume() - 1.0);
  const int n_q = discretisation_.quadrature().size();
  for (const Options& entry : options_.tables("output")) {
    const std::string name = entry.text("name"), kind = entry.text("kind");
    if (kind == "reaction") {
      row.wrench(name,
                 fem::wrench(discretisation_, configuration, accepted.internal_force, accepted.external_force,
                             entry.text("surface"), vector_or_zero(entry, "point_m")));
    } else if (kind == "stress_resultant") {
      row.wrench(name, fem::stress_wrench(problem_, discretisation_, configuration, entry.text("surface"),
                                          vector_or_zero(entry, "point_m")));
    } else if (kind == "section") {
      const fem::SectionFigures s = fem::section(
          discretisation_, configuration, vector_or_zero(entry, "point_m"), vector_or_zero(entry, "normal"));
      row.number(name + "_area_m2", "m2", s.area_m2);
      row.number(name + "_mean_radius_m", "m", s.mean_radius_m);
      row.number(name + "_least_radius_m", "m", s.least_radius_m);
      row.number(name + "_greatest_radius_m", "m", s.greatest_radius_m);
      if (entry.has("direction")) {
        row.number(
            name + "_thickness_m", "m",
            fem::section_thickness(discretisation_, configuration, vector_or_zero(entry, "point_m"),
                                   vector_or_zero(entry, "normal"), vector_or_zero(entry, "direction")));
      }
    } else if (kind == "displacement") {
      const Eigen::Vector3d u =
          fem::displacement_at(discretisation_, configuration, vector_or_zero(entry, "point_m"));
      const char* const axes[] = {"x", "y", "z"};
      for (int a = 0; a < 3; ++a) row.number(fmt::format("{}_{}_m", name, axes[a]), "m", u[a]);
    } else {
      const std::vector<std::string> regions = regions_of(entry, mesh, name);
      std::vector<bool> wanted(mesh.regions.size());
      for (const std::string& region : regions) wanted[static_cast<std::size_t>(mesh.region(region))] = true;
      if (kind == "volume") {
        const Eigen::VectorXd volumes = fem::region_volumes(discretisation_, configuration);
        double now = 0.0, before = 0.0;
        for (std::size_t r = 0; r < wanted.size(); ++r)
          now += wanted[r] ? volumes[static_cast<Eigen::Index>(r)] : 0.0;
        for (int c = 0; c < mesh.cell_count(); ++c) {
          if (wanted[static_cast<std::size_t>(mesh.region_of_cell[static_cast<std::size_t>(c)])])
            before += weights_.segment(static_cast<Eigen::Index>(n_q) * c, n_q).sum();
        }
        row.number(name + "_m3", "m3", now);
        row.number(name + "_change", "1", now / before - 1.0);
        continue;
      }
      const Eigen::VectorXd& field = field_of(fields, kind);
      double sum = 0.0, weight = 0.0, least = std::nan(""), most = std::nan("");
      for (int c = 0; c < mesh.cell_count(); ++c) {
        if (!wanted[static_cast<std::size_t>(mesh.region_of_cell[static_cast<std::size_t>(c)])]) continue;
        for (int q = 0; q < n_q; ++q) {
          const Eigen::Index i = q + static_cast<Eigen::Index>(n_q) * c;
          if (i >= field.size() || std::isnan(field[i]))
            continue;  // a region without fibres has no fibre stretch
          sum += weights_[i] * field[i];
          weight += weights_[i];
          least = std::isnan(least) ? field[i] : std::min(least, field[i]);
          most = std::isnan(most) ? field[i] : std::max(most, field[i]);
        }
      }
      const std::string unit = field_unit(kind), ending = unit == "1" ? "" : "_Pa";
      row.number(name + "_mean" + ending, unit, weight > 0.0 ? sum / weight : std::nan(""));
      row.number(name + "_min" + ending, unit, least);
      row.number(name + "_max" + ending, unit, most);
    }
  }
  return row.take();
}

void append_rows(data::Table& to, const data::Table& from) {
  if (to.columns.empty()) {
    to = from;
    return;
  }
  if (to.columns.size() != from.columns.size())
    throw std::logic_error("tables with different columns cannot be joined");
  for (std::size_t c = 0; c < to.columns.size(); ++c) {
    std::visit(
        [&](auto& values) {
          const auto* more = std::get_if<std::decay_t<decltype(values)>>(&from.columns[c].values);
          if (!more || to.columns[c].name != from.columns[c].name)
            throw std::logic_error("tables with different columns cannot be joined");
          values.insert(values.end(), more->begin(), more->end());
        },
        to.columns[c].values);
  }
}

}  // namespace brachium::pipelines
