#pragma once
/// From recorded channels to muscles' excitations: e = W c, with named rules resolved to weights.
///
/// | symbol | identifier | unit | meaning                                    |
/// |--------|------------|------|--------------------------------------------|
/// | c      | channels   | 1    | normalised envelopes of the channels (n_c) |
/// | W      | weights    | 1    | weights >= 0 (n_m x n_c)                   |
/// | e      | -          | 1    | excitations of the muscles (n_m)           |

#include <Eigen/Core>
#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "data/model/scene.hpp"

namespace brachium::limb {

struct DriveMap {
  std::vector<std::string>
      channels;  ///< columns: those available channels that drive a muscle, in their order
  std::vector<std::string> muscles;   ///< rows: all muscles of the scene, in its order
  Eigen::MatrixXd weights;            ///< n_m x n_c; the row of an undriven muscle is zero
  std::vector<std::string> undriven;  ///< muscles without excitation, in the scene's order
};

/// One mistake in a drive, and where to look for it.
struct DriveMistake {
  std::size_t muscle = 0;  ///< index in the scene
  std::string item;        ///< the channel or muscle that the drive names wrongly; empty for a cycle
  data::Diagnostic finding;
};

/// Every mistake in the drives of a scene, given the channels that can drive a muscle (see drive_map for
/// codes).
std::vector<DriveMistake> drive_mistakes(const data::Scene& scene,
                                         std::span<const std::string> available_channels);

/// Resolves the drives of a scene. Rules: "same_as" (one muscle), "mean_of" (the plain mean of two or more);
/// they may refer to muscles that are themselves driven by a rule, and to no undriven one. Throws InputError
/// with every mistake: "unmapped-channel" (a channel that is not available), "unknown-rule", "bad-rule"
/// (wrong number of muscles), "unknown-muscle", "rule-cycle", "undriven-source", "out-of-range" (weight).
DriveMap drive_map(const data::Scene& scene, std::span<const std::string> available_channels);

/// The same with the channels that the scene itself names.
DriveMap drive_map(const data::Scene& scene);

/// The channels that the drives of a scene name, in order of first mention.
std::vector<std::string> named_channels(const data::Scene& scene);

/// Excitations from channels: out(m, i) = sum_k weights(m, k) in(k, i).   in n_c x n_t, returns n_m x n_t.
/// Throws InputError("wrong-size") if the rows of `channels` are not those of the map.
Eigen::MatrixXd mix_excitations(const DriveMap& map, const Eigen::Ref<const Eigen::MatrixXd>& channels);

}  // namespace brachium::limb
