#include "data/io/mesh_writer.hpp"

#include <cstdlib>

#include "data/io/mesh_file.hpp"
#include "tests/data/io/io_test_support.hpp"
#include "tests/support/paths.hpp"

namespace brachium::io {
namespace {

using data::CellType;
using data::Mesh;

Mesh sample(CellType type) {
  MeshReadOptions options;
  options.length_unit = "m";
  return read_gmsh(tests::source_dir() / "tests/data/io/meshes" / (data::to_string(type) + "_41.msh"),
                   options)
      .mesh;
}

/// Values that tell step, place and component apart.
MeshStep step(const Mesh& mesh, int k) {
  MeshStep s;
  s.time = 0.5 * k;
  Eigen::MatrixXd u(3, mesh.point_count());
  for (int p = 0; p < mesh.point_count(); ++p)
    u.col(p) << 1000 * k + p, mesh.points(0, p), -mesh.points(1, p);
  s.point_fields = {{"displacement", "m", u},
                    {"pressure", "Pa", Eigen::MatrixXd::Constant(1, mesh.point_count(), 7.0 + k)}};
  s.cell_fields = {{"stretch", "1", Eigen::MatrixXd::Constant(1, mesh.cell_count(), 1.0 + 0.1 * k)}};
  return s;
}

void write_series(const std::filesystem::path& file, const Mesh& mesh) {
  MeshSeriesWriter writer(file, mesh);
  for (int k = 0; k < 3; ++k) writer.add(step(mesh, k));
  writer.finish();
}

class MeshWriter : public ::testing::Test {
 protected:
  std::filesystem::path dir = tests::scratch_dir();
};

TEST_F(MeshWriter, SeriesAndStaticFilesAreReadByPythonThroughBothLayouts) {
  std::string files;
  for (const CellType type :
       {CellType::tet4, CellType::tet10, CellType::hex8, CellType::hex20, CellType::hex27}) {
    Mesh mesh = sample(type);
    mesh.cell_fields["fibre"] = Eigen::Vector3d::UnitX().replicate(1, mesh.cell_count());
    files += " " + (dir / (data::to_string(type) + ".vtkhdf")).string();
    write_series(dir / (data::to_string(type) + ".vtkhdf"), mesh);
  }
  const Mesh mesh = sample(CellType::hex27);
  const MeshStep s = step(mesh, 0);
  write_vtkhdf(dir / "hex27_static.vtkhdf", mesh, s.point_fields, s.cell_fields);
  files += " " + (dir / "hex27_static.vtkhdf").string();
  const std::string log = (dir / "log").string();
  const std::string script = (tests::source_dir() / "tests/data/io/read_mesh_series.py").string();
  const int status = std::system(("/usr/bin/python3 " + script + files + " > " + log + " 2>&1").c_str());
  if (WEXITSTATUS(status) == 77 || WEXITSTATUS(status) == 127) GTEST_SKIP() << "needs python3 with h5py";
  EXPECT_EQ(status, 0) << tests::slurp(log);
}

TEST_F(MeshWriter, NothingIsLeftBehindUnlessFinished) {
  {
    MeshSeriesWriter writer(dir / "series.vtkhdf", sample(CellType::hex8));
    writer.add(step(sample(CellType::hex8), 0));
  }
  EXPECT_TRUE(std::filesystem::is_empty(dir));
  write_series(dir / "series.vtkhdf", sample(CellType::hex8));
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(dir), {}), 2);
}

TEST_F(MeshWriter, StepsThatDoNotFitAreTheProgramsMistake) {
  const Mesh mesh = sample(CellType::hex8);
  MeshSeriesWriter writer(dir / "series.vtkhdf", mesh);
  writer.add(step(mesh, 1));
  EXPECT_THROW(writer.add(step(mesh, 1)), std::logic_error);  // time does not rise
  MeshStep wrong = step(mesh, 2);
  wrong.point_fields[0].unit = "mm";
  EXPECT_THROW(writer.add(wrong), std::logic_error);
  wrong = step(mesh, 2);
  wrong.point_fields[1].values(0, 3) = std::nan("");
  EXPECT_THROW(writer.add(wrong), std::logic_error);
  wrong = step(mesh, 2);
  wrong.cell_fields[0].values.resize(1, 5);
  EXPECT_THROW(writer.add(wrong), std::logic_error);
}

TEST_F(MeshWriter, MissingFolderIsTheUsersMistake) {
  EXPECT_THROW(MeshSeriesWriter(dir / "none" / "a.vtkhdf", sample(CellType::hex8)), data::InputError);
}

}  // namespace
}  // namespace brachium::io
