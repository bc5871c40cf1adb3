#pragma once
/// Independent tasks on all cores. The result of task i depends on i alone, so it is the same for any number of threads.

#include <cstddef>
#include <functional>

namespace brachium::data {

/// Number of threads to use for `requested` (0: as many as the machine has cores).
std::size_t thread_count(std::size_t requested);

/// Calls task(i) for i in [0, count) on `threads` threads (0: all cores). If tasks throw, the exception of the
/// lowest index is rethrown once all running tasks have ended.
void parallel_for(std::size_t count, std::size_t threads, const std::function<void(std::size_t)>& task);

}  // namespace brachium::data
