#include "optimise/free_parameters.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <map>

#include "data/model/error.hpp"

namespace brachium::optimise {
namespace {

struct Entry {
  const char* name;  ///< in definitions
  const char* key;   ///< parameter of a verdict, unit at its end
  const char* unit;
  double lower, upper;  ///< default bounds
  bool relative;
};
constexpr std::array<Entry, 12> table = {
    {{"strength", "strength", "1", 0.5, 2.5, false},
     {"optimal_fibre_length", "optimal_fibre_length_m", "m", 0.85, 1.15, true},
     {"tendon_slack_length", "tendon_slack_length_m", "m", 0.85, 1.15, true},
     {"pennation", "pennation_at_optimal_rad", "rad", 0.8, 1.2, true},
     {"max_contraction_velocity", "max_contraction_velocity", "1/s", 0.5, 1.5, true},
     {"delay", "delay_s", "s", 0.0, 0.125, false},
     {"time_constant_1", "time_constant_1_s", "s", 0.0075, 0.060, false},
     {"time_constant_2", "time_constant_2_s", "s", 0.0075, 0.060, false},
     {"recursion_1", "recursion_1", "1", -0.95, -0.05, false},
     {"recursion_2", "recursion_2", "1", -0.95, -0.05, false},
     {"shape", "shape", "1", -2.999, -0.001, false},
     {"gain", "gain", "1", 0.05, 20.0, false}}};

const Entry& entry(Quantity quantity) {
  return table[static_cast<std::size_t>(quantity)];
}

void complain(std::vector<data::Diagnostic>& found, const std::string& code, const std::string& message,
              const std::string& help = {}) {
  found.push_back({data::Severity::error, code, message, {}, help});
}

/// Names that `only` selects; each pattern must match a name or a group.
std::vector<bool> selected(const FreeQuantity& free, const std::vector<std::string>& names,
                           const std::vector<std::string>& groups, std::vector<data::Diagnostic>& found) {
  std::vector<bool> out(names.size(), free.only.empty());
  for (const std::string& pattern : free.only) {
    bool any = false;
    for (std::size_t i = 0; i < names.size(); ++i) {
      if (data::matches(pattern, names[i]) || data::matches(pattern, groups[i])) any = out[i] = true;
    }
    if (any) continue;
    std::vector<std::string> known = names;
    known.insert(known.end(), groups.begin(), groups.end());
    complain(found, "no-match",
             fmt::format("`{}` (of free `{}`) matches no name", pattern, to_string(free.quantity)),
             data::suggest(pattern, known));
  }
  return out;
}

/// One parameter over its members.
void add(FreeParameters& out, const FreeQuantity& free, const std::string& owner,
         const std::vector<std::size_t>& members, const ChainValues& start,
         std::vector<data::Diagnostic>& found) {
  const Entry& e = entry(free.quantity);
  const bool gain = free.quantity == Quantity::gain;
  const bool factor = free.scope != Scope::each && is_shared_as_factor(free.quantity);
  Parameter p;
  p.owner = owner;
  p.name = factor ? std::string(e.name) + "_factor" : e.key;
  p.unit = factor ? "1" : e.unit;
  double sum = 0.0;
  std::vector<Target> targets;
  for (std::size_t i : members) {
    const double value = gain ? start.gains[i] : start.muscles[i].get(free.quantity);
    sum += value;
    targets.push_back({free.quantity, i, factor ? value : 0.0});
  }
  p.start = factor ? 1.0 : sum / static_cast<double>(members.size());
  const bool scale_bounds = free.relative && !factor;
  const double unit = scale_bounds ? p.start : 1.0;
  p.lower = *free.lower * unit;
  p.upper = *free.upper * unit;
  if (factor && !free.relative)
    complain(found, "bad-bounds",
             fmt::format("`{}` is shared as a factor: its bounds are factors on the start", p.label()),
             "say so with relative bounds, for example 0.85 and 1.15");
  if (free.prior_sd) {
    p.prior = Prior{free.prior_mean ? *free.prior_mean * unit : p.start, *free.prior_sd * unit};
  } else if (free.prior_mean) {
    complain(found, "bad-parameter", fmt::format("`{}` has a prior mean and no prior deviation", p.label()));
  }
  p.scale = p.upper > p.lower ? 0.5 * (p.upper - p.lower) : 1.0;
  out.parameters.push_back(std::move(p));
  out.targets.push_back(std::move(targets));
}

}  // namespace

std::string to_string(Quantity quantity) {
  return entry(quantity).name;
}

Quantity parse_quantity(const std::string& name) {
  std::vector<std::string> known;
  for (std::size_t i = 0; i < table.size(); ++i) {
    if (name == table[i].name) return static_cast<Quantity>(i);
    known.push_back(table[i].name);
  }
  throw data::InputError("unknown-parameter",
                         fmt::format("`{}` is not a parameter that can be set free", name),
                         data::suggest(name, known));
}

std::string to_string(Scope scope) {
  return scope == Scope::each ? "muscle" : (scope == Scope::group ? "group" : "global");
}

Scope parse_scope(const std::string& name) {
  if (name == "muscle" || name == "channel") return Scope::each;
  if (name == "group") return Scope::group;
  if (name == "global") return Scope::global;
  throw data::InputError(
      "unknown-scope", fmt::format("`{}` is not a scope", name),
      data::suggest(name, std::vector<std::string>{"muscle", "channel", "group", "global"}));
}

FreeQuantity with_default_bounds(FreeQuantity free, emg::Nonlinearity nonlinearity) {
  Entry e = entry(free.quantity);
  if (free.quantity == Quantity::shape && nonlinearity == emg::Nonlinearity::piecewise) {
    e.lower = 0.001;
    e.upper = 0.119;
  }
  if (!free.lower && !free.upper) free.relative = free.relative || e.relative;
  const bool same_kind = free.relative == e.relative;
  if (!free.lower && same_kind) free.lower = e.lower;
  if (!free.upper && same_kind) free.upper = e.upper;
  return free;
}

bool is_activation(Quantity quantity) {
  return quantity >= Quantity::delay && quantity <= Quantity::shape;
}

bool is_shared_as_factor(Quantity quantity) {
  return quantity >= Quantity::optimal_fibre_length && quantity <= Quantity::max_contraction_velocity;
}

double ChainValues::Muscle::get(Quantity quantity) const {
  switch (quantity) {
    case Quantity::strength:
      return parameters.strength;
    case Quantity::optimal_fibre_length:
      return parameters.optimal_fibre_length_m;
    case Quantity::tendon_slack_length:
      return parameters.tendon_slack_length_m;
    case Quantity::pennation:
      return parameters.pennation_at_optimal_rad;
    case Quantity::max_contraction_velocity:
      return parameters.max_contraction_velocity;
    case Quantity::delay:
      return activation.delay_s;
    case Quantity::time_constant_1:
      return activation.time_constant_1_s;
    case Quantity::time_constant_2:
      return activation.time_constant_2_s;
    case Quantity::recursion_1:
      return recursion_1;
    case Quantity::recursion_2:
      return recursion_2;
    case Quantity::shape:
      return activation.shape;
    case Quantity::gain:
      break;
  }
  return 1.0;
}

void ChainValues::Muscle::set(Quantity quantity, double value) {
  switch (quantity) {
    case Quantity::strength:
      parameters.strength = value;
      break;
    case Quantity::optimal_fibre_length:
      parameters.optimal_fibre_length_m = value;
      break;
    case Quantity::tendon_slack_length:
      parameters.tendon_slack_length_m = value;
      break;
    case Quantity::pennation:
      parameters.pennation_at_optimal_rad = value;
      break;
    case Quantity::max_contraction_velocity:
      parameters.max_contraction_velocity = value;
      break;
    case Quantity::delay:
      activation.delay_s = value;
      break;
    case Quantity::time_constant_1:
      activation.time_constant_1_s = value;
      break;
    case Quantity::time_constant_2:
      activation.time_constant_2_s = value;
      break;
    case Quantity::recursion_1:
      recursion_1 = value;
      break;
    case Quantity::recursion_2:
      recursion_2 = value;
      break;
    case Quantity::shape:
      activation.shape = value;
      break;
    case Quantity::gain:
      break;
  }
}

ChainValues FreeParameters::apply(ChainValues values, const Eigen::VectorXd& x) const {
  for (std::size_t j = 0; j < parameters.size(); ++j) {
    for (const Target& target : targets[j]) {
      const double value = target.slope() * x[static_cast<Eigen::Index>(j)];
      if (target.quantity == Quantity::gain)
        values.gains[target.index] = value;
      else
        values.muscles[target.index].set(target.quantity, value);
    }
  }
  return values;
}

FreeParameters expand(const std::vector<FreeQuantity>& list, const std::vector<data::SceneMuscle>& muscles,
                      const std::vector<bool>& driven, const std::vector<std::string>& channels,
                      const ChainValues& start, const ModelChoice& model,
                      std::vector<data::Diagnostic>& found) {
  FreeParameters out;
  std::vector<std::string> names, groups;
  for (const data::SceneMuscle& muscle : muscles) {
    names.push_back(muscle.name);
    groups.push_back(muscle.group.empty() ? muscle.name : muscle.group);
  }
  const bool recursive = model.activation.form == emg::ActivationForm::recursive;
  for (const FreeQuantity& given : list) {
    const FreeQuantity free = with_default_bounds(given, model.activation.nonlinearity);
    const std::string name = to_string(free.quantity);
    if (!free.lower || !free.upper) {
      complain(found, "bad-bounds", fmt::format("free `{}`: give both bounds, or none", name));
      continue;
    }
    const bool coefficient = free.quantity == Quantity::recursion_1 || free.quantity == Quantity::recursion_2;
    const bool constant =
        free.quantity == Quantity::time_constant_1 || free.quantity == Quantity::time_constant_2;
    if ((coefficient && !recursive) || (constant && recursive)) {
      complain(
          found, "bad-parameter",
          fmt::format("`{}` cannot be free in the {} form of activation dynamics", name,
                      to_string(model.activation.form)),
          recursive ? "use `recursion_1` and `recursion_2`" : "use `time_constant_1` and `time_constant_2`");
      continue;
    }
    if (free.quantity == Quantity::gain) {
      const std::vector<bool> chosen = selected(free, channels, channels, found);
      if (free.scope == Scope::group) {
        complain(found, "bad-parameter",
                 "`gain` belongs to channels: its scope is \"channel\" or \"global\", not \"group\"");
        continue;
      }
      std::vector<std::size_t> all;
      for (std::size_t k = 0; k < channels.size(); ++k) {
        if (!chosen[k]) continue;
        all.push_back(k);
        if (free.scope == Scope::each) add(out, free, channels[k], {k}, start, found);
      }
      if (free.scope == Scope::global && !all.empty()) add(out, free, "*", all, start, found);
      continue;
    }
    std::vector<bool> chosen = selected(free, names, groups, found);
    std::vector<std::string> order;
    std::map<std::string, std::vector<std::size_t>> members;
    for (std::size_t m = 0; m < muscles.size(); ++m) {
      if (!chosen[m] || (is_activation(free.quantity) && !driven[m])) continue;
      const std::string owner =
          free.scope == Scope::each ? names[m] : (free.scope == Scope::group ? groups[m] : "*");
      if (!members.contains(owner)) order.push_back(owner);
      members[owner].push_back(m);
    }
    for (const std::string& owner : order) add(out, free, owner, members[owner], start, found);
  }
  return out;
}

}  // namespace brachium::optimise
