#pragma once
/// What a study is about, for its report: the recordings and the scene with the sources and assumptions of
/// its numbers.

#include "pipelines/assemble_report.hpp"

namespace brachium::pipelines {

/// Subject, number of trials, date.
std::string study_subtitle(const RunResult& result, const RunData& data);

/// What the recordings' description assumes, as warnings before all others of that weight.
void add_assumptions(const RunData& data, report::Document& document);

/// Chapters "Recordings" and "Scene", as far as the pipeline has them.
void add_study_sections(const Definition& definition, const RunData& data, report::Document& document);

}  // namespace brachium::pipelines
