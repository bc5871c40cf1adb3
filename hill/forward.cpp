#include "hill/forward.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "data/model/error.hpp"
#include "hill/chain.hpp"

namespace brachium::hill {
namespace {

constexpr const char* kParameterNames[kParameterCount] = {"max_isometric_force_N",
                                                          "strength",
                                                          "optimal_fibre_length_m",
                                                          "tendon_slack_length_m",
                                                          "pennation_at_optimal_rad",
                                                          "max_contraction_velocity",
                                                          "fibre_damping"};

double data::MuscleParameters::*member(MuscleParameter which) {
  using P = data::MuscleParameters;
  switch (which) {
    case MuscleParameter::max_isometric_force:
      return &P::max_isometric_force_N;
    case MuscleParameter::strength:
      return &P::strength;
    case MuscleParameter::optimal_fibre_length:
      return &P::optimal_fibre_length_m;
    case MuscleParameter::tendon_slack_length:
      return &P::tendon_slack_length_m;
    case MuscleParameter::pennation:
      return &P::pennation_at_optimal_rad;
    case MuscleParameter::max_contraction_velocity:
      return &P::max_contraction_velocity;
    case MuscleParameter::fibre_damping:
      return &P::fibre_damping;
  }
  return nullptr;
}

// Fewest frames that the chain's differences in time need.
std::size_t fewest_frames(const MuscleModelOptions& o, bool rate_given) {
  if (o.compatibility == Compatibility::ceinms) return 4;
  if (o.velocity != FibreVelocity::zero_lag) return 1;
  return o.tendon == TendonKind::rigid && rate_given ? 1 : kCentralFrames;
}

void check_sizes(const MuscleTendon& muscle, const PathTrace& path, std::size_t n,
                 std::span<const Tangent> tangents) {
  const auto size = [&](const char* what, std::size_t got, bool may_be_empty) {
    if (got == n || (got == 0 && may_be_empty)) return;
    throw data::InputError("size-mismatch", fmt::format("`{}` of muscle `{}` has {} frames, its path {}",
                                                        what, muscle.name(), got, n));
  };
  size("velocity_m_s", path.velocity_m_s.size(), true);
  size("moment_arm_m", path.moment_arm_m.size(), true);
  for (const Tangent& t : tangents) {
    size("dactivation", t.dactivation.size(), true);
    size("dforce", t.dforce.size(), false);
  }
}

void check_finite(const MuscleTendon& muscle, const char* what, std::span<const double> values) {
  // The sum is finite only if all are; only then is the culprit looked for.
  double sum = 0.0;
  for (const double v : values) sum += v * 0.0;
  if (sum == 0.0) return;
  const auto bad = std::find_if(values.begin(), values.end(), [](double v) { return !std::isfinite(v); });
  throw data::InputError("not-finite", fmt::format("`{}` of muscle `{}` is {} at frame {}", what,
                                                   muscle.name(), *bad, bad - values.begin()));
}

void check(const MuscleTendon& muscle, const PathTrace& path, std::span<const double> activation,
           std::span<const Tangent> tangents) {
  const std::size_t n = path.length_m.size();
  if (!(path.rate_hz > 0.0) || !std::isfinite(path.rate_hz)) {
    throw data::InputError(
        "bad-rate", fmt::format("the path of muscle `{}` has a rate of {} Hz", muscle.name(), path.rate_hz),
        "it must be positive");
  }
  if (activation.size() != n) {
    throw data::InputError(
        "size-mismatch", fmt::format("`activation` of muscle `{}` has {} frames, its path {}", muscle.name(),
                                     activation.size(), n));
  }
  const std::size_t fewest = fewest_frames(muscle.options(), !path.velocity_m_s.empty());
  if (n < fewest) {
    throw data::InputError(
        "trial-too-short",
        fmt::format("the path of muscle `{}` has {} frames; the fibre velocity needs at least {}",
                    muscle.name(), n, fewest));
  }
  check_sizes(muscle, path, n, tangents);
  check_finite(muscle, "length_m", path.length_m);
  check_finite(muscle, "velocity_m_s", path.velocity_m_s);
  check_finite(muscle, "moment_arm_m", path.moment_arm_m);
  const auto outside =
      std::find_if(activation.begin(), activation.end(), [](double a) { return !(a >= 0.0 && a <= 1.0); });
  if (outside != activation.end()) {
    throw data::InputError("activation-range",
                           fmt::format("the activation of muscle `{}` is {} at frame {}", muscle.name(),
                                       *outside, outside - activation.begin()),
                           "it must lie in [0, 1]");
  }
}

void resize(MuscleTrace& out, std::size_t n, bool moments) {
  out.force_N.resize(n);
  out.moment_N_m.resize(moments ? n : 0);
  out.fibre_length_m.resize(n);
  out.fibre_velocity_m_s.resize(n);
  out.status.resize(n);
  const std::size_t parts = out.parts ? n : 0;
  for (std::vector<double>* part :
       {&out.active_norm, &out.passive_norm, &out.velocity_norm, &out.damping_norm, &out.pennation_rad}) {
    part->resize(parts);
  }
}

}  // namespace

std::string to_string(FrameStatus status) {
  switch (status) {
    case FrameStatus::ok:
      return "ok";
    case FrameStatus::unloaded:
      return "unloaded";
    case FrameStatus::slack:
      return "slack";
  }
  return {};
}

std::string to_string(MuscleParameter parameter) {
  return kParameterNames[index_of(parameter)];
}

MuscleParameter parse_muscle_parameter(std::string_view name) {
  for (const MuscleParameter p : kAllParameters) {
    if (name == kParameterNames[index_of(p)]) return p;
  }
  const std::vector<std::string> known(std::begin(kParameterNames), std::end(kParameterNames));
  throw data::InputError("unknown-parameter", fmt::format("`{}` is not a muscle parameter", name),
                         data::suggest(name, known));
}

double get(const data::MuscleParameters& parameters, MuscleParameter which) {
  return parameters.*member(which);
}
void set(data::MuscleParameters& parameters, MuscleParameter which, double value) {
  parameters.*member(which) = value;
}

std::size_t MuscleTrace::count(FrameStatus which) const {
  return static_cast<std::size_t>(std::count(status.begin(), status.end(), which));
}

bool frames_are_independent(const MuscleModelOptions& options, bool has_velocity) {
  return options.tendon == TendonKind::rigid && options.compatibility != Compatibility::ceinms &&
         (has_velocity || options.velocity == FibreVelocity::none);
}

void forward(const MuscleTendon& muscle, const PathTrace& path, std::span<const double> activation,
             MuscleScratch& scratch, MuscleTrace& out, std::span<const Tangent> tangents) {
  check(muscle, path, activation, tangents);
  const std::size_t n = path.length_m.size();
  resize(out, n, !path.moment_arm_m.empty());
  const ChainInput in{muscle,  1.0 / path.rate_hz, path.length_m, path.velocity_m_s, activation, scratch, out,
                      tangents};
  if (muscle.options().compatibility == Compatibility::ceinms) {
    ceinms_chain(in);
  } else if (muscle.options().tendon == TendonKind::rigid) {
    rigid_chain(in);
  } else {
    elastic_chain(in);
  }
  for (std::size_t k = 0; k < out.moment_N_m.size(); ++k)
    out.moment_N_m[k] = path.moment_arm_m[k] * out.force_N[k];
}

}  // namespace brachium::hill
