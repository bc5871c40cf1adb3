#pragma once
/// The program `brachium`: its commands over a catalogue of stages. Only here anything is printed.

#include <atomic>
#include <ostream>

#include "pipelines/stage.hpp"

namespace brachium::pipelines {

struct Console {
  std::ostream& out;  ///< results
  std::ostream& err;  ///< progress and errors
  bool err_is_terminal = false;
  const std::atomic<bool>* stop = nullptr;  ///< set when the user wants the run to end
};

/// Runs one command; returns the exit code: 0 done, 1 numerical failure or missed expectation, 2 wrong input,
/// 130 stopped. Throws nothing.
int command_line(int argc, const char* const* argv, const Catalogue& catalogue, Console console);

}  // namespace brachium::pipelines
