#include "fem/mesh/block.hpp"

#include <algorithm>

#include "data/model/error.hpp"
#include "fem/mesh/convert.hpp"
#include "fem/mesh/section.hpp"

namespace brachium::fem {

data::Mesh block(const BlockOptions& options) {
  std::vector<double> x;
  std::vector<int> region_of_column;
  SweepNames names;
  std::vector<Slab> slabs = options.slabs;
  if (slabs.empty()) slabs.push_back({options.region, options.x});
  for (const Slab& slab : slabs) {
    const auto part = positions(slab.x, "block: x");
    const double start = x.empty() ? 0.0 : x.back();
    if (x.empty()) x.push_back(0.0);
    for (std::size_t i = 1; i < part.size(); ++i) x.push_back(start + part[i]);
    const auto known = std::ranges::find(names.regions, slab.region) - names.regions.begin();
    if (known == std::ssize(names.regions)) names.regions.push_back(slab.region);
    region_of_column.insert(region_of_column.end(), part.size() - 1, static_cast<int>(known));
  }
  names.region = [&](auto tag, int) { return region_of_column[static_cast<std::size_t>(tag[0])]; };
  names.first = [](auto, int) { return std::vector<std::string>{"z0"}; };
  names.last = [](auto, int) { return std::vector<std::string>{"z1"}; };
  names.side = [](auto, int edge, int) {
    constexpr const char* sides[4] = {"y0", "x1", "y1", "x0"};
    return std::vector<std::string>{sides[edge]};
  };
  const Section section = grid_section(x, positions(options.y, "block: y"));
  const Eigen::Vector3d corner = options.corner_m;
  data::Mesh mesh = sweep(
      section, positions(options.z, "block: z"),
      [&](double u, double v, double w) -> Eigen::Vector3d { return corner + Eigen::Vector3d(u, v, w); },
      names);
  std::ranges::sort(mesh.surfaces, {}, &data::NamedSurface::name);
  if (options.fibre) {
    if (!options.fibre->allFinite() || !(options.fibre->norm() > 0.0))
      throw data::InputError("bad-mesh-option", "block: the fibre direction has no length");
    mesh.cell_fields["fibre"] = options.fibre->normalized().replicate(1, mesh.cell_count());
  }
  return as_type(std::move(mesh), options.type);
}

data::Mesh block(const Eigen::Vector3d& size_m, int nx, int ny, int nz, data::CellType type) {
  BlockOptions options;
  options.type = type;
  options.x = {size_m.x(), nx};
  options.y = {size_m.y(), ny};
  options.z = {size_m.z(), nz};
  return block(options);
}

}  // namespace brachium::fem
