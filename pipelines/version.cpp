#include "pipelines/version.hpp"

#include <fmt/format.h>
#include <Eigen/Core>
#include <nlohmann/json.hpp>

#include "brachium_version.h"

namespace brachium::pipelines {

const std::string& program_version() {
  static const std::string version = BRACHIUM_VERSION;
  return version;
}

std::map<std::string, std::string> build_versions() {
  return {
#if defined(__clang__)
    {"compiler", "Clang " __clang_version__},
#elif defined(__GNUC__)
    {"compiler", "GCC " __VERSION__},
#endif
        {"build type", BRACHIUM_BUILD_TYPE},
        {"Eigen", fmt::format("{}.{}.{}", EIGEN_WORLD_VERSION, EIGEN_MAJOR_VERSION, EIGEN_MINOR_VERSION)},
        {"fmt", fmt::format("{}.{}.{}", FMT_VERSION / 10000, FMT_VERSION / 100 % 100, FMT_VERSION % 100)},
        {"nlohmann_json", fmt::format("{}.{}.{}", NLOHMANN_JSON_VERSION_MAJOR, NLOHMANN_JSON_VERSION_MINOR,
                                      NLOHMANN_JSON_VERSION_PATCH)},
        {"HDF5", BRACHIUM_HDF5_VERSION}, {"NLopt", BRACHIUM_NLOPT_VERSION}, {
      "GSL", BRACHIUM_GSL_VERSION
    }
  };
}

}  // namespace brachium::pipelines
