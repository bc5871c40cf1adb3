#include "data/io/mesh_writer.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <stdexcept>

#include "data/io/atomic_file.hpp"
#include "data/io/hdf5_support.hpp"
#include "data/io/mesh_xdmf.hpp"

namespace brachium::io {
namespace {

using data::CellType;
using data::Mesh;
using hdf5::Handle;

int vtk_type(CellType type) {
  switch (type) {
    case CellType::tet4:
      return 10;
    case CellType::tet10:
      return 24;
    case CellType::hex8:
      return 12;
    case CellType::hex20:
      return 25;
    case CellType::hex27:
      return 29;
  }
  return 0;
}

/// The open file and everything that is written to it.
class VtkHdf {
 public:
  VtkHdf(const std::filesystem::path& temporary, std::filesystem::path target, bool with_steps)
      : target_(std::move(target)) {
    file_ = Handle(H5Fcreate(temporary.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT), H5Fclose);
    need(static_cast<bool>(file_), "the file");
    root_ = group(file_.get(), "VTKHDF");
    const std::int64_t version[2] = {with_steps ? 2 : 1, 0};
    const hsize_t two = 2;
    const Handle space(H5Screate_simple(1, &two, nullptr), H5Sclose);
    const Handle attribute(
        H5Acreate2(root_.get(), "Version", H5T_STD_I64LE, space.get(), H5P_DEFAULT, H5P_DEFAULT), H5Aclose);
    need(attribute && H5Awrite(attribute.get(), H5T_NATIVE_INT64, version) >= 0, "Version");
    // VTK reads this one as fixed-length ASCII only.
    const std::string type_name = "UnstructuredGrid";
    const Handle type(H5Tcopy(H5T_C_S1), H5Tclose), scalar(H5Screate(H5S_SCALAR), H5Sclose);
    H5Tset_size(type.get(), type_name.size());
    const Handle kind(H5Acreate2(root_.get(), "Type", type.get(), scalar.get(), H5P_DEFAULT, H5P_DEFAULT),
                      H5Aclose);
    need(kind && H5Awrite(kind.get(), type.get(), type_name.data()) >= 0, "Type");
    point_data_ = group(root_.get(), "PointData");
    cell_data_ = group(root_.get(), "CellData");
    field_data_ = group(root_.get(), "FieldData");
  }

  void need(bool done, const std::string& what) const {
    if (!done) hdf5::fail_write(file_.get(), target_, what);
  }
  Handle group(hid_t parent, const char* name) const {
    Handle made = hdf5::create_group(parent, name);
    need(static_cast<bool>(made), name);
    return made;
  }
  hid_t root() const { return root_.get(); }
  hid_t data(bool of_points) const { return of_points ? point_data_.get() : cell_data_.get(); }

