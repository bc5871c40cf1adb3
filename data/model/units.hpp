#pragma once
/// Units at the borders. Inside, everything is SI with angles in radians; a number is converted once, here,
/// when it is read from a file or a definition.

#include <string>
#include <string_view>

namespace brachium::data {

/// A unit as written by a user or a recorder.
struct Unit {
  std::string symbol;     ///< as written, e.g. "uV"
  std::string dimension;  ///< "voltage", "angle", "torque", ...; "dimensionless" for "1", "%", ""
  std::string si;         ///< SI symbol of that dimension, e.g. "V"
  double to_si = 1.0;     ///< value_si = to_si * value
};

/// Reads a unit symbol; accepts the spellings recorders use ("uV", "µV", "N m", "Nm", "N*m", "mG", "deg/s", ...).
/// Throws InputError("unknown-unit") naming the nearest known unit.
Unit parse_unit(std::string_view symbol);

/// value in `from` expressed in `to`; throws InputError("wrong-unit") when the dimensions differ.
double convert(double value, std::string_view from, std::string_view to);

/// A key of a definition and the unit that it ends with.
struct NamedUnit {
  std::string name;  ///< "lowpass" of "lowpass_hz"; the whole key where it ends with no unit
  std::string unit;  ///< "hz", as written; empty where there is none
};
NamedUnit split_unit(const std::string& key);

}  // namespace brachium::data
