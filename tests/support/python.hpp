#pragma once
/// Tests that ask a Python program for the truth, and skip, saying so, where its packages are absent.

#include <gtest/gtest.h>

#include <cstdlib>
#include <string>

namespace brachium::tests {

/// Whether the system's Python finds these modules, separated by commas.
inline bool python_has(const std::string& modules) {
  return std::system(("/usr/bin/python3 -c 'import " + modules + "' 2>/dev/null").c_str()) == 0;
}

}  // namespace brachium::tests

/// Skips the test, with the reason, where scipy is not installed.
#define BRACHIUM_NEEDS_SCIPY() \
  if (!brachium::tests::python_has("scipy")) GTEST_SKIP() << "needs /usr/bin/python3 with scipy"