  void write(hid_t parent, const std::string& name, hid_t file_type, hid_t memory_type, const void* values,
             std::size_t rows, std::size_t columns, const std::string& unit = "") const {
    const hsize_t extent[2] = {rows, columns};
    const Handle space(H5Screate_simple(columns == 0 ? 1 : 2, extent, nullptr), H5Sclose);
    const Handle dataset(
        H5Dcreate2(parent, name.c_str(), file_type, space.get(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT),
        H5Dclose);
    need(dataset &&
             (rows == 0 || H5Dwrite(dataset.get(), memory_type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values) >= 0),
         name);
    if (!unit.empty())
      need(hdf5::write_attribute(dataset.get(), "unit", unit) &&
               hdf5::write_attribute(dataset.get(), "units", unit),
           name);
  }
  void write(hid_t parent, const std::string& name, const std::vector<std::int64_t>& values) const {
    write(parent, name, H5T_STD_I64LE, H5T_NATIVE_INT64, values.data(), values.size(), 0);
  }
  void write(hid_t parent, const std::string& name, const Eigen::MatrixXd& values,
             const std::string& unit) const {
    write(parent, name, H5T_IEEE_F64LE, H5T_NATIVE_DOUBLE, values.data(),
          static_cast<std::size_t>(values.cols()),
          values.rows() == 1 ? 0 : static_cast<std::size_t>(values.rows()), unit);
  }

  /// Puts columns behind what a dataset holds; makes it at the first call.
  void append(bool of_points, const MeshField& field, std::size_t step) const {
    const auto n = static_cast<hsize_t>(field.values.cols()),
               columns = static_cast<hsize_t>(field.values.rows());
    const int rank = columns == 1 ? 1 : 2;
    const hsize_t block[2] = {n, columns}, start[2] = {step * n, 0}, extent[2] = {(step + 1) * n, columns};
    if (step == 0) {
      const hsize_t limit[2] = {H5S_UNLIMITED, columns};
      const Handle space(H5Screate_simple(rank, block, limit), H5Sclose),
          list(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
      H5Pset_chunk(list.get(), rank, block);
      const Handle made(H5Dcreate2(data(of_points), field.name.c_str(), H5T_IEEE_F64LE, space.get(),
                                   H5P_DEFAULT, list.get(), H5P_DEFAULT),
                        H5Dclose);
      need(made && hdf5::write_attribute(made.get(), "unit", field.unit) &&
               hdf5::write_attribute(made.get(), "units", field.unit),
           field.name);
    }
    const Handle dataset(H5Dopen2(data(of_points), field.name.c_str(), H5P_DEFAULT), H5Dclose);
    need(dataset && H5Dset_extent(dataset.get(), extent) >= 0, field.name);
    const Handle space(H5Dget_space(dataset.get()), H5Sclose),
        memory(H5Screate_simple(rank, block, nullptr), H5Sclose);
    H5Sselect_hyperslab(space.get(), H5S_SELECT_SET, start, nullptr, block, nullptr);
    need(H5Dwrite(dataset.get(), H5T_NATIVE_DOUBLE, memory.get(), space.get(), H5P_DEFAULT,
                  field.values.data()) >= 0,
         field.name);
  }

  void mesh(const Mesh& mesh) const {
    const std::int64_t points = mesh.point_count(), cells = mesh.cell_count(),
                       nodes = data::nodes_per_cell(mesh.type);
    write(root(), "NumberOfPoints", {points});
    write(root(), "NumberOfCells", {cells});
    write(root(), "NumberOfConnectivityIds", {cells * nodes});
    write(root(), "Points", Eigen::MatrixXd(mesh.points), "m");
    write(root(), "Connectivity",
          std::vector<std::int64_t>(mesh.cells.reshaped().begin(), mesh.cells.reshaped().end()));
    std::vector<std::int64_t> offsets;
    for (std::int64_t c = 0; c <= cells; ++c) offsets.push_back(c * nodes);
    write(root(), "Offsets", offsets);
    const std::vector<std::uint8_t> types(static_cast<std::size_t>(cells),
                                          static_cast<std::uint8_t>(vtk_type(mesh.type)));
    write(root(), "Types", H5T_STD_U8LE, H5T_NATIVE_UINT8, types.data(), types.size(), 0);
    write(data(false), "region", H5T_STD_I32LE, H5T_NATIVE_INT32, mesh.region_of_cell.data(),
          mesh.region_of_cell.size(), 0, "1");
    const Handle region(H5Dopen2(data(false), "region", H5P_DEFAULT), H5Dclose);
    need(region &&
             hdf5::write_attribute(
                 region.get(), "names",
                 nlohmann::json(mesh.regions).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace)),
         "region");
    for (const auto& [name, field] : mesh.point_fields) write(data(true), name, field, "1");
    for (const auto& [name, field] : mesh.cell_fields) {
      if (name != "region") write(data(false), name, field, "1");
    }
  }

  /// Single steps of what append() wrote, as virtual datasets XDMF/<step>/PointData/<name>: readers of XDMF
  /// that know no slabs find them there.
  void step_views(const std::vector<MeshField>& fields, bool of_points, std::size_t steps) const {
    const Handle top = H5Lexists(file_.get(), "XDMF", H5P_DEFAULT) > 0
                           ? Handle(H5Gopen2(file_.get(), "XDMF", H5P_DEFAULT), H5Gclose)
                           : group(file_.get(), "XDMF");
    for (std::size_t k = 0; k < steps; ++k) {
      const std::string number = std::to_string(k);
      const Handle step = H5Lexists(top.get(), number.c_str(), H5P_DEFAULT) > 0
                              ? Handle(H5Gopen2(top.get(), number.c_str(), H5P_DEFAULT), H5Gclose)
                              : group(top.get(), number.c_str());
      const Handle place = group(step.get(), of_points ? "PointData" : "CellData");
      for (const MeshField& f : fields) {
        const auto n = static_cast<hsize_t>(f.values.cols()), columns = static_cast<hsize_t>(f.values.rows());
        const int rank = columns == 1 ? 1 : 2;
        const hsize_t block[2] = {n, columns}, start[2] = {k * n, 0}, all[2] = {steps * n, columns};
        const Handle view(H5Screate_simple(rank, block, nullptr), H5Sclose),
            source(H5Screate_simple(rank, all, nullptr), H5Sclose);
        H5Sselect_hyperslab(source.get(), H5S_SELECT_SET, start, nullptr, block, nullptr);
        const Handle list(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
        const std::string path = fmt::format("/VTKHDF/{}/{}", of_points ? "PointData" : "CellData", f.name);
        need(H5Pset_virtual(list.get(), view.get(), ".", path.c_str(), source.get()) >= 0, f.name);
        const Handle made(H5Dcreate2(place.get(), f.name.c_str(), H5T_IEEE_F64LE, view.get(), H5P_DEFAULT,
                                     list.get(), H5P_DEFAULT),
                          H5Dclose);
        need(made && hdf5::write_attribute(made.get(), "unit", f.unit), f.name);
      }
    }
  }

  /// When each step is, and where its values start in every dataset; the mesh stays where it is.
  void steps(const std::vector<double>& times, const Mesh& mesh,
             const std::vector<std::string>& moving_points,
             const std::vector<std::string>& moving_cells) const {
    const Handle steps = group(root(), "Steps");
    const std::size_t n = times.size();
    need(hdf5::write_attribute(steps.get(), "NSteps", static_cast<long long>(n)), "NSteps");
    write(steps.get(), "Values", H5T_IEEE_F64LE, H5T_NATIVE_DOUBLE, times.data(), n, 0);
    const std::vector<std::int64_t> zeros(n, 0), ones(n, 1);
    write(steps.get(), "PartOffsets", zeros);
    write(steps.get(), "NumberOfParts", ones);
    write(steps.get(), "PointOffsets", zeros);
    for (const char* name : {"CellOffsets", "ConnectivityIdOffsets"})
      write(steps.get(), name, H5T_STD_I64LE, H5T_NATIVE_INT64, zeros.data(), n, 1);
    for (const bool of_points : {true, false}) {
      const Handle offsets = group(steps.get(), of_points ? "PointDataOffsets" : "CellDataOffsets");
      std::vector<std::int64_t> moving(n);
      for (std::size_t k = 0; k < n; ++k)
        moving[k] = static_cast<std::int64_t>(k) * (of_points ? mesh.point_count() : mesh.cell_count());
      for (const std::string& name : of_points ? moving_points : moving_cells)
        write(offsets.get(), name, moving);
      for (const auto& [name, field] : of_points ? mesh.point_fields : mesh.cell_fields) {
        if (of_points || name != "region") write(offsets.get(), name, zeros);
      }
      if (!of_points) write(offsets.get(), "region", zeros);
    }
  }

  void close() {
    for (Handle* h : {&point_data_, &cell_data_, &field_data_, &root_}) h->close();
    need(H5Fflush(file_.get(), H5F_SCOPE_GLOBAL) >= 0, "the last values");
    need(file_.close(), "the last values");
  }
  /// The file will be thrown away.
  void abandon() {
    hdf5::divert(file_.get());
    for (Handle* h : {&point_data_, &cell_data_, &field_data_, &root_, &file_}) h->close();
  }

 private:
  std::filesystem::path target_;
  Handle file_, root_, point_data_, cell_data_, field_data_;
};

void check_mesh(const Mesh& mesh) {
  auto findings = data::check_structure(mesh);
  if (!findings.empty()) throw data::InputError(std::move(findings));
  for (const auto* fields : {&mesh.point_fields, &mesh.cell_fields}) {
    for (const auto& [name, field] : *fields) hdf5::check_name(name, "field");
  }
}

void check_fields(const Mesh& mesh, const std::vector<MeshField>& points,
                  const std::vector<MeshField>& cells) {
  for (const auto* list : {&points, &cells}) {
    const bool of_points = list == &points;
    std::set<std::string> taken{of_points ? "" : "region"};
    for (const auto& [name, field] : of_points ? mesh.point_fields : mesh.cell_fields) taken.insert(name);
    for (const MeshField& f : *list) {
      hdf5::check_name(f.name, "field");
      if (f.values.cols() != (of_points ? mesh.point_count() : mesh.cell_count()) || f.values.rows() < 1)
        throw std::logic_error("mesh writer: field `" + f.name + "` does not have the size of the mesh");
      if (!f.values.allFinite()) throw std::logic_error("mesh writer: field `" + f.name + "` is not finite");
      if (!taken.insert(f.name).second)
        throw std::logic_error("mesh writer: field `" + f.name + "` stands twice");
    }
  }
}

std::vector<std::string> names_of(const std::vector<MeshField>& fields) {
  std::vector<std::string> names;
  for (const MeshField& f : fields) names.push_back(f.name);
  return names;
}

}  // namespace

struct MeshSeriesWriter::State {
  State(const std::filesystem::path& path, const Mesh& m) : mesh(m), file(path) {
    const hdf5::Lock lock;
    hdf.emplace(file.temporary(), file.target(), true);
    try {
      hdf->mesh(mesh);
    } catch (...) {
      hdf->abandon();  // while the lock is held
      hdf.reset();
      throw;
    }
  }
  ~State() {
    if (!hdf) return;
    const hdf5::Lock lock;
    hdf->abandon();
    hdf.reset();
  }
  State(const State&) = delete;
  State& operator=(const State&) = delete;

