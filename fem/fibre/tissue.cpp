#include "fem/fibre/tissue.hpp"

#include <fmt/format.h>

#include <cmath>

#include "fem/fibre/harmonic.hpp"
#include "fem/fibre/mesh_field.hpp"
#include "fem/fibre/statistics.hpp"

namespace brachium::fem {
namespace {

// Cells of the regions that a rule names, each region once among all rules of its kind.
class Claims {
 public:
  Claims(const data::Mesh& mesh, std::string what)
      : mesh_(mesh), what_(std::move(what)), taken_(mesh.regions.size(), 0) {}

  std::vector<int> claim(const std::vector<std::string>& names) {
    std::vector<char> mine(mesh_.regions.size(), names.empty() ? 1 : 0);
    for (const std::string& name : names) mine[static_cast<std::size_t>(mesh_.region(name))] = 1;
    for (std::size_t r = 0; r < mine.size(); ++r) {
      if (mine[r] && taken_[r]) {
        throw data::InputError("twice-given",
                               fmt::format("two rules give {} of region `{}`", what_, mesh_.regions[r]),
                               "let each region be named by one rule only");
      }
      taken_[r] = static_cast<char>(taken_[r] | mine[r]);
    }
    std::vector<int> cells;
    for (int c = 0; c < mesh_.cell_count(); ++c) {
      if (mine[static_cast<std::size_t>(mesh_.region_of_cell[static_cast<std::size_t>(c)])])
        cells.push_back(c);
    }
    return cells;
  }

