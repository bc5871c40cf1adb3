/// Damaged files of every text format: a reader gives numbers or an InputError, never a crash, never NaN,
/// never another exception. The mutations are the same in every run.

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "data/io/csv.hpp"
#include "data/io/mesh_file.hpp"
#include "data/io/noraxon.hpp"
#include "data/io/opensim_file.hpp"
#include "data/io/session_description.hpp"
#include "data/io/session_file.hpp"
#include "data/io/subject_file.hpp"
#include "tests/data/io/io_test_support.hpp"
#include "tests/support/paths.hpp"

namespace brachium::io {
namespace {

/// One deterministic damage: cut, flipped bytes, a line lost, doubled or swapped, a foreign piece put in.
std::string damaged(const std::string& text, unsigned seed) {
  std::mt19937 random(seed);
  std::string out = text;
  const auto place = [&] { return out.empty() ? 0 : static_cast<std::size_t>(random() % out.size()); };
  static const std::string pieces[] = {"nan",
                                       "-inf",
                                       "1e999",
                                       "\"",
                                       ",,,,",
                                       "\t\t",
                                       "\n\n",
                                       "=",
                                       "[[",
                                       "{x}",
                                       "endheader\n",
                                       "-",
                                       "0x1p3",
                                       "9999999999999999999999",
                                       std::string(1, '\0'),
                                       "\xFF\xFE",
                                       "time",
                                       "\r"};
  const unsigned times = 1 + random() % 3;
  for (unsigned n = 0; n < times; ++n) {
    switch (random() % 6) {
      case 0:
        out.resize(place());
        break;
      case 1:
        out[place()] = static_cast<char>(random() % 256);
        break;
      case 2:
        out.insert(place(), pieces[random() % std::size(pieces)]);
        break;
      case 3: {
        const std::size_t at = place();
        out.erase(at, random() % 40);
        break;
      }
      case 4: {
        const std::size_t from = out.find('\n', place());
        if (from != std::string::npos) out += out.substr(from, 60);
        break;
      }
      default: {
        const std::size_t a = place(), b = place();
        if (!out.empty()) std::swap(out[a], out[b]);
      }
    }
    if (out.empty()) out = "x";
  }
  return out;
}

/// Runs `read` on the damaged text; counts how often it was refused.
template <class Read>
void survive(const std::string& file_name, const std::string& text, unsigned rounds, Read read) {
  const auto dir = tests::scratch_dir();
  unsigned refused = 0;
  for (unsigned seed = 0; seed < rounds; ++seed) {
    const auto file = tests::write_file(dir / file_name, damaged(text, seed));
    try {
      read(file);
    } catch (const data::InputError& error) {
      ++refused;
      EXPECT_FALSE(error.diagnostics().empty());
      EXPECT_FALSE(data::render(error.diagnostics()).empty());
    } catch (const std::exception& error) {
      ADD_FAILURE() << "seed " << seed << ": " << error.what();
    }
  }
  EXPECT_GT(refused, rounds / 10);
}

void expect_finite(const std::vector<data::Signal>& signals) {
  for (const data::Signal& s : signals) {
    EXPECT_TRUE(s.info.rate_hz > 0.0 && std::isfinite(s.info.rate_hz));
    for (const double v : s.samples) ASSERT_TRUE(std::isfinite(v));
  }
}

std::string rows(const std::string& delimiter, int columns) {
  std::string text;
  for (int i = 0; i < 30; ++i) {
    text += std::to_string(i / 10.0);
    for (int c = 1; c < columns; ++c) text += delimiter + std::to_string(i * c - 7.25);
    text += "\n";
  }
  return text;
}

TEST(Fuzz, Csv) {
  survive("a.csv", "time,a,\"b\"\ns,uV,deg\n" + rows(",", 3), 1500, [](const auto& file) {
    CsvLayout layout;
    layout.units_row = 2;
    layout.time_column = "time";
    Recording recording = open_csv(file, layout);
    expect_finite(read_all(recording));
  });
}

TEST(Fuzz, Noraxon) {
  survive("a.csv",
          "\xEF\xBB\xBFtype,name,time_units,begin_time,frequency,count,units\nsignal_3d,\"x\",\"s\",0.0,10,"
          "30,\"mm\"\n\ntime,x,y,z\n" +
              rows(",", 4),
          1500, [](const auto& file) {
            Recording recording = open_noraxon(file);
            expect_finite(read_all(recording));
          });
}

TEST(Fuzz, Storage) {
  survive(
      "a.sto",
      "Results\nversion=1\nnRows=30\nnColumns=3\ninDegrees=yes\n\nUnits are S.I.\nendheader\ntime\ta\tb\n" +
          rows("\t", 3),
      1500, [](const auto& file) {
        Recording recording = open_storage(file);
        expect_finite(read_all(recording));
      });
}

TEST(Fuzz, StorageWithBridgedTimeStamps) {
  survive("a.sto", "Results\nendheader\ntime\ta\tb\n" + rows("\t", 3), 1000, [](const auto& file) {
    Recording recording = open_storage(file);
    expect_finite(read_all(recording, {.rule = TimingRule::interpolate, .rate_hz = 10.0}));
  });
}

TEST(Fuzz, SessionDescription) {
  const std::string text = tests::slurp(tests::source_dir() / "pipelines/sessions/elbow_curls.toml");
  ASSERT_FALSE(text.empty());
  survive("s.toml", text, 600, [](const auto& file) {
    const SessionDescription description = read_session_description(file);
    check_session(description);
  });
}

TEST(Fuzz, Subject) {
  data::Subject subject;
  subject.name = "s";
  subject.muscles.push_back({"B", "flexors", {600.0, 0.1, 0.2, 0.1, 10.0, 0.1, 1.0}, {}});
  subject.verdicts.push_back(
      {"B", "strength", "1", 1.0, 1.1, 0.5, 2.0, 0.1, 0.9, 1.3, 0.0, "identified", ""});
  survive("s.toml", subject_to_toml(subject), 1000, [](const auto& file) { read_subject(file); });
}

/// Damages the sample and reads it; what is read nevertheless must be a sound mesh of finite numbers.
void survive_mesh(const std::string& sample, unsigned rounds) {
  SCOPED_TRACE(sample);
  const std::string bytes = tests::slurp(tests::source_dir() / "tests/data/io/meshes" / sample);
  ASSERT_FALSE(bytes.empty());
  MeshReadOptions options;
  options.length_unit = "mm";
  survive(sample, bytes, rounds, [&](const auto& file) {
    const data::Mesh mesh = read_mesh(file, options).mesh;
    EXPECT_TRUE(data::check_structure(mesh).empty());
    for (const auto* fields : {&mesh.point_fields, &mesh.cell_fields}) {
      for (const auto& [name, field] : *fields) EXPECT_TRUE(field.allFinite()) << name;
    }
  });
}

TEST(Fuzz, GmshMeshes) {
  for (const char* name : {"hex8_22.msh", "hex27_22_binary.msh", "tet10_41.msh", "hex20_41_binary.msh"})
    survive_mesh(name, 500);
}

TEST(Fuzz, VtkMeshes) {
  for (const char* name :
       {"hex27_ascii.vtu", "hex27_inline_zlib.vtu", "hex27_appended.vtu", "hex27_raw_zlib.vtu",
        "hex27_raw.vtu", "hex27_42.vtk", "hex27_42_binary.vtk", "hex27_51.vtk", "hex20_51_binary.vtk"})
    survive_mesh(name, 300);
}

TEST(Fuzz, FebioMeshes) {
  for (const char* name : {"hex8_25.feb", "hex20_30.feb", "hex27_40.feb"}) survive_mesh(name, 400);
}

TEST(Fuzz, CutMeshFilesAreRefused) {
  // A cut that takes nothing but blanks or the last end tag of a section that is not needed may go unnoticed.
  MeshReadOptions options;
  options.length_unit = "mm";
  const auto dir = tests::scratch_dir();
  for (const std::string name : {"hex8_22.msh", "hex27_22_binary.msh", "tet10_41.msh", "hex20_41_binary.msh",
                                 "hex27_raw_zlib.vtu", "hex27_inline.vtu", "hex27_40.feb"}) {
    const std::string bytes = tests::slurp(tests::source_dir() / "tests/data/io/meshes" / name);
    for (std::size_t n = 0; n < 200; ++n) {
      const auto file = tests::write_file(dir / name, bytes.substr(0, (bytes.size() - 4) * n / 200));
      EXPECT_THROW(read_mesh(file, options), data::InputError) << name << ' ' << n;
    }
  }
}

TEST(Fuzz, CutSessionFiles) {
  const auto dir = tests::scratch_dir();
  write_session(tests::small_session(), dir / "s.h5");
  const std::string bytes = tests::slurp(dir / "s.h5");
  for (std::size_t n = 0; n < 300; ++n) {
    tests::write_file(dir / "cut.h5", bytes.substr(0, bytes.size() * n / 300));
    EXPECT_THROW(read_session(dir / "cut.h5"), data::InputError) << n;
  }
}

}  // namespace
}  // namespace brachium::io
