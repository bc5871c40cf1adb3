#pragma once
/// Where tests find what is not part of the project, and how they skip, saying so, where it is absent.

#include <gtest/gtest.h>

#include <filesystem>
#include <string>

namespace brachium::tests {

inline std::filesystem::path sessions_dir() {
  return BRACHIUM_SESSIONS_DIR;
}
inline std::filesystem::path reference_dir() {
  return BRACHIUM_REFERENCE_DIR;
}
inline std::filesystem::path source_dir() {
  return BRACHIUM_SOURCE_DIR;
}

/// A folder of its own for one test, empty at the start.
inline std::filesystem::path scratch_dir() {
  const auto* test = ::testing::UnitTest::GetInstance()->current_test_info();
  std::string name = std::string(test->test_suite_name()) + "." + test->name();
  for (char& c : name) {
    if (c == '/') c = '_';
  }
  const std::filesystem::path dir = std::filesystem::temp_directory_path() / "brachium-tests" / name;
  std::filesystem::remove_all(dir);
  std::filesystem::create_directories(dir);
  return dir;
}

}  // namespace brachium::tests

/// Skips the test, with the reason, unless the recordings are at hand.
#define BRACHIUM_NEEDS_SESSIONS()                                                                           \
  if (brachium::tests::sessions_dir().empty() || !std::filesystem::exists(brachium::tests::sessions_dir())) \
  GTEST_SKIP() << "needs the public recordings: configure with -DBRACHIUM_SESSIONS_DIR=<folder>"

/// Skips the test, with the reason, unless the reference numbers are at hand.
#define BRACHIUM_NEEDS_REFERENCE()                                \
  if (brachium::tests::reference_dir().empty() ||                 \
      !std::filesystem::exists(brachium::tests::reference_dir())) \
  GTEST_SKIP() << "needs the reference numbers: configure with -DBRACHIUM_REFERENCE_DIR=<folder>"