 private:
  const data::Mesh& mesh_;
  std::string what_;
  std::vector<char> taken_;
};

void constant_fibres(const CellPoints& points, const ConstantFibres& rule, const std::vector<int>& cells,
                     Eigen::Matrix3Xd& fibre) {
  const double norm = rule.direction.norm();
  if (!(norm > 0.0 && std::isfinite(norm))) {
    throw data::InputError("bad-fibre", fmt::format("a constant fibre direction has length {:.6g}", norm),
                           "give a direction of any finite length but zero");
  }
  const int n_q = points.per_cell();
  for (int c : cells) fibre.middleCols(n_q * c, n_q).colwise() = rule.direction / norm;
}

void line_fibres(const CellPoints& points, const MeshLineFibres& rule, const std::vector<int>& cells,
                 Eigen::Matrix3Xd& fibre) {
  const data::Mesh& mesh = points.mesh();
  if (data::corners_per_cell(mesh.type) != 8) {
    throw data::InputError("bad-fibre", to_string(mesh.type) + " cells have no lines to lay fibres along",
                           "use harmonic fibres, or directions from the mesh file");
  }
  if (rule.axis < 0 || rule.axis > 2) {
    throw data::InputError("bad-fibre", fmt::format("a cell has no axis {}", rule.axis),
                           "axes are 0, 1 and 2");
  }
  const int n_q = points.per_cell();
  for (int c : cells) {
    const Eigen::Matrix3Xd X = points.nodes(c);
    for (int q = 0; q < n_q; ++q) {
      const Eigen::Vector3d tangent = points.jacobian(X, q).col(rule.axis);
      if (!(tangent.norm() > 0.0)) {
        throw data::InputError("bad-fibre", fmt::format("mesh lines of cell {} have no length", c),
                               "mend the mesh before fibres are laid along it");
      }
      fibre.col(q + n_q * c) = tangent.normalized();
    }
  }
}

template <class Value>
void append(data::Table& table, std::size_t column, const Value& value) {
  std::get<std::vector<Value>>(table.columns[column].values).push_back(value);
}

void add_harmonic_row(data::Table& table, const HarmonicFibres& rule, const HarmonicSummary& s) {
  append(table, 0, rule.origin);
  append(table, 1, rule.insertion);
  append(table, 2, static_cast<double>(s.unknowns));
  append(table, 3, s.smallest_gradient_per_m);
  append(table, 4, static_cast<double>(s.smallest_gradient_cell));
  append(table, 5, s.largest_gradient_per_m);
}

void add_fraction_row(data::Table& table, const std::string& what, const CellPoints& points,
                      const Eigen::VectorXd& values, int brought_back) {
  double sum = 0.0, volume = 0.0;
  for (int c = 0; c < points.mesh().cell_count(); ++c) {
    const Eigen::Matrix3Xd X = points.nodes(c);
    for (int q = 0; q < points.per_cell(); ++q) {
      const double v = points.volume(points.jacobian(X, q), q);
      sum += v * values[q + points.per_cell() * c];
      volume += v;
    }
  }
  append(table, 0, what);
  append(table, 1, sum / volume);
  append(table, 2, values.minCoeff());
  append(table, 3, values.maxCoeff());
  append(table, 4, static_cast<double>(brought_back));
}

Eigen::VectorXd fractions(const CellPoints& points, const std::vector<FractionRule>& rules,
                          const std::string& what, double otherwise, data::Table& table) {
  if (rules.empty()) return {};
  const int n_q = points.per_cell();
  Eigen::VectorXd values = Eigen::VectorXd::Constant(n_q * points.mesh().cell_count(), otherwise);
  Claims claims(points.mesh(), "the fraction of " + what);
  int brought_back = 0;
  for (const FractionRule& rule : rules) {
    const std::vector<int> cells = claims.claim(rule.regions);
    if (const auto* field = std::get_if<std::string>(&rule.source)) {
      brought_back += fractions_from_field(points, *field, cells, values);
      continue;
    }
    const double value = std::get<double>(rule.source);
    if (!(value >= 0.0 && value <= 1.0)) {
      throw data::InputError("bad-fraction",
                             fmt::format("the fraction of {} is given as {:.6g}", what, value),
                             "it must be in [0, 1]");
    }
    for (int c : cells) values.segment(n_q * c, n_q).setConstant(value);
  }
  add_fraction_row(table, what, points, values, brought_back);
  return values;
}

}  // namespace

Tissue build_tissue(const data::Mesh& mesh, Formulation formulation, const TissueRules& rules) {
  const CellPoints points(mesh, formulation);
  Tissue tissue;
  tissue.harmonic = {"Harmonic fibres",
                     {{"origin", "", std::vector<std::string>{}},
                      {"insertion", "", std::vector<std::string>{}},
                      {"unknowns", "1", std::vector<double>{}},
                      {"smallest_gradient_per_m", "1/m", std::vector<double>{}},
                      {"smallest_gradient_cell", "1", std::vector<double>{}},
                      {"largest_gradient_per_m", "1/m", std::vector<double>{}}}};
  if (!rules.fibres.empty()) {
    Eigen::Matrix3Xd& fibre = tissue.field.fibre;
    fibre = Eigen::Matrix3Xd::Zero(3, points.per_cell() * mesh.cell_count());
    Claims claims(mesh, "fibres");
    for (const FibreRule& rule : rules.fibres) {
      const std::vector<int> cells = claims.claim(rule.regions);
      if (const auto* r = std::get_if<ConstantFibres>(&rule.source))
        constant_fibres(points, *r, cells, fibre);
      if (const auto* r = std::get_if<MeshFieldFibres>(&rule.source))
        fibres_from_field(points, r->field, cells, fibre);
      if (const auto* r = std::get_if<MeshLineFibres>(&rule.source)) line_fibres(points, *r, cells, fibre);
      if (const auto* r = std::get_if<HarmonicFibres>(&rule.source)) {
        add_harmonic_row(tissue.harmonic, *r, harmonic_fibres(points, *r, cells, fibre));
      }
    }
  }
  tissue.directions = direction_table(points, tissue.field.fibre);
  tissue.fractions = {"Fractions of tissue",
                      {{"tissue", "", std::vector<std::string>{}},
                       {"mean", "1", std::vector<double>{}},
                       {"smallest", "1", std::vector<double>{}},
                       {"largest", "1", std::vector<double>{}},
                       {"points_brought_back", "1", std::vector<double>{}}}};
  tissue.field.muscle = fractions(points, rules.muscle, "muscle", 1.0, tissue.fractions);
  tissue.field.soft_tissue = fractions(points, rules.soft_tissue, "soft tissue", 0.0, tissue.fractions);
  return tissue;
}

}  // namespace brachium::fem
