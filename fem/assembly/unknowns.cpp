#include "fem/assembly/unknowns.hpp"

#include <algorithm>

namespace brachium::fem {
namespace {

/// Groups of unknowns that couple alike: nodes (3 components) and pressure nodes (1), numbered nodes first.
/// Neighbours are the groups that share a cell, each group's own included, ascending.
struct Neighbourhood {
  std::vector<int> start, neighbour;
};

Neighbourhood neighbourhood(const Discretisation& d) {
  const int groups = d.node_count() + d.pressure_node_count(), cells = d.cell_count(),
            nodes = d.nodes_per_cell();
  const bool continuous = d.pressure_node_count() > 0;
  const int pressures = continuous ? d.pressures_per_cell() : 0;
  const auto group = [&](int slot, int cell) {
    return slot < nodes ? d.nodes_of_cell()(slot, cell)
                        : d.node_count() + d.pressure_nodes_of_cell()(slot - nodes, cell);
  };
  std::vector<int> cell_start(static_cast<std::size_t>(groups) + 1, 0), cell_of;
  for (int c = 0; c < cells; ++c) {
    for (int s = 0; s < nodes + pressures; ++s) ++cell_start[static_cast<std::size_t>(group(s, c)) + 1];
  }
  for (std::size_t g = 0; g < static_cast<std::size_t>(groups); ++g) cell_start[g + 1] += cell_start[g];
  cell_of.resize(static_cast<std::size_t>(cell_start.back()));
  std::vector<int> fill(cell_start.begin(), cell_start.end() - 1);
  for (int c = 0; c < cells; ++c) {
    for (int s = 0; s < nodes + pressures; ++s)
      cell_of[static_cast<std::size_t>(fill[static_cast<std::size_t>(group(s, c))]++)] = c;
  }
  Neighbourhood result;
  result.start.assign(1, 0);
  std::vector<int> mark(static_cast<std::size_t>(groups), -1), row;
  for (int g = 0; g < groups; ++g) {
    row.clear();
    for (int i = cell_start[static_cast<std::size_t>(g)]; i < cell_start[static_cast<std::size_t>(g) + 1];
         ++i) {
      const int c = cell_of[static_cast<std::size_t>(i)];
      for (int s = 0; s < nodes + pressures; ++s) {
        const int h = group(s, c);
        if (mark[static_cast<std::size_t>(h)] == g) continue;
        mark[static_cast<std::size_t>(h)] = g;
        row.push_back(h);
      }
    }
    std::sort(row.begin(), row.end());
    result.neighbour.insert(result.neighbour.end(), row.begin(), row.end());
    result.start.push_back(static_cast<int>(result.neighbour.size()));
  }
  return result;
}

}  // namespace

Unknowns number_unknowns(const Discretisation& d, const std::vector<char>& held,
                         const Eigen::Matrix3Xd& frames) {
  Unknowns u;
  u.frames = frames;
  for (int n = 0; 3 * n < frames.cols(); ++n)
    u.framed.push_back(frames.middleCols<3>(3 * n).isIdentity(0.0) ? 0 : 1);
  const int node_dofs = 3 * d.node_count(), groups = d.node_count() + d.pressure_node_count();
  const bool continuous = d.pressure_node_count() > 0;
  u.unknown_of_dof.assign(static_cast<std::size_t>(d.dof_count()), -1);
  std::vector<int> first(static_cast<std::size_t>(groups) + 1, 0);  // first unknown of a group
  for (int dof = 0; dof < d.dof_count(); ++dof) {
    const int group = dof < node_dofs ? dof / 3 : d.node_count() + (dof - node_dofs);
    if (dof >= node_dofs || dof % 3 == 0) first[static_cast<std::size_t>(group)] = u.count();
    if (held[static_cast<std::size_t>(dof)]) continue;
    u.unknown_of_dof[static_cast<std::size_t>(dof)] = u.count();
    u.dof_of_unknown.push_back(dof);
    u.groups.block_of_unknown.push_back(group);
    if (continuous) u.groups.constraint.push_back(dof >= node_dofs ? 1 : 0);
  }
  first.back() = u.count();

  // Columns: the rest of the own group, then the later neighbours. Where a neighbour's rows begin within a
  // column of a group's first unknown is kept for the scatter.
  const Neighbourhood near = neighbourhood(d);
  const auto size = [&](int g) {
    return first[static_cast<std::size_t>(g) + 1] - first[static_cast<std::size_t>(g)];
  };
  std::vector<int> offset(near.neighbour.size(), 0);
  u.pattern.n = u.count();
  u.pattern.column_start.assign(1, 0);
  for (int g = 0; g < groups; ++g) {
    int entries = 0;
    for (int i = near.start[static_cast<std::size_t>(g)]; i < near.start[static_cast<std::size_t>(g) + 1];
         ++i) {
      const int h = near.neighbour[static_cast<std::size_t>(i)];
      if (h < g) continue;
      offset[static_cast<std::size_t>(i)] = entries;
      entries += size(h);
    }
    for (int k = 0; k < size(g); ++k) {
      for (int i = near.start[static_cast<std::size_t>(g)]; i < near.start[static_cast<std::size_t>(g) + 1];
           ++i) {
        const int h = near.neighbour[static_cast<std::size_t>(i)];
        for (int r = first[static_cast<std::size_t>(h)] + (h == g ? k : 0);
             h >= g && r < first[static_cast<std::size_t>(h) + 1]; ++r)
          u.pattern.row.push_back(r);
      }
      u.pattern.column_start.push_back(static_cast<int>(u.pattern.row.size()));
    }
  }

  const auto position = [&](int row, int column, int row_group, int column_group) {  // row >= column
    const auto begin = near.neighbour.begin() + near.start[static_cast<std::size_t>(column_group)];
    const auto end = near.neighbour.begin() + near.start[static_cast<std::size_t>(column_group) + 1];
    const auto entry = std::lower_bound(begin, end, row_group) - near.neighbour.begin();
    const int within =
        column - first[static_cast<std::size_t>(column_group)];  // columns of a group shorten one by one
    return u.pattern.column_start[static_cast<std::size_t>(column)] +
           offset[static_cast<std::size_t>(entry)] + (row - first[static_cast<std::size_t>(row_group)]) -
           within;
  };
  const auto entry = [&](int dof_a, int dof_b) {
    int row = u.unknown_of_dof[static_cast<std::size_t>(dof_a)],
        column = u.unknown_of_dof[static_cast<std::size_t>(dof_b)];
    if (row < 0 || column < 0) return -1;
    int row_group = u.groups.block_of_unknown[static_cast<std::size_t>(row)],
        column_group = u.groups.block_of_unknown[static_cast<std::size_t>(column)];
    if (row < column) {
      std::swap(row, column);
      std::swap(row_group, column_group);
    }
    return position(row, column, row_group, column_group);
  };
  const int nodes = d.nodes_per_cell(), pressures = continuous ? d.pressures_per_cell() : 0;
  u.entries_per_cell = 9 * nodes * (nodes + 1) / 2 + 3 * pressures * nodes + pressures * (pressures + 1) / 2;
  u.scatter.reserve(static_cast<std::size_t>(u.entries_per_cell) * static_cast<std::size_t>(d.cell_count()));
  for (int c = 0; c < d.cell_count(); ++c) {
    for (int a = 0; a < nodes; ++a) {
      for (int b = 0; b <= a; ++b) {
        const int na = d.nodes_of_cell()(a, c), nb = d.nodes_of_cell()(b, c);
        for (int i = 0; i < 3; ++i) {
          for (int k = 0; k < 3; ++k)
            u.scatter.push_back(a == b && i < k ? -1 : entry(3 * na + i, 3 * nb + k));
        }
      }
    }
    for (int m = 0; m < pressures; ++m) {
      const int pressure = node_dofs + d.pressure_nodes_of_cell()(m, c);
      for (int b = 0; b < nodes; ++b) {
        for (int k = 0; k < 3; ++k) u.scatter.push_back(entry(pressure, 3 * d.nodes_of_cell()(b, c) + k));
      }
    }
    for (int m = 0; m < pressures; ++m) {
      for (int l = 0; l <= m; ++l)
        u.scatter.push_back(entry(node_dofs + d.pressure_nodes_of_cell()(m, c),
                                  node_dofs + d.pressure_nodes_of_cell()(l, c)));
    }
  }
  return u;
}

Eigen::VectorXd Unknowns::restrict(const Eigen::VectorXd& by_dof) const {
  Eigen::VectorXd x(count());
  for (int i = 0; i < count(); ++i) {
    const int dof = dof_of_unknown[static_cast<std::size_t>(i)], node = dof / 3;
    x[i] = has_frames() && 3 * node < frames.cols() ? frames.col(dof).dot(by_dof.segment<3>(3 * node))
                                                    : by_dof[dof];
  }
  return x;
}

Eigen::VectorXd Unknowns::extend(const Eigen::VectorXd& x) const {
  Eigen::VectorXd by_dof = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(unknown_of_dof.size()));
  for (int i = 0; i < count(); ++i) {
    const int dof = dof_of_unknown[static_cast<std::size_t>(i)], node = dof / 3;
    if (has_frames() && 3 * node < frames.cols()) {
      by_dof.segment<3>(3 * node) += x[i] * frames.col(dof);
    } else {
      by_dof[dof] += x[i];
    }
  }
  return by_dof;
}

}  // namespace brachium::fem