  Mesh mesh;
  AtomicFile file;
  std::optional<VtkHdf> hdf;
  std::vector<double> times;
  MeshStep first;  ///< names, units and components that every step must have
};

MeshSeriesWriter::MeshSeriesWriter(const std::filesystem::path& file, const Mesh& mesh) {
  check_mesh(mesh);
  state_ = std::make_unique<State>(file, mesh);
}
MeshSeriesWriter::~MeshSeriesWriter() = default;
MeshSeriesWriter::MeshSeriesWriter(MeshSeriesWriter&&) noexcept = default;
MeshSeriesWriter& MeshSeriesWriter::operator=(MeshSeriesWriter&&) noexcept = default;

void MeshSeriesWriter::add(const MeshStep& step) {
  State& s = *state_;
  check_fields(s.mesh, step.point_fields, step.cell_fields);
  if (s.times.empty()) {
    s.first = step;
  } else {
    const auto same = [](const std::vector<MeshField>& a, const std::vector<MeshField>& b) {
      return std::ranges::equal(a, b, [](const MeshField& x, const MeshField& y) {
        return x.name == y.name && x.unit == y.unit && x.values.rows() == y.values.rows();
      });
    };
    if (!same(s.first.point_fields, step.point_fields) || !same(s.first.cell_fields, step.cell_fields))
      throw std::logic_error("mesh writer: the fields of a step are not those of the first");
    if (!(step.time > s.times.back()))
      throw std::logic_error("mesh writer: the time of a step does not rise");
  }
  const hdf5::Lock lock;
  for (const MeshField& f : step.point_fields) s.hdf->append(true, f, s.times.size());
  for (const MeshField& f : step.cell_fields) s.hdf->append(false, f, s.times.size());
  s.times.push_back(step.time);
}

void MeshSeriesWriter::finish() {
  State& s = *state_;
  {
    const hdf5::Lock lock;
    s.hdf->steps(s.times, s.mesh, names_of(s.first.point_fields), names_of(s.first.cell_fields));
    s.hdf->step_views(s.first.point_fields, true, s.times.size());
    s.hdf->step_views(s.first.cell_fields, false, s.times.size());
    s.hdf->close();
    s.hdf.reset();
  }
  s.file.commit();
  std::filesystem::path xdmf = s.file.target();
  xdmf.replace_extension(".xdmf");
  write_text_atomically(xdmf, xdmf_text(s.file.target().filename().string(), s.mesh, s.times, s.first));
}

void write_vtkhdf(const std::filesystem::path& file, const Mesh& mesh,
                  const std::vector<MeshField>& point_fields, const std::vector<MeshField>& cell_fields) {
  check_mesh(mesh);
  check_fields(mesh, point_fields, cell_fields);
  AtomicFile target(file);
  {
    const hdf5::Lock lock;
    VtkHdf hdf(target.temporary(), target.target(), false);
    hdf.mesh(mesh);
    for (const MeshField& f : point_fields) hdf.write(hdf.data(true), f.name, f.values, f.unit);
    for (const MeshField& f : cell_fields) hdf.write(hdf.data(false), f.name, f.values, f.unit);
    hdf.close();
  }
  target.commit();
}

}  // namespace brachium::io
