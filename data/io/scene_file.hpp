#pragma once
/// Scenes as TOML: what is modelled, with the source of every number.

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "data/io/toml.hpp"
#include "data/model/scene.hpp"

namespace brachium::io {

/// Reads a scene strictly. Every mistake of the file is reported at once, each with file:line:column and the
/// nearest valid name. Geometry tables named by `csv` are read relative to the scene's folder. What no wanted
/// quantity depends on is left out, and said in Scene::notes, as are undriven muscles.
/// `channels`: the session's channels where they are known; a drive that names another one is then a mistake
/// ("unmapped-channel"). Empty: not checked here (limb::drive_map checks again).
data::Scene read_scene(const std::filesystem::path& file, std::span<const std::string> channels = {});

/// The same from a text; `file_name` is for messages, `folder` is what csv files are relative to.
data::Scene parse_scene(const std::string& text, const std::string& file_name,
                        const std::filesystem::path& folder, std::span<const std::string> channels = {});

/// The resolved scene as a tree and as TOML: fractions as values, csv tables inline. Reading it again gives
/// the same scene (notes of what was left out excepted: it is no longer there).
TomlNode scene_tree(const data::Scene& scene);
std::string write_scene(const data::Scene& scene);

}  // namespace brachium::io
