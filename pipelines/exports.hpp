#pragma once
/// What is written of a stage's output beside its HDF5 file: a calibrated subject, OpenSim storage files.

#include "pipelines/runner.hpp"

namespace brachium::pipelines {

/// <stage>.subject.toml where the output has a subject; with `export_sto`, <NN>-<stage>-<trial>.sto (one file
/// for each distinct set of time stamps). Files that stand are not written again. Throws
/// InputError("write-failed", ...).
void write_exports(const StageDefinition& stage, const StageRecord& record, const StageData& data);

}  // namespace brachium::pipelines
