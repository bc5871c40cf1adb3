#include "fem/limb/muscle_states.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <numbers>

#include "fem/limb/muscle_reading.hpp"
#include "fem/solve/constraints.hpp"
#include "fem/solve/equations.hpp"
#include "fem/solve/guided_motion.hpp"

namespace brachium::fem {
namespace {

constexpr int bowing_passes = 3;
constexpr double degree = std::numbers::pi / 180.0;

std::string words(double q, double activation) {
  return fmt::format("{:.4g} deg, activation {:.4g}", q / degree, activation);
}

}  // namespace

MuscleStates::MuscleStates(MuscleBody body, AngleRange range, Hinge hinge, std::vector<Bone> bones,
                           SolvedMuscleOptions options, const MuscleStates* like)
    : body_(std::move(body)),
      range_(range),
      hinge_(hinge),
      options_(std::move(options)),
      built_(build(body_, range_)) {
  discretisation_ = std::make_shared<const Discretisation>(built_.problem.mesh, built_.problem.formulation);
  const double cell = std::cbrt(discretisation_->volume() / discretisation_->cell_count());
  penalty_ = options_.contact_penalty_pa_per_m > 0.0
                 ? options_.contact_penalty_pa_per_m
                 : 30.0 * (body_.material.muscle.c1_pa + body_.material.muscle.c2_pa) / cell;
  choose_bones(bones);
  watch_obstacle();
  for (const Bone& bone : bones_) {
    Contact contact;
    contact.name = bone.name;
    contact.surface = "side";
    contact.body = bone.shape;
    contact.penalty_pa_per_m = penalty_;
    contact.penetration_tolerance_m = options_.contact_tolerance_m;
    contact.smoothing_m = options_.contact_tolerance_m > 0.0 ? 0.0 : options_.contact_smoothing_m;
    built_.problem.contacts.push_back(contact);
  }
  known_.push_back(in_situ(like));
}

/// At the reference angle, passive: at once from where it probably is, else step by step from the stress-free
/// place.
MuscleStates::Known MuscleStates::in_situ(const MuscleStates* like) {
  Known reference;
  reference.state.q_rad = reference.state.from_q_rad = body_.reference_rad;
  Phase phase = in_situ_phase(1);
  for (const bool theirs : {true, false}) {
    if (theirs && !like) continue;
    const SolveState from = theirs ? adapted(*like, like->known_.front(), phase) : stretched(phase);
    Known near = reference;
    if (from.configuration.dofs.size() > 0 && attempt(from, phase, near).empty()) return near;
  }
  phase.steps = 4;
  if (const std::string why = attempt({}, phase, reference); !why.empty()) {
    throw data::ConvergenceFailure(
        {fmt::format("{}: in-situ place at {}", body_.name, words(body_.reference_rad, 0.0)), why, 0, 0.0,
         0.0, body_.name});
  }
  return reference;
}

/// Direction across `line` in which the nearest bone that is modelled is left.
Eigen::Vector3d MuscleStates::away_from_bones(const Eigen::Vector3d& from,
                                              const Eigen::Vector3d& line) const {
  constexpr int points = 50;
  Distance nearest{std::numeric_limits<double>::infinity()};
  for (const Bone& bone : bones_) {
    for (int i = 0; i <= points; ++i) {
      const Distance d = distance(bone.shape, from + i / static_cast<double>(points) * line);
      if (d.value < nearest.value) nearest = d;
    }
  }
  const Eigen::Vector3d across = nearest.gradient - line.dot(nearest.gradient) / line.squaredNorm() * line;
  if (across.norm() > 1e-6) return across.normalized();
  return outward(body_);
}

/// Stretched evenly to its in-situ length, at its own volume, and bowed aside as far as bones ask for.
SolveState MuscleStates::stretched(const Phase& phase) const {
  const auto& origin = std::get<GuidedMotion>(built_.problem.conditions[0].kind);
  const auto& insertion = std::get<GuidedMotion>(built_.problem.conditions[1].kind);
  const Eigen::Vector3d along = (insertion.centre_m - origin.centre_m).normalized();
  const Eigen::Vector3d place = guided_place(origin, 1.0).place_m;
  const double s = body_.pre_stretch, thinner = 1.0 / std::sqrt(s);
  const Eigen::Vector3d aside = away_from_bones(place, s * body_.stress_free_length_m() * along);
  SolveState state;
  state.configuration.activation =
      Eigen::VectorXd::Zero(static_cast<Eigen::Index>(built_.problem.mesh->regions.size()));
  state.configuration.dofs = Eigen::VectorXd::Zero(discretisation_->dof_count());
  const data::Mesh& mesh = discretisation_->mesh();
  double bow = 0.0;
  for (int pass = 0; pass < bowing_passes; ++pass) {
    for (Eigen::Index p = 0; p < mesh.points.cols(); ++p) {
      const Eigen::Vector3d X = mesh.points.col(p) - origin.centre_m;
      const double z = X.dot(along);
      const Eigen::Vector3d x = place + s * z * along + thinner * (X - z * along) +
                                bow * std::sin(std::numbers::pi * z / body_.stress_free_length_m()) * aside;
      state.configuration.dofs.segment<3>(3 * p) = x - mesh.points.col(p);
    }
    impose_ends(phase, state);
    for (const Contact& contact : built_.problem.contacts) {
      ContactOptions options;
      options.penalty_pa_per_m = penalty_;
      const ContactSurface surface(*discretisation_, "side", contact.body, options);
      bow -= std::min(surface.least_gap_m(state.configuration.dofs, {}), 0.0);
    }
  }
  state.guessed_pressure_pa =
      Eigen::MatrixXd::Zero(discretisation_->pressures_per_cell(), discretisation_->cell_count());
  return state;
}

void MuscleStates::impose_ends(const Phase& phase, SolveState& state) const {
  const Constraints ends(built_.problem, discretisation_->node_count(), discretisation_->dof_count(), {});
  ends.impose(Eigen::Vector2d(phase.amplitude.at("origin"), phase.amplitude.at("insertion")),
              state.configuration.dofs);
  state.amplitude = phase.amplitude;
}

void MuscleStates::choose_bones(const std::vector<Bone>& bones) {
  const double radius = *std::max_element(body_.profile_m.begin(), body_.profile_m.end());
  const double widest = body_.shape ? body_.shape->reach_m * radius / body_.shape->greatest_radius_m
                                    : radius * std::max(1.0, body_.flatness);
  const double reach = (1.0 + options_.touch_margin_norm) * widest;
  for (const Bone& bone : bones) {
    check(bone.shape, bone.name);
    const double distance = least_axis_distance_m(body_, range_, bone.shape);
    const bool touches = distance < reach;
    (touches ? bones_ : left_out_).push_back(bone);
    log_.push_back(fmt::format(
        "{}: contact with {} {}: the line between the ends comes as near as {:.1f} mm, the muscle reaches "
        "{:.1f} mm",
        body_.name, bone.name, touches ? "is modelled" : "is left out", 1e3 * distance, 1e3 * reach));
  }
}

/// A meshed end that the path leads around the obstacle is bent by it as a whole: said, since what a tendon
/// does there is not what it models.
void MuscleStates::watch_obstacle() {
  constexpr int steps = 280;
  double first = std::numeric_limits<double>::quiet_NaN(), last = first;
  for (int i = 0; i <= steps; ++i) {
    const double q = range_.lower_rad + (range_.upper_rad - range_.lower_rad) * i / steps;
    if (CablePath(body_.cable, q).past_obstacle_m() <= body_.cable_length_m()) continue;
    if (std::isnan(first)) first = q;
    last = q;
  }
  if (!std::isnan(first))
    log_.push_back(
        fmt::format("{}: its distal end lies on the obstacle between {:.1f} and {:.1f} deg: the rigid "
                    "tendon is too short to keep it off",
                    body_.name, first / degree, last / degree));
}

const MuscleStates::Known* MuscleStates::find(double q, double activation) const {
  for (const Known& k : known_) {
    if (std::abs(k.state.q_rad - q) < 1e-12 && std::abs(k.state.activation - activation) < 1e-12) return &k;
  }
  return nullptr;
}

std::vector<const MuscleStates::Known*> MuscleStates::nearest(double q, double activation) const {
  std::vector<const Known*> order;
  for (const Known& k : known_) order.push_back(&k);
  // An activation of 1 is as far as a turn of one radian.
  const auto far = [&](const Known* k) {
    return std::hypot(k->state.q_rad - q, k->state.activation - activation);
  };
  std::stable_sort(order.begin(), order.end(),
                   [&](const Known* a, const Known* b) { return far(a) < far(b); });
  return order;
}

std::string MuscleStates::attempt(const SolveState& from, const Phase& phase, Known& reached) {
  const auto start = std::chrono::steady_clock::now();
  Problem& problem = built_.problem;
  problem.programme = {phase};
  SolveState restart;
  const bool warm = from.configuration.dofs.size() > 0;
  if (warm) {
    restart.configuration = from.configuration;
    restart.guessed_pressure_pa = from.guessed_pressure_pa;
    restart.amplitude = restart.phase_amplitude = from.amplitude;
    restart.phase_activation = from.configuration.activation;
  }
  const Summary summary = solve(
      problem, options_.solve,
      [&](const AcceptedState& accepted) {
        if (accepted.state.phase_time >= 1.0) evaluate(accepted, reached.state);
      },
      {}, warm ? &restart : nullptr);
  reached.state.newton_iterations += summary.newton_iterations;
  reached.state.chord_iterations += summary.chord_iterations;
  reached.state.steps += static_cast<int>(summary.steps.size());
  reached.state.seconds += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  unknowns_ = summary.unknowns;
  if (!summary.completed) return summary.reason;
  reached.solved = summary.last;
  return {};
}

void MuscleStates::evaluate(const AcceptedState& accepted, SolvedMuscle& state) const {
  const MuscleReading reading{body_, hinge_, built_.problem, *discretisation_, range_};
  read_state(reading, accepted, state);
  read_contacts(reading, left_out_, accepted, state);
  if (options_.slopes) read_slopes(reading, accepted, state);
}

Phase MuscleStates::phase_to(double q, double activation) const {
  Phase phase;
  phase.name = words(q, activation);
  phase.amplitude = {{"origin", 1.0}, {"insertion", amplitude(body_, q)}};
  for (const std::string& region : built_.problem.mesh->regions) phase.activation[region] = activation;
  return phase;
}

/// Another muscle's state with this one's ends and loads.
SolveState MuscleStates::adapted(const MuscleStates& other, const Known& known, const Phase& phase) const {
  SolveState state;
  state.configuration = known.solved.configuration;
  if (other.discretisation_->dof_count() != discretisation_->dof_count()) {
    state.configuration.dofs.resize(0);
    return state;
  }
  impose_ends(phase, state);
  Equations theirs(other.built_.problem, options_.solve);
  if (theirs.condensed()) state.guessed_pressure_pa = theirs.assembly().pressures(known.solved.configuration);
  return state;
}

const SolvedMuscle& MuscleStates::solve_state_like(const MuscleStates& other, double q, double activation) {
  const Known* theirs = other.find(q, activation);
  if (theirs && !find(q, activation)) {
    Known reached;
    reached.state.q_rad = reached.state.from_q_rad = q;
    reached.state.activation = reached.state.from_activation = activation;
    const Phase phase = phase_to(q, activation);
    const SolveState from = adapted(other, *theirs, phase);
    if (from.configuration.dofs.size() > 0 && attempt(from, phase, reached).empty()) {
      known_.push_back(std::move(reached));
      return known_.back().state;
    }
  }
  return solve_state(q, activation);
}

const SolvedMuscle& MuscleStates::solve_state(double q, double activation) {
  if (!(q >= range_.lower_rad - 1e-12 && q <= range_.upper_rad + 1e-12) ||
      !(activation >= 0.0 && activation <= 1.0)) {
    throw data::InputError("limb-range",
                           fmt::format("{}: there is no state at {}", body_.name, words(q, activation)),
                           fmt::format("angles from {:.4g} to {:.4g} deg and activations from 0 to 1",
                                       range_.lower_rad / degree, range_.upper_rad / degree));
  }
  if (const Known* known = find(q, activation)) return known->state;
  std::string tried;
  int attempts = 0;
  for (const Known* from : nearest(q, activation)) {
    if (++attempts > 3) break;
    Known reached;
    reached.state.q_rad = q;
    reached.state.activation = activation;
    reached.state.from_q_rad = from->state.q_rad;
    reached.state.from_activation = from->state.activation;
    Phase phase = phase_to(q, activation);
    phase.steps =
        std::max({1, static_cast<int>(std::ceil(std::abs(q - from->state.q_rad) / options_.step_rad)),
                  static_cast<int>(
                      std::ceil(std::abs(activation - from->state.activation) / options_.step_activation))});
    const std::string why = attempt(from->solved, phase, reached);
    if (why.empty()) {
      known_.push_back(std::move(reached));
      return known_.back().state;
    }
    tried += fmt::format("{}from {}: {}", tried.empty() ? "" : "; ",
                         words(from->state.q_rad, from->state.activation), why);
  }
  throw data::ConvergenceFailure(
      {fmt::format("{} at {}", body_.name, words(q, activation)), tried, attempts, 0.0, 0.0, body_.name});
}

const SolveState& MuscleStates::solved(double q, double activation) const {
  if (const Known* known = find(q, activation)) return known->solved;
  throw data::InputError(
      "limb-range", fmt::format("{}: the state at {} has not been solved", body_.name, words(q, activation)),
      "solve it first");
}

}  // namespace brachium::fem
