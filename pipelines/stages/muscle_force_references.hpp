#pragma once
/// Reference forces and moments of continuum muscles, from options, files and lumped muscles: what
/// optimise.muscle_forces fits.

#include <vector>

#include "optimise/muscle_force_fit.hpp"
#include "pipelines/stage.hpp"

namespace brachium::pipelines {

OptionSpec reference_option();

/// Those of one muscle, in the order they are given; none where no table names it. Throws InputError with its place: "contradiction",
/// "missing-option", "wrong-length", "out-of-range", and as data/io/csv.hpp does.
std::vector<optimise::ReferenceForce> reference_forces(const Options& options, const std::string& muscle);

}  // namespace brachium::pipelines
