#include <unistd.h>

#include <iostream>

#include "pipelines/command_line.hpp"
#include "pipelines/interrupt.hpp"

int main(int argc, char** argv) {
  namespace pipelines = brachium::pipelines;
  const std::atomic<bool>& stop = pipelines::watch_interrupts();
  return pipelines::command_line(argc, argv, pipelines::built_in_catalogue(),
                                 {std::cout, std::cerr, ::isatty(STDERR_FILENO) == 1, &stop});
}
