#pragma once
/// Ctrl-C as a flag: the first one lets the run end in order, a second one ends the program at once (outputs
/// are renamed into place only when whole, so nothing is damaged either way).

#include <atomic>

namespace brachium::pipelines {

/// Installs the handlers of SIGINT and SIGTERM, and lets writing past a file size limit fail like a full
/// disk.
const std::atomic<bool>& watch_interrupts();

}  // namespace brachium::pipelines
