#pragma once
/// The continuum limb as a file: bones, hinge, muscles as parametric bodies, the forearm's load.
///
///   [limb]      title, range_deg, and where hinge and humerus lie in the bones' coordinates
///   [load]      arm_mm
///   [[bone]]    name, segment, and one of sphere, capsule, ellipsoid, triangles
///   [[muscle]]  name, action, source, origin, insertion, obstacle, belly with tendons or mesh, material,
///               pre-stretch
///
/// Muscles are given in the arm's frame of fem/limb/cable_path.hpp: the hinge is z through the origin, x
/// anterior, y proximal. Bones may come in a frame of their own (an imaging device's), which [limb] then
/// names.

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "fem/limb/muscle_states.hpp"
#include "fem/limb/upper_limb.hpp"

namespace brachium::pipelines {

enum class LimbVariant { rigid_tendon, mtc };
LimbVariant parse_limb_variant(const std::string& name);  ///< "rigid_tendon", "mtc"
std::string to_string(LimbVariant variant);

struct LimbMuscle {
  fem::MuscleBody body;  ///< of the variant that was asked for
  bool flexor = true;
  std::string source;
  /// Imported as it is in the arm at body.reference_rad: the body's shape is a first guess until
  /// make_stress_free.
  std::optional<data::Mesh> in_situ;
};

/// A bone's surface for pictures; in the arm's frame at 0 deg [m].
struct BoneSurface {
  std::string bone;
  bool moves = false;  ///< with the forearm
  Eigen::Matrix3Xd points;
  Eigen::Matrix3Xi triangles;
};

struct LimbScene {
  std::string title, file;
  LimbVariant variant = LimbVariant::rigid_tendon;
  fem::Hinge hinge;
  fem::AngleRange range;
  std::vector<fem::Bone> humerus;    ///< at rest: what muscles may touch
  std::vector<std::string> forearm;  ///< names of bones that move with the forearm: drawn, no contact
  std::vector<BoneSurface> surfaces;
  std::vector<LimbMuscle> muscles;
  double load_arm_m = 0.0;        ///< distance of the load from the hinge; 0: the scene has none
  double forearm_length_m = 0.0;  ///< elbow to wrist; 0: not given

  const LimbMuscle& muscle(const std::string& name) const;  ///< throws InputError("missing-muscle")
  std::vector<std::string> muscle_names() const;
};

/// Reads the file strictly: every mistake at once with file:line:column. Geometry that cannot be built is
/// refused as fem::check does ("limb-geometry"), with the muscle's place. `mesh`: how finely the muscles are
/// meshed.
LimbScene read_limb(const std::filesystem::path& file, LimbVariant variant, const fem::LimbMesh& mesh = {});

/// Meshes and triangle files that a limb file names, those that exist; none of a file that is no limb.
std::vector<std::filesystem::path> files_of_limb(const std::filesystem::path& file);

/// Finds the stress-free shape of a muscle of the limb that was imported in situ (fem/limb/in_situ.hpp): costly.
/// A line about it; none where the muscle is stress-free already.
std::optional<std::string> make_stress_free(LimbMuscle& muscle, const LimbScene& limb,
                                            const fem::SolvedMuscleOptions& options);

/// The same from a text; `folder` is what triangle files are relative to.
LimbScene parse_limb(const std::string& text, const std::string& file_name,
                     const std::filesystem::path& folder, LimbVariant variant,
                     const fem::LimbMesh& mesh = {});

}  // namespace brachium::pipelines
