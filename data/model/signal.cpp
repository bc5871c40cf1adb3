#include "data/model/signal.hpp"

#include <fmt/format.h>

#include <array>
#include <utility>

#include "data/model/error.hpp"

namespace brachium::data {
namespace {

constexpr std::array<std::pair<Quantity, const char*>, 19> names{{
    {Quantity::emg, "emg"},
    {Quantity::excitation, "excitation"},
    {Quantity::activation, "activation"},
    {Quantity::joint_angle, "joint_angle"},
    {Quantity::joint_velocity, "joint_velocity"},
    {Quantity::joint_acceleration, "joint_acceleration"},
    {Quantity::joint_moment, "joint_moment"},
    {Quantity::dynamometer_torque, "dynamometer_torque"},
    {Quantity::dynamometer_angle, "dynamometer_angle"},
    {Quantity::dynamometer_velocity, "dynamometer_velocity"},
    {Quantity::muscle_force, "muscle_force"},
    {Quantity::fibre_length, "fibre_length"},
    {Quantity::fibre_velocity, "fibre_velocity"},
    {Quantity::moment_arm, "moment_arm"},
    {Quantity::muscle_tendon_length, "muscle_tendon_length"},
    {Quantity::orientation, "orientation"},
    {Quantity::position, "position"},
    {Quantity::acceleration, "acceleration"},
    {Quantity::other, "other"},
}};

}  // namespace

std::string to_string(Quantity quantity) {
  for (const auto& [q, name] : names) {
    if (q == quantity) return name;
  }
  return "other";
}

Quantity parse_quantity(const std::string& name) {
  std::vector<std::string> known;
  for (const auto& [q, n] : names) {
    if (name == n) return q;
    known.emplace_back(n);
  }
  throw InputError("unknown-quantity", fmt::format("`{}` is not a quantity a signal can have", name),
                   suggest(name, known));
}

}  // namespace brachium::data
