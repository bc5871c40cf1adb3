/// The command line over the catalogue of the tests, as a program that tests can start, stop and kill.

#include <unistd.h>

#include <iostream>

#include "pipelines/command_line.hpp"
#include "pipelines/interrupt.hpp"
#include "runner_fake_stages.hpp"

int main(int argc, char** argv) {
  namespace pipelines = brachium::pipelines;
  const std::atomic<bool>& stop = pipelines::watch_interrupts();
  return pipelines::command_line(argc, argv, pipelines::tests::fake_catalogue(),
                                 {std::cout, std::cerr, ::isatty(STDERR_FILENO) == 1, &stop});
}
