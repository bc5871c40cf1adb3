#pragma once
/// The parts of a limb file, for limb_scene.cpp; use that.

#include <Eigen/Geometry>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "data/io/toml.hpp"
#include "pipelines/stages/limb_scene.hpp"

namespace brachium::pipelines::limb_parts {

struct Draft {
  LimbScene scene;
  std::filesystem::path folder;
  std::vector<data::Diagnostic> diagnostics;
  Eigen::Isometry3d to_arm =
      Eigen::Isometry3d::Identity();  ///< from the bones' coordinates to the arm's frame [m]
};

/// A length in mm as m, in a range; NaN with an error where it is missing or outside.
double millimetres(io::TomlTable& table, const std::string& key, bool may_be_zero,
                   std::optional<double> fallback = std::nullopt);
/// So many numbers in mm as m; zero with an error where they are missing.
std::optional<Eigen::VectorXd> places(io::TomlTable& table, const std::string& key, Eigen::Index count,
                                      bool required = true);
void check_unique(const std::string& kind, const std::string& name, std::vector<std::string>& seen,
                  io::TomlTable& table);

/// The table `mesh` of a muscle whose path, pre-stretch and material are read.
void read_muscle_mesh(io::TomlTable& muscle, const Draft& draft, LimbMuscle& out);

void read_bones(io::TomlTable& root, Draft& draft);

}  // namespace brachium::pipelines::limb_parts
