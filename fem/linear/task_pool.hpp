#pragma once
/// Threads that work on a tree of tasks, children before parents, and help each other inside large tasks. The
/// pool decides who computes what and when, never what is computed.

#include <functional>
#include <memory>
#include <span>

namespace brachium::fem {

class TaskPool {
 public:
  /// `threads` >= 1, the caller of run_tree included.
  explicit TaskPool(int threads);
  ~TaskPool();
  TaskPool(const TaskPool&) = delete;
  TaskPool& operator=(const TaskPool&) = delete;

  int threads() const;

  /// Calls task(t) for every t, children before their parents (parent[t] > t, or -1). Of the tasks that are
  /// ready the one with the largest priority goes first. The exception of the lowest t is rethrown; parents
  /// of a failed task are not started.
  void run_tree(std::span<const int> parent, std::span<const double> priority,
                const std::function<void(int)>& task);

  /// From inside a task: calls item(i) for i in [0, count), with the help of threads that have no task of
  /// their own. Items do not throw.
  void run_loop(int count, const std::function<void(int)>& item);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace brachium::fem
