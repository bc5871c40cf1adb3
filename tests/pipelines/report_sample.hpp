#pragma once
/// A report as large and as varied as a real one: 6 trials x 7 muscles x 30 s, raw signals at 2 kHz. All numbers are
/// made up by closed formulas and a generator with a fixed seed.

#include "pipelines/report/document.hpp"

namespace brachium::tests {

pipelines::report::Document sample_report();

}  // namespace brachium::tests
