#include "data/limb/drive.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "data/model/error.hpp"

namespace brachium::limb {
namespace {

using data::Diagnostic;
using data::MuscleDrive;
using data::Severity;

// Resolves rules depth first; a muscle met again while it is being resolved closes a cycle.
class Resolver {
 public:
  Resolver(const data::Scene& scene, const std::vector<std::string>& channels, Eigen::MatrixXd& weights)
      : scene_(scene), channels_(channels), weights_(weights), state_(scene.muscles.size(), State::open) {
    for (const auto& m : scene.muscles) names_.push_back(m.name);
  }

  std::vector<DriveMistake> run() {
    for (std::size_t i = 0; i < names_.size(); ++i) {
      trail_.clear();
      resolve(i);
    }
    return std::move(mistakes_);
  }

 private:
  enum class State { open, busy, done };

  void mistake(std::size_t muscle, std::string item, const char* code, std::string message,
               std::string help = {}) {
    mistakes_.push_back({muscle,
                         std::move(item),
                         {Severity::error, code, std::move(message), std::nullopt, std::move(help)}});
  }

  void resolve(std::size_t m) {
    if (state_[m] == State::done) return;
    trail_.push_back(names_[m]);
    if (state_[m] == State::busy) {
      const auto start = std::find(trail_.begin(), trail_.end(), names_[m]);
      mistake(m, {}, "rule-cycle",
              fmt::format("the drive rules of `{}` form a cycle: {}", names_[m],
                          fmt::join(start, trail_.end(), " -> ")),
              "drive one of them by channels");
      trail_.pop_back();
      return;
    }
    state_[m] = State::busy;
    const MuscleDrive& drive = scene_.muscles[m].drive;
    if (drive.kind == MuscleDrive::Kind::channels) by_channels(m, drive);
    if (drive.kind == MuscleDrive::Kind::rule) by_rule(m, drive);
    state_[m] = State::done;
    trail_.pop_back();
  }

  void by_channels(std::size_t m, const MuscleDrive& drive) {
    for (const auto& [channel, weight] : drive.channels) {
      if (!(weight >= 0.0) || !std::isfinite(weight)) {
        mistake(m, channel, "out-of-range",
                fmt::format("the weight of channel `{}` for muscle `{}` must be 0 or greater, not {}",
                            channel, names_[m], weight));
      }
      const auto at = std::find(channels_.begin(), channels_.end(), channel);
      if (at == channels_.end()) {
        mistake(
            m, channel, "unmapped-channel",
            fmt::format("muscle `{}` is driven by channel `{}`, which is not recorded", names_[m], channel),
            data::suggest(channel, channels_));
        continue;
      }
      weights_(static_cast<Eigen::Index>(m), at - channels_.begin()) = weight;
    }
  }

  void by_rule(std::size_t m, const MuscleDrive& drive) {
    const bool same = drive.rule == "same_as";
    if (!same && drive.rule != "mean_of") {
      const std::vector<std::string> known{"same_as", "mean_of"};
      mistake(m, drive.rule, "unknown-rule",
              fmt::format("`{}` is not a drive rule (muscle `{}`)", drive.rule, names_[m]),
              data::suggest(drive.rule, known));
      return;
    }
    if (same ? drive.muscles.size() != 1 : drive.muscles.size() < 2) {
      mistake(m, drive.rule, "bad-rule",
              fmt::format("rule `{}` of muscle `{}` takes {}, not {} muscles", drive.rule, names_[m],
                          same ? "one muscle" : "two or more muscles", drive.muscles.size()));
      return;
    }
    const auto row = static_cast<Eigen::Index>(m);
    for (const std::string& source : drive.muscles) {
      const auto at = std::find(names_.begin(), names_.end(), source);
      if (at == names_.end()) {
        mistake(m, source, "unknown-muscle",
                fmt::format("the drive rule of muscle `{}` names `{}`, which is not in the scene", names_[m],
                            source),
                data::suggest(source, names_));
        continue;
      }
      const auto s = static_cast<std::size_t>(at - names_.begin());
      if (scene_.muscles[s].drive.kind == MuscleDrive::Kind::undriven) {
        mistake(m, source, "undriven-source",
                fmt::format("the drive rule of muscle `{}` names `{}`, which has no drive itself", names_[m],
                            source));
        continue;
      }
      resolve(s);
      weights_.row(row) +=
          weights_.row(static_cast<Eigen::Index>(s)) / static_cast<double>(drive.muscles.size());
    }
  }

  const data::Scene& scene_;
  const std::vector<std::string>& channels_;
  Eigen::MatrixXd& weights_;
  std::vector<State> state_;
  std::vector<std::string> names_, trail_;
  std::vector<DriveMistake> mistakes_;
};

}  // namespace

std::vector<DriveMistake> drive_mistakes(const data::Scene& scene,
                                         std::span<const std::string> available_channels) {
  const std::vector<std::string> available(available_channels.begin(), available_channels.end());
  Eigen::MatrixXd weights = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(scene.muscles.size()),
                                                  static_cast<Eigen::Index>(available.size()));
  return Resolver(scene, available, weights).run();
}

DriveMap drive_map(const data::Scene& scene, std::span<const std::string> available_channels) {
  DriveMap map;
  const std::vector<std::string> available(available_channels.begin(), available_channels.end());
  const auto rows = static_cast<Eigen::Index>(scene.muscles.size());
  Eigen::MatrixXd all = Eigen::MatrixXd::Zero(rows, static_cast<Eigen::Index>(available.size()));
  std::vector<Diagnostic> findings;
  for (DriveMistake& mistake : Resolver(scene, available, all).run())
    findings.push_back(std::move(mistake.finding));
  if (!findings.empty()) throw data::InputError(std::move(findings));
  for (const auto& muscle : scene.muscles) {
    map.muscles.push_back(muscle.name);
    if (muscle.drive.kind == MuscleDrive::Kind::undriven) map.undriven.push_back(muscle.name);
  }
  std::vector<Eigen::Index> used;
  for (Eigen::Index c = 0; c < all.cols(); ++c) {
    if (!(all.col(c).array() > 0.0).any()) continue;
    used.push_back(c);
    map.channels.push_back(available[static_cast<std::size_t>(c)]);
  }
  map.weights.resize(rows, static_cast<Eigen::Index>(used.size()));
  for (std::size_t c = 0; c < used.size(); ++c)
    map.weights.col(static_cast<Eigen::Index>(c)) = all.col(used[c]);
  return map;
}

std::vector<std::string> named_channels(const data::Scene& scene) {
  std::vector<std::string> channels;
  for (const auto& muscle : scene.muscles) {
    if (muscle.drive.kind != MuscleDrive::Kind::channels) continue;
    for (const auto& [channel, weight] : muscle.drive.channels) {
      if (std::find(channels.begin(), channels.end(), channel) == channels.end()) channels.push_back(channel);
    }
  }
  return channels;
}

DriveMap drive_map(const data::Scene& scene) {
  return drive_map(scene, named_channels(scene));
}

Eigen::MatrixXd mix_excitations(const DriveMap& map, const Eigen::Ref<const Eigen::MatrixXd>& channels) {
  if (channels.rows() != map.weights.cols()) {
    throw data::InputError("wrong-size", fmt::format("the drive map takes {} channels, not {}",
                                                     map.weights.cols(), channels.rows()));
  }
  return map.weights * channels;
}

}  // namespace brachium::limb
