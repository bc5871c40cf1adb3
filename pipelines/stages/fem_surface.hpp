#pragma once
/// The surface of a mesh as triangles, with the fields that the report's 3D view colours; as tables, so that
/// a report can be drawn again and others can read them.
///
/// | table             | rows                           | columns                                              |
/// |-------------------|--------------------------------|------------------------------------------------------|
/// | surface_points    | points of the surface          | point (index into the mesh), x_m y_m z_m, undeformed |
/// | surface_triangles | triangles, region by region    | region (index), a b c (rows of surface_points)       |
/// | surface_edges     | sides of cells                 | region, a b                                          |
/// | surface_states    | state by state, point by point | state, x_m y_m z_m deformed, fields                  |

#include <map>
#include <string>
#include <vector>

#include "data/model/mesh.hpp"
#include "data/model/table.hpp"
#include "fem/quantities/quantities.hpp"
#include "pipelines/report/document.hpp"

namespace brachium::pipelines {

class FemSurface {
 public:
  explicit FemSurface(const data::Mesh& mesh);

  /// The first three tables.
  std::map<std::string, data::Table> tables() const;
  /// Rows of surface_states for one state. `at_points`: fields by name at all points of the mesh, one row
  /// each.
  data::Table state(int state, const fem::Configuration& configuration,
                    const std::vector<std::pair<std::string, Eigen::VectorXd>>& at_points) const;

 private:
  const data::Mesh& mesh_;
  std::vector<int> points_;  ///< of the mesh, ascending
  data::Table triangles_, edges_;
};

/// Fields of one state at the points of the mesh, in the order in which a reader chooses among them:
/// fibre_stretch, fibre_stress_pa (where there are fibres), von_mises_pa, pressure_pa, jacobian.
std::vector<std::pair<std::string, Eigen::VectorXd>> fields_at_points(
    const fem::Problem& problem, const fem::Discretisation& discretisation, const fem::PointFields& fields);

/// The view of those tables; lengths in mm, stresses in kPa. `labels`: one a state.
report::View3d surface_view(const std::map<std::string, data::Table>& tables,
                            const std::vector<std::string>& regions, const std::vector<std::string>& labels);

}  // namespace brachium::pipelines
