#include "data/model/units.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <numbers>
#include <vector>

#include "data/model/error.hpp"

namespace brachium::data {
namespace {

struct Entry {
  std::string_view symbol;
  std::string_view dimension;
  std::string_view si;
  double to_si;
};

constexpr double standard_gravity = 9.80665;         // m/s^2, CGPM 1901
constexpr double pound = 0.45359237;                 // kg, international avoirdupois pound, exact
constexpr double degree = std::numbers::pi / 180.0;  // rad

constexpr std::array entries{
    Entry{"V", "voltage", "V", 1.0},
    Entry{"mV", "voltage", "V", 1e-3},
    Entry{"uV", "voltage", "V", 1e-6},
    Entry{"nV", "voltage", "V", 1e-9},
    Entry{"s", "time", "s", 1.0},
    Entry{"ms", "time", "s", 1e-3},
    Entry{"us", "time", "s", 1e-6},
    Entry{"min", "time", "s", 60.0},
    Entry{"Hz", "frequency", "Hz", 1.0},
    Entry{"kHz", "frequency", "Hz", 1e3},
    Entry{"rad", "angle", "rad", 1.0},
    Entry{"deg", "angle", "rad", degree},
    Entry{"rad/s", "angular velocity", "rad/s", 1.0},
    Entry{"deg/s", "angular velocity", "rad/s", degree},
    Entry{"rpm", "angular velocity", "rad/s", 2.0 * std::numbers::pi / 60.0},
    Entry{"rad/s^2", "angular acceleration", "rad/s^2", 1.0},
    Entry{"deg/s^2", "angular acceleration", "rad/s^2", degree},
    Entry{"N m", "torque", "N m", 1.0},
    Entry{"mN m", "torque", "N m", 1e-3},
    Entry{"ft lbf", "torque", "N m", 0.3048 * pound* standard_gravity},
    Entry{"N", "force", "N", 1.0},
    Entry{"kN", "force", "N", 1e3},
    Entry{"lbf", "force", "N", pound* standard_gravity},
    Entry{"kg", "mass", "kg", 1.0},
    Entry{"g", "mass", "kg", 1e-3},
    Entry{"lb", "mass", "kg", pound},
    Entry{"m", "length", "m", 1.0},
    Entry{"cm", "length", "m", 1e-2},
    Entry{"mm", "length", "m", 1e-3},
    Entry{"in", "length", "m", 0.0254},
    Entry{"m/s", "velocity", "m/s", 1.0},
    Entry{"m/s^2", "acceleration", "m/s^2", 1.0},
    Entry{"mG", "acceleration", "m/s^2", 1e-3 * standard_gravity},
    Entry{"G", "acceleration", "m/s^2", standard_gravity},
    Entry{"kg m^2", "moment of inertia", "kg m^2", 1.0},
    Entry{"Pa", "stress", "Pa", 1.0},
    Entry{"kPa", "stress", "Pa", 1e3},
    Entry{"MPa", "stress", "Pa", 1e6},
    Entry{"1", "dimensionless", "1", 1.0},
    Entry{"", "dimensionless", "1", 1.0},
    Entry{"-", "dimensionless", "1", 1.0},
    Entry{"%", "dimensionless", "1", 1e-2},
    Entry{"norm", "dimensionless", "1", 1.0},
};

// The spellings of recorders and humans, brought to the table's one.
std::string canonical(std::string_view symbol) {
  std::string s(symbol);
  const auto replace_all = [&s](std::string_view what, std::string_view by) {
    for (std::size_t at = s.find(what); at != std::string::npos; at = s.find(what, at + by.size())) {
      s.replace(at, what.size(), by);
    }
  };
  replace_all("\xC2\xB5", "u");    // micro sign
  replace_all("\xCE\xBC", "u");    // Greek mu
  replace_all("\xC2\xB0", "deg");  // degree sign
  replace_all("\xC2\xB7", " ");    // middle dot
  replace_all("\xC2\xB2", "^2");   // superscript two
  replace_all("*", " ");
  replace_all("\xE2\x8B\x85", " ");  // dot operator
  const auto first = s.find_first_not_of(" \t[](\"");
  const auto last = s.find_last_not_of(" \t[])\"");
  s = first == std::string::npos ? std::string{} : s.substr(first, last - first + 1);
  static const std::array<std::pair<std::string_view, std::string_view>, 22> aliases{{
      {"Nm", "N m"},         {"N.m", "N m"},        {"N-m", "N m"},         {"mNm", "mN m"},
      {"ft-lb", "ft lbf"},   {"ft lb", "ft lbf"},   {"degree", "deg"},      {"degrees", "deg"},
      {"radian", "rad"},     {"radians", "rad"},    {"degrees/s", "deg/s"}, {"m/s2", "m/s^2"},
      {"deg/s2", "deg/s^2"}, {"rad/s2", "rad/s^2"}, {"kg m2", "kg m^2"},    {"sec", "s"},
      {"seconds", "s"},      {"volt", "V"},         {"volts", "V"},         {"lbs", "lb"},
      {"hz", "Hz"},          {"percent", "%"},
  }};
  for (const auto& [from, to] : aliases) {
    if (s == from) return std::string(to);
  }
  return s;
}

}  // namespace

Unit parse_unit(std::string_view symbol) {
  const std::string wanted = canonical(symbol);
  for (const Entry& e : entries) {
    if (e.symbol == wanted)
      return {std::string(symbol), std::string(e.dimension), std::string(e.si), e.to_si};
  }
  std::vector<std::string> known;
  for (const Entry& e : entries) {
    if (!e.symbol.empty()) known.emplace_back(e.symbol);
  }
  throw InputError("unknown-unit", fmt::format("`{}` is not a unit Brachium knows", symbol),
                   suggest(wanted, known));
}

double convert(double value, std::string_view from, std::string_view to) {
  const Unit a = parse_unit(from);
  const Unit b = parse_unit(to);
  if (a.dimension != b.dimension) {
    throw InputError(
        "wrong-unit",
        fmt::format("`{}` is a unit of {}, but a unit of {} is needed", from, a.dimension, b.dimension),
        fmt::format("give a value in `{}` or another unit of {}", to, b.dimension));
  }
  return value * (a.to_si / b.to_si);
}

NamedUnit split_unit(const std::string& key) {
  // Longest first, so that "rad_s" is not taken for "s".
  static constexpr std::array unit_endings{
      "per_s", "kg_m2", "N_m3", "n_m3", "per_cent", "percent", "rad_s", "deg_s", "m_s2", "N_m", "N_s",
      "m_s",   "khz",   "mhz",  "hz",   "min",      "rad",     "deg",   "Nm",    "kN",   "kg",  "mg",
      "lb",    "ms",    "us",   "mm",   "cm",       "Pa",      "kPa",   "MPa",   "pa",   "kpa", "mpa",
      "mV",    "uV",    "uv",   "mv",   "s",        "m",       "g",     "N",     "V",    "norm"};
  for (const std::string_view ending : unit_endings) {
    if (key.size() > ending.size() + 1 && key.ends_with(ending) && key[key.size() - ending.size() - 1] == '_')
      return {key.substr(0, key.size() - ending.size() - 1), std::string(ending)};
  }
  return {key, {}};
}

}  // namespace brachium::data
