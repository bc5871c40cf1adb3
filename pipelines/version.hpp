#pragma once
/// Which program made a result.

#include <map>
#include <string>

namespace brachium::pipelines {

/// "0.1.0", followed by the state of the checkout it was built from, if any: "0.1.0+g1a2b3c4" for a commit,
/// "0.1.0+g1a2b3c4.d5e6f7a8" with changes that are not committed (a digest of them).
const std::string& program_version();

/// "compiler", "build type", "Eigen", "HDF5", ... -> version.
std::map<std::string, std::string> build_versions();

}  // namespace brachium::pipelines
