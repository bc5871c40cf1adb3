#include "data/io/session_file.hpp"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <hdf5.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <limits>
#include <memory>
#include <thread>

#include "tests/data/io/io_test_support.hpp"
#include "tests/support/paths.hpp"

namespace brachium::io {
namespace {

using data::InputError;
using testing::HasSubstr;
using tests::error_of;
using tests::expect_equal;
using tests::make_signal;
using tests::scratch_dir;
using tests::small_session;

std::size_t files_in(const std::filesystem::path& folder) {
  return static_cast<std::size_t>(std::distance(std::filesystem::directory_iterator(folder), {}));
}

TEST(SessionFile, RoundTripIsExact) {
  const auto file = scratch_dir() / "s.h5";
  write_session(small_session(), file);
  expect_equal(small_session(), read_session(file));
}

TEST(SessionFile, TrialsAndSignalsKeepTheOrderTheyWereWrittenIn) {
  const auto file = scratch_dir() / "s.h5";
  write_session(small_session(), file);
  const SessionFile source(file);
  EXPECT_EQ(source.info().trials[0].name, "mvc-1");
  EXPECT_EQ(source.info().trials[0].signals[0].name, "z_last_by_name");
  EXPECT_EQ(source.info().trials[0].signals[2].name, "a_first_by_name");
}

TEST(SessionFile, ReadsAnyPieceOfASignal) {
  const auto file = scratch_dir() / "s.h5";
  const data::Session session = small_session();
  SessionFileWriter writer(file, {.deflate_level = 4, .chunk_samples = 256});
  data::store(session, writer);
  writer.commit();
  const SessionFile source(file);
  for (const auto& [first, count] :
       {std::pair<std::size_t, std::size_t>{0, 1}, {250, 20}, {4999, 1}, {1000, 3000}}) {
    std::vector<double> piece(count);
    source.read(0, 0, first, piece);
    for (std::size_t i = 0; i < count; ++i)
      ASSERT_EQ(piece[i], session.trials[0].signals[0].samples[first + i]);
  }
  std::vector<double> piece(2);
  EXPECT_THROW(source.read(0, 0, 4999, piece), std::out_of_range);
}

TEST(SessionFile, ChunksMayBeWrittenInAnyOrder) {
  const auto file = scratch_dir() / "s.h5";
  const data::Session session = small_session();
  const data::Signal& signal = session.trials[0].signals[0];
  SessionFileWriter writer(file, {.deflate_level = 1, .chunk_samples = 1000});
  const data::SessionInfo info = data::info_of(session);
  writer.begin(info);
  writer.begin_trial(info.trials[0]);
  writer.begin_signal("mvc-1", signal.info);
  for (const std::size_t first : {std::size_t{2500}, std::size_t{0}}) {
    writer.write_samples("mvc-1", signal.info.name, first, std::span(signal.samples).subspan(first, 2500));
  }
  writer.commit();
  EXPECT_EQ(SessionFile(file).signal("mvc-1", signal.info.name).samples, signal.samples);
}

TEST(SessionFile, OpensInH5pyAndXarrayAsItIs) {
  const auto file = scratch_dir() / "s.h5";
  write_session(small_session(), file);
  const std::string command = "/usr/bin/python3 " +
                              (tests::source_dir() / "tests/data/io/read_session.py").string() + " " +
                              file.string() + " > " + file.string() + ".log 2>&1";
  const int status = std::system(command.c_str());
  if (WEXITSTATUS(status) == 77 || WEXITSTATUS(status) == 127) {
    GTEST_SKIP() << "needs python3 with h5py, xarray and h5netcdf: " << tests::slurp(file.string() + ".log");
  }
  EXPECT_EQ(status, 0) << tests::slurp(file.string() + ".log");
}

TEST(SessionFile, ThreadsMayReadAtOnce) {
  const auto file = scratch_dir() / "s.h5";
  const data::Session session = small_session();
  write_session(session, file);
  const SessionFile source(file);
  std::vector<std::thread> threads;
  std::atomic<int> wrong{0};
  for (int t = 0; t < 4; ++t) {
    threads.emplace_back([&] {
      for (std::size_t i = 0; i < 50; ++i) {
        const std::size_t s = i % 3;
        if (source.read(0, s) != session.trials[0].signals[s].samples) ++wrong;
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(wrong, 0);
}

TEST(SessionFileWriter, NothingIsLeftWithoutCommit) {
  const auto dir = scratch_dir();
  {
    SessionFileWriter writer(dir / "s.h5");
    data::store(small_session(), writer);
    EXPECT_FALSE(std::filesystem::exists(dir / "s.h5"));
  }
  EXPECT_EQ(files_in(dir), 0u);
}

TEST(SessionFileWriter, TheOldFileStandsUntilCommit) {
  const auto dir = scratch_dir();
  write_session(small_session(), dir / "s.h5");
  data::Session other = small_session();
  other.subject = "other";
  {
    SessionFileWriter writer(dir / "s.h5");
    data::store(other, writer);
    EXPECT_EQ(read_session(dir / "s.h5").subject, small_session().subject);
    writer.commit();
  }
  EXPECT_EQ(read_session(dir / "s.h5").subject, "other");
  EXPECT_EQ(files_in(dir), 1u);
}

TEST(SessionFileWriter, RemainsOfAKilledProcessAreNeitherTrustedNorKept) {
  const auto dir = scratch_dir();
  const pid_t child = ::fork();
  if (child == 0) {
    SessionFileWriter writer(dir / "s.h5");
    data::store(small_session(), writer);
    ::kill(::getpid(), SIGKILL);
  }
  int status = 0;
  ::waitpid(child, &status, 0);
  ASSERT_TRUE(WIFSIGNALED(status));
  EXPECT_FALSE(std::filesystem::exists(dir / "s.h5"));
  EXPECT_EQ(files_in(dir), 1u);
  write_session(small_session(), dir / "s.h5");
  EXPECT_EQ(files_in(dir), 1u);
  expect_equal(small_session(), read_session(dir / "s.h5"));
}

/// Runs `action` in a process of its own; true if that ended, by its own exit, with the action's true.
bool in_child(const std::function<bool()>& action) {
  const pid_t child = ::fork();
  if (child == 0) std::exit(action() ? 0 : 1);
  int status = 0;
  ::waitpid(child, &status, 0);
  return WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

// The limit on a file's size stands for a full disk: writes fail in the same places. The process must end in
// peace, wherever the disk was full.
TEST(SessionFileWriter, AFullDiskIsNamedAndLeavesNothing) {
  const auto dir = scratch_dir();
  for (const rlim_t bytes : {500u, 3000u, 50'000u, 200'000u, 1'000'000u, 2'402'000u}) {
    for (const int level : {0, 1}) {
      if (level == 1 && bytes > 1'000'000) continue;  // deflated, the whole file would fit
      EXPECT_TRUE(in_child([&] {
        ::signal(SIGXFSZ, SIG_IGN);
        rlimit limit{};
        ::getrlimit(RLIMIT_FSIZE, &limit);
        const rlimit full{bytes, limit.rlim_max};
        SessionFileWriter::Options options;
        options.deflate_level = level;
        std::unique_ptr<SessionFileWriter> writer;
        bool named = false;
        ::setrlimit(RLIMIT_FSIZE, &full);
        try {
          writer = std::make_unique<SessionFileWriter>(dir / "s.h5", options);
          data::Session session = small_session();
          session.trials[0].signals[0] = make_signal("long", data::Quantity::emg, "V", 2000.0, 0.0, 300000);
          data::store(session, *writer);
          writer->commit();
        } catch (const InputError& error) {
          named = error.diagnostics().front().code == "write-failed" &&
                  std::string(error.what()).find((dir / "s.h5").string() + "`: File too large") !=
                      std::string::npos;
          if (!named) std::fprintf(stderr, "%s\n", error.what());
        }
        ::setrlimit(RLIMIT_FSIZE, &limit);  // a full disk does not keep memory from growing, this limit does
        writer.reset();
        return named;
      })) << bytes
          << " bytes, deflate " << level;
      EXPECT_EQ(files_in(dir), 0u) << bytes;
    }
  }
}

TEST(SessionFileWriter, AReadOnlyOrMissingFolderIsNamed) {
  const auto dir = scratch_dir();
  EXPECT_EQ(error_of([&] { SessionFileWriter writer(dir / "no" / "s.h5"); }, dir),
            "error[missing-folder]: cannot write `no/s.h5`: there is no folder `no`\n  help: make the folder "
            "first\n");
  std::filesystem::create_directory(dir / "locked");
  std::filesystem::permissions(dir / "locked",
                               std::filesystem::perms::owner_read | std::filesystem::perms::owner_exec |
                                   std::filesystem::perms::others_read | std::filesystem::perms::others_exec);
  EXPECT_TRUE(in_child([&] {
    if (::geteuid() == 0 && ::seteuid(65534) != 0) return false;  // root may write anywhere
    const std::string text = error_of([&] { SessionFileWriter writer(dir / "locked" / "s.h5"); }, dir);
    std::fprintf(stderr, "%s", text.c_str());
    return text ==
           "error[read-only-folder]: cannot write `locked/s.h5`: Permission denied\n"
           "  help: choose a folder you may write to\n";
  }));
}

TEST(SessionFileWriter, RefusesNamesThatHdf5CannotHold) {
  SessionFileWriter writer(scratch_dir() / "s.h5");
  EXPECT_EQ(error_of([&] {
              writer.begin_trial({"a/b", {}, {}, {}, {}});
            }),
            "error[bad-name]: `a/b` cannot be the name of a trial\n"
            "  help: a name must not be empty and must not hold `/` or control characters\n");
  writer.begin_trial({"t", {}, {}, {}, {}});
  EXPECT_THAT(error_of([&] { writer.write("t", make_signal("", data::Quantity::emg, "V", 1.0, 0.0, 1)); }),
              HasSubstr("[bad-name]"));
  EXPECT_EQ(
      error_of([&] { writer.write("t", make_signal("time_0", data::Quantity::emg, "V", 1.0, 0.0, 1)); }),
      "error[bad-name]: `time_0` cannot be the name of a signal\n  help: names time_<number> are kept for "
      "time stamps\n");
  EXPECT_EQ(error_of([&] {
              writer.begin_trial({"t", {}, {}, {}, {}});
            }),
            "error[duplicate-trial]: there are two trials `t`\n  help: give each trial a name of its own\n");
  writer.write("t", make_signal("s", data::Quantity::emg, "V", 1.0, 0.0, 1));
  EXPECT_EQ(error_of([&] { writer.write("t", make_signal("s", data::Quantity::emg, "V", 1.0, 0.0, 1)); }),
            "error[duplicate-signal]: trial `t` has two signals `s`\n  help: give each signal of a trial a "
            "name of its own\n");
  EXPECT_EQ(
      error_of([&] { writer.write("t", make_signal("r", data::Quantity::emg, "V", 0.0, 0.0, 1)); }),
      "error[bad-signal]: signal `r` of trial `t` needs a rate above 0, a start time, a unit and samples "
      "(rate 0 Hz, start 0 s, unit `V`, 1 samples)\n");
}

TEST(SessionFileWriter, RefusesNonFiniteSamplesAndUnfinishedSignals) {
  SessionFileWriter writer(scratch_dir() / "s.h5");
  writer.begin_trial({"t", {}, {}, {}, {}});
  data::Signal signal = make_signal("s", data::Quantity::emg, "V", 10.0, 1.0, 5);
  signal.samples[3] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(error_of([&] { writer.write("t", signal); }),
            "error[non-finite-sample]: signal `s` of trial `t` has nan at 1.3 s\n");
  EXPECT_THROW(writer.commit(), std::logic_error);
}

TEST(SessionFile, BadFilesAreNamedWithWhatToDo) {
  const auto dir = scratch_dir();
  EXPECT_EQ(error_of([&] { SessionFile f(dir / "none.h5"); }, dir),
            "error[missing-file]: cannot read `none.h5`\n  help: check the path\n");
  tests::write_file(dir / "empty.h5", "");
  EXPECT_EQ(error_of([&] { SessionFile f(dir / "empty.h5"); }, dir),
            "error[empty-file]: `empty.h5` is empty\n  help: make it again\n");
  tests::write_file(dir / "text.h5", "time,value\n");
  EXPECT_EQ(error_of([&] { SessionFile f(dir / "text.h5"); }, dir),
            "error[not-hdf5]: `text.h5` is not an HDF5 file\n"
            "  help: give a session made with `brachium import`, or a session description (.toml)\n");
  write_session(small_session(), dir / "whole.h5");
  tests::write_file(dir / "cut.h5", tests::slurp(dir / "whole.h5").substr(0, 3000));
  EXPECT_EQ(error_of([&] { SessionFile f(dir / "cut.h5"); }, dir),
            "error[damaged-file]: `cut.h5` is cut off or damaged: HDF5 cannot open it\n"
            "  help: make it again, or fetch a complete copy\n");
}

/// A copy of a session file, changed through HDF5 itself.
template <class Change>
std::string error_after(const std::filesystem::path& dir, Change change) {
  write_session(small_session(), dir / "s.h5");
  const hid_t file = H5Fopen((dir / "s.h5").c_str(), H5F_ACC_RDWR, H5P_DEFAULT);
  change(file);
  H5Fclose(file);
  return error_of([&] { read_session(dir / "s.h5"); }, dir);
}

TEST(SessionFile, MissingOrForeignContentIsNamed) {
  const auto dir = scratch_dir();
  const auto remove = [](const char* object, const char* attribute) {
    return [=](hid_t file) { H5Adelete_by_name(file, object, attribute, H5P_DEFAULT); };
  };
  const std::string help =
      "  help: the layout is described in data/io/README.md; import the recordings again\n";
  EXPECT_EQ(error_after(dir, remove("/", "format")),
            "error[wrong-format]: `s.h5`: this HDF5 file is not a Brachium session (no attribute `format` = "
            "`brachium-session`)\n"
            "  help: import the recordings with a session description (.toml) first\n");
  EXPECT_EQ(error_after(dir, remove("/trials/mvc-1/elbow_flexion", "rate_hz")),
            "error[missing-attribute]: `s.h5`: signal `elbow_flexion` of trial `mvc-1` has no attribute "
            "`rate_hz`\n" +
                help);
  EXPECT_EQ(error_after(dir, remove("/trials/mvc-1", "kind")),
            "error[missing-attribute]: `s.h5`: trial `mvc-1` has no attribute `kind`\n" + help);
  EXPECT_EQ(error_after(dir, [](hid_t file) { H5Ldelete(file, "trials", H5P_DEFAULT); }),
            "error[missing-group]: `s.h5`: there is no group `trials`\n" + help);
  EXPECT_EQ(error_after(dir,
                        [](hid_t file) {
                          const long long two = 2;
                          const hid_t attribute = H5Aopen(file, "format_version", H5P_DEFAULT);
                          H5Awrite(attribute, H5T_NATIVE_LLONG, &two);
                          H5Aclose(attribute);
                        }),
            "error[wrong-version]: `s.h5`: format version 2 cannot be read, only version 1\n"
            "  help: import the recordings again with this version of the program\n");
  EXPECT_EQ(error_after(dir,
                        [](hid_t file) {
                          const hid_t set = H5Dopen2(file, "trials/mvc-1/elbow_flexion", H5P_DEFAULT);
                          std::vector<double> bad(480, std::numeric_limits<double>::infinity());
                          H5Dwrite(set, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, bad.data());
                          H5Dclose(set);
                        }),
            "error[non-finite-sample]: `s.h5`: signal `elbow_flexion` of trial `mvc-1` has inf at 0.0123 s\n"
            "  help: mend or cut the recording; Brachium does not replace samples\n");
}

TEST(SessionFile, DamagedSamplesAreFoundByTheirChecksum) {
  const auto dir = scratch_dir();
  data::Session session = small_session();
  session.trials[0].signals[0].samples.assign(5000, 0.1234567890123456);
  {
    SessionFileWriter writer(dir / "s.h5", {.deflate_level = 0});
    data::store(session, writer);
    writer.commit();
  }
  std::string bytes = tests::slurp(dir / "s.h5");
  const double value = 0.1234567890123456;
  const std::string pattern(reinterpret_cast<const char*>(&value), sizeof value);
  const std::size_t at = bytes.find(pattern + pattern + pattern);
  ASSERT_NE(at, std::string::npos);
  bytes[at + 100] = static_cast<char>(bytes[at + 100] ^ 0x10);
  tests::write_file(dir / "s.h5", bytes);
  EXPECT_EQ(error_of([&] { read_session(dir / "s.h5"); }, dir),
            "error[damaged-data]: `s.h5`: samples of signal `z_last_by_name` of trial `mvc-1` cannot be "
            "read; the file is cut "
            "off or damaged\n  help: make the file again, or fetch a complete copy\n");
}

TEST(SessionFile, HdfLibraryKeepsItsOwnPrintingForOthers) {
  H5E_auto2_t before = nullptr, after = nullptr;
  void* data = nullptr;
  H5Eget_auto2(H5E_DEFAULT, &before, &data);
  EXPECT_THROW(SessionFile("/no/such/file"), InputError);
  H5Eget_auto2(H5E_DEFAULT, &after, &data);
  EXPECT_EQ(before, after);
}

TEST(SessionFile, CutAtAnyPlaceGivesAnErrorNeverACrash) {
  const auto dir = scratch_dir();
  write_session(small_session(), dir / "s.h5");
  const std::string bytes = tests::slurp(dir / "s.h5");
  for (std::size_t part = 1; part < 100; ++part) {
    tests::write_file(dir / "cut.h5", bytes.substr(0, bytes.size() * part / 100));
    EXPECT_THROW(read_session(dir / "cut.h5"), InputError) << part;
  }
}

}  // namespace
}  // namespace brachium::io
