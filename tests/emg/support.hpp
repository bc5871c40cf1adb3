#pragma once
/// What the tests of emg share: signals that are the same everywhere, public recordings, and scipy as a reference.

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <random>
#include <sstream>
#include <string>
#include <vector>

#include "data/model/error.hpp"
#include "tests/support/paths.hpp"
#include "tests/support/python.hpp"

namespace brachium::tests {

/// The deterministic signal of scipy_reference.py.
inline std::vector<double> chirp(std::size_t n = 2000) {
  std::vector<double> x(n);
  for (std::size_t i = 0; i < n; ++i) {
    const auto k = static_cast<double>(i);
    x[i] = std::sin(0.02 * k) + 0.4 * std::sin(0.0004 * k * k) + 0.3 * std::cos(1.1 * k) + 0.2;
  }
  return x;
}

inline std::vector<double> white_noise(std::size_t n, unsigned seed = 1) {
  std::mt19937_64 generator(seed);
  std::normal_distribution<double> normal;
  std::vector<double> x(n);
  for (double& v : x) v = normal(generator);
  return x;
}

inline void write_doubles(const std::filesystem::path& file, const std::vector<double>& x) {
  std::ofstream(file, std::ios::binary)
      .write(reinterpret_cast<const char*>(x.data()),
             static_cast<std::streamsize>(x.size() * sizeof(double)));
}

inline std::vector<double> read_doubles(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary | std::ios::ate);
  std::vector<double> x(static_cast<std::size_t>(in.tellg()) / sizeof(double));
  in.seekg(0);
  in.read(reinterpret_cast<char*>(x.data()), static_cast<std::streamsize>(x.size() * sizeof(double)));
  return x;
}

inline std::string script() {
  return (source_dir() / "tests/emg/scipy_reference.py").string();
}

/// A signal through scipy_reference.py; `rest` are the arguments after IN and OUT.
inline std::vector<double> scipy(const std::string& mode, const std::vector<double>& x,
                                 const std::string& rest) {
  const std::filesystem::path dir = scratch_dir();
  write_doubles(dir / "in", x);
  const std::string command = "/usr/bin/python3 '" + script() + "' " + mode + " '" + (dir / "in").string() +
                              "' '" + (dir / "out").string() + "' " + rest;
  if (std::system(command.c_str()) != 0) throw std::runtime_error("failed: " + command);
  return read_doubles(dir / "out");
}

/// The last column of a file of comma-separated values whose lines before `skip` are left out.
inline std::vector<double> csv_column(const std::filesystem::path& file, int skip) {
  std::ifstream in(file);
  std::vector<double> x;
  std::string line;
  for (int i = 0; std::getline(in, line); ++i) {
    const auto comma = line.rfind(',');
    if (i >= skip && comma != std::string::npos) x.push_back(std::stod(line.substr(comma + 1)));
  }
  return x;
}

/// An elbow-curl recording [uV, 2 kHz].
inline std::vector<double> curl(const std::string& trial, const std::string& channel) {
  return csv_column(sessions_dir() / "elbow_curls_noraxon/EMG" / trial / ("Noraxon Ultium-RT " + channel), 4);
}

inline double largest(const std::vector<double>& x) {
  double m = 0.0;
  for (const double v : x) m = std::max(m, std::abs(v));
  return m;
}

/// Largest difference in units of the largest reference value.
inline double relative_difference(const std::vector<double>& x, const std::vector<double>& reference) {
  if (x.size() != reference.size()) return INFINITY;
  double m = 0.0;
  for (std::size_t k = 0; k < x.size(); ++k) m = std::max(m, std::abs(x[k] - reference[k]));
  return m / largest(reference);
}

/// "code: message" of the InputError that `action` throws; all of them, one per line.
template <class Action>
std::string input_error(Action action) {
  try {
    action();
  } catch (const data::InputError& e) {
    std::string text;
    for (const data::Diagnostic& d : e.diagnostics())
      text += (text.empty() ? "" : "\n") + d.code + ": " + d.message;
    return text;
  }
  return "no error";
}

}  // namespace brachium::tests
