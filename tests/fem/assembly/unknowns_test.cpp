/// Numbering of unknowns and the tangent's pattern.

#include <set>

#include "fem/assembly/unknowns.hpp"
#include "fem/mesh/block.hpp"

namespace brachium::fem {
namespace {

std::shared_ptr<const Discretisation> discretisation(Formulation formulation) {
  const auto mesh = std::make_shared<const data::Mesh>(
      block(Eigen::Vector3d(1.0, 1.0, 1.0), 3, 2, 1, cell_type(formulation)));
  return std::make_shared<const Discretisation>(mesh, formulation);
}

TEST(Unknowns, PatternHoldsExactlyTheCouplingsOfCells) {
  for (const Formulation formulation : {Formulation::q2_q1_taylor_hood, Formulation::q1_p0}) {
    const auto d = discretisation(formulation);
    std::vector<char> held(static_cast<std::size_t>(d->dof_count()), 0);
    for (std::size_t i = 0; i < held.size(); i += 4) held[i] = 1;
    const Unknowns u = number_unknowns(*d, held, {});
    check(u.pattern);
    std::set<std::pair<int, int>> expected;
    for (int c = 0; c < d->cell_count(); ++c) {
      std::vector<int> unknowns;
      const auto add = [&](int dof) {
        if (u.unknown_of_dof[static_cast<std::size_t>(dof)] >= 0)
          unknowns.push_back(u.unknown_of_dof[static_cast<std::size_t>(dof)]);
      };
      for (int a = 0; a < d->nodes_per_cell(); ++a) {
        for (int i = 0; i < 3; ++i) add(3 * d->nodes_of_cell()(a, c) + i);
      }
      for (int m = 0; d->pressure_node_count() > 0 && m < d->pressures_per_cell(); ++m)
        add(3 * d->node_count() + d->pressure_nodes_of_cell()(m, c));
      for (const int i : unknowns) {
        for (const int j : unknowns) {
          if (i >= j) expected.emplace(j, i);
        }
      }
    }
    std::set<std::pair<int, int>> found;
    for (int j = 0; j < u.pattern.n; ++j) {
      for (int e = u.pattern.column_start[static_cast<std::size_t>(j)];
           e < u.pattern.column_start[static_cast<std::size_t>(j) + 1]; ++e)
        found.emplace(j, u.pattern.row[static_cast<std::size_t>(e)]);
    }
    EXPECT_EQ(found, expected);
  }
}

TEST(Unknowns, PressuresAreMarkedAsConstraints) {
  const auto d = discretisation(Formulation::q2_q1_taylor_hood);
  const Unknowns u = number_unknowns(*d, std::vector<char>(static_cast<std::size_t>(d->dof_count()), 0), {});
  for (int i = 0; i < u.count(); ++i)
    EXPECT_EQ(u.groups.constraint[static_cast<std::size_t>(i)] != 0,
              u.dof_of_unknown[static_cast<std::size_t>(i)] >= 3 * d->node_count());
}

TEST(Unknowns, RestrictAndExtendAreInverseOnUnknowns) {
  const auto d = discretisation(Formulation::q1_p0);
  std::vector<char> held(static_cast<std::size_t>(d->dof_count()), 0);
  held[5] = held[6] = held[7] = 1;
  const Unknowns u = number_unknowns(*d, held, {});
  const Eigen::VectorXd x = Eigen::VectorXd::LinSpaced(u.count(), 1.0, 2.0);
  EXPECT_EQ(u.restrict(u.extend(x)), x);
  EXPECT_EQ(u.extend(x)[5], 0.0);
}

TEST(Discretisation, RefusesCellsOfAnotherTypeAndInvertedOnes) {
  const auto mesh = std::make_shared<const data::Mesh>(
      block(Eigen::Vector3d(1.0, 1.0, 1.0), 2, 1, 1, data::CellType::hex8));
  try {
    const Discretisation d(mesh, Formulation::q2_p1_discontinuous);
    FAIL();
  } catch (const data::InputError& e) {
    EXPECT_STREQ(e.diagnostics()[0].message.c_str(),
                 "element `q2_p1_discontinuous` needs cells of type hex27, the mesh has hex8");
  }
  data::Mesh inverted = *mesh;
  for (Eigen::Index c = 1; c < 2; ++c) {
    for (Eigen::Index a = 0; a < 4; ++a) std::swap(inverted.cells(a, c), inverted.cells(a + 4, c));
  }
  try {
    const Discretisation d(std::make_shared<const data::Mesh>(inverted), Formulation::q1_p0);
    FAIL();
  } catch (const data::InputError& e) {
    EXPECT_EQ(e.diagnostics()[0].code, "inverted-cell");
    EXPECT_NE(e.diagnostics()[0].message.find("1 of 2 cells are turned inside out"), std::string::npos)
        << e.diagnostics()[0].message;
    EXPECT_NE(e.diagnostics()[0].message.find("1 (region `block`"), std::string::npos)
        << e.diagnostics()[0].message;
  }
}

}  // namespace
}  // namespace brachium::fem
