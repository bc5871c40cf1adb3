#include "pipelines/stages/fem_quantities.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>
#include <stdexcept>

#include "fem/quantities/displacement_at.hpp"
#include "fem/solve/holds.hpp"
#include "pipelines/stages/common.hpp"

namespace brachium::pipelines {
namespace {

using data::InputError;

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

}  // namespace

/// One row, column by column.
class FemQuantities::Row {
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

void check_outputs(const Options& options, const data::Mesh& mesh, Mistakes& mistakes) {
  std::set<std::string> names;
  for (const Options& entry : options.tables("output")) {
    const std::string name = entry.text("name"), kind = entry.text("kind"),
                      owner = fmt::format("output `{}` (kind {})", name, kind);
    const auto error = [&](const char* code, std::string message, std::string help = {}) {
      mistakes.error(entry, code, std::move(message), std::move(help));
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
    } else if (kind == "contact") {
      keys.push_back("point_m");
      needed = {"contact"};
    } else if (kind == "volume" || is_field(kind)) {
      keys.push_back("regions");
    } else if (kind == "section") {
      needed = {"point_m", "normal"};
      keys.push_back("direction");
    } else {
      needed = {"point_m"};
    }
    keys.insert(keys.end(), needed.begin(), needed.end());
    mistakes.only_keys(entry, keys, owner);
    for (const std::string& key : needed) mistakes.need(entry, key, owner);
    mistakes.guarded(entry, owner + ": ", [&] {
      const auto surface = entry.maybe_text("surface");
      if (surface && kind == "reaction") fem::condition_points(mesh, *surface);
      if (surface && kind != "reaction") fem::check_has_faces(mesh, *surface);
    });
    mistakes.guarded(entry, "", [&] { regions_of(entry, mesh, owner); });
    if (const auto contact = entry.maybe_text("contact"); contact && kind == "contact") {
      std::vector<std::string> contacts;
      for (const Options& c : options.tables("contact")) contacts.push_back(c.text("name"));
      if (std::find(contacts.begin(), contacts.end(), *contact) == contacts.end())
        error("unknown-contact", fmt::format("{} reads `{}`, which is no contact", owner, *contact),
              data::suggest(*contact, contacts));
    }
    for (const std::string key : {"normal", "direction"}) {
      if (entry.has(key) && vector_of(entry, key).norm() == 0.0)
        error("zero-direction", fmt::format("{}: `{}` has no direction", owner, key));
    }
  }
}

FemQuantities::FemQuantities(const Options& options, const fem::Problem& problem,
                             const fem::Discretisation& discretisation)
    : options_(options),
      problem_(problem),
      discretisation_(discretisation),
      contacts_(problem, discretisation, 1.0, 1.0) {  // penalties are all given: build_fem_problem

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

void check_places(const Options& options, const fem::Discretisation& discretisation, Mistakes& mistakes) {
  fem::Configuration rest;
  rest.dofs = Eigen::VectorXd::Zero(discretisation.dof_count());
  for (const Options& entry : options.tables("output")) {
    mistakes.guarded(entry, fmt::format("output `{}`: ", entry.text("name")), [&] {
      const std::string kind = entry.text("kind");
      const Eigen::Vector3d point = vector_of(entry, "point_m"), normal = vector_of(entry, "normal");
      if (kind == "section" && normal.norm() > 0.0) fem::section(discretisation, rest, point, normal);
      if (kind == "displacement" || kind == "point") fem::locate(discretisation, point);
    });
  }
}

void FemQuantities::contact(const Options& entry, const fem::AcceptedState& accepted, Row& row) const {
  const std::string name = entry.text("name");
  std::size_t which = 0;
  while (problem_.contacts[which].name != entry.text("contact")) ++which;
  Eigen::VectorXd amplitude(static_cast<Eigen::Index>(problem_.conditions.size()));
  for (std::size_t i = 0; i < problem_.conditions.size(); ++i)
    amplitude[static_cast<Eigen::Index>(i)] = accepted.state.amplitude.at(problem_.conditions[i].name);
  const fem::Configuration& at = accepted.state.configuration;
  const fem::ContactSums sums = contacts_.sums(amplitude, at.dofs, at.contact_multiplier)[which];
  row.wrench(name, fem::moved({sums.force_n, sums.moment_n_m}, Eigen::Vector3d::Zero(),
                              vector_of(entry, "point_m")));
  row.number(name + "_area_m2", "m2", sums.area_m2);
  row.number(name + "_max_Pa", "Pa", sums.greatest_pressure_pa);
  row.number(name + "_penetration_m", "m", sums.greatest_penetration_m);
}

void FemQuantities::point(const Options& entry, const fem::CellStates& states, Row& row) const {
  const std::string name = entry.text("name");
  const fem::Located at = fem::locate(discretisation_, vector_of(entry, "point_m"));
  const fem::CellState s = states.at(at.cell, at.xi);
  if (s.has_fibre) {
    row.number(name + "_fibre_stretch", "1", s.fibre_stretch);
    row.number(name + "_fibre_stress_Pa", "Pa", s.fibre_stress_pa);
    row.number(name + "_active_stress_Pa", "Pa", s.active_stress_pa);
  }
  row.number(name + "_von_mises_Pa", "Pa", fem::von_mises_of(s.cauchy_pa));
  row.number(name + "_pressure_Pa", "Pa", fem::pressure_of(s.cauchy_pa));
  row.number(name + "_jacobian", "1", s.jacobian);
  const char axes[] = "xyz";
  for (int i = 0; i < 3; ++i)
    for (int j = i; j < 3; ++j)
      row.number(fmt::format("{}_stress_{}{}_Pa", name, axes[i], axes[j]), "Pa", s.cauchy_pa(i, j));
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
  std::optional<fem::CellStates> states;
  for (const Options& entry : options_.tables("output")) {
    const std::string name = entry.text("name"), kind = entry.text("kind");
    if (kind == "reaction") {
      row.wrench(name,
                 fem::wrench(discretisation_, configuration, accepted.internal_force, accepted.external_force,
                             entry.text("surface"), vector_of(entry, "point_m")));
    } else if (kind == "stress_resultant") {
      row.wrench(name, fem::stress_wrench(problem_, discretisation_, configuration, entry.text("surface"),
                                          vector_of(entry, "point_m")));
    } else if (kind == "contact") {
      contact(entry, accepted, row);
    } else if (kind == "section") {
      const fem::SectionFigures s = fem::section(discretisation_, configuration, vector_of(entry, "point_m"),
                                                 vector_of(entry, "normal"));
      row.number(name + "_area_m2", "m2", s.area_m2);
      row.number(name + "_mean_radius_m", "m", s.mean_radius_m);
      row.number(name + "_least_radius_m", "m", s.least_radius_m);
      row.number(name + "_greatest_radius_m", "m", s.greatest_radius_m);
      if (entry.has("direction")) {
        row.number(name + "_thickness_m", "m",
                   fem::section_thickness(discretisation_, configuration, vector_of(entry, "point_m"),
                                          vector_of(entry, "normal"), vector_of(entry, "direction")));
      }
    } else if (kind == "point") {
      if (!states) states.emplace(problem_, discretisation_, configuration);
      point(entry, *states, row);
    } else if (kind == "displacement") {
      const Eigen::Vector3d u =
          fem::displacement_at(discretisation_, configuration, vector_of(entry, "point_m"));
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
