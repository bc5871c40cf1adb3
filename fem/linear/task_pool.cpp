#include "fem/linear/task_pool.hpp"

#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

namespace brachium::fem {

namespace {

constexpr int kSpins = 4000;  // about 50 us: longer than the gaps between the loops of one front

struct Loop {
  const std::function<void(int)>* item;
  int count;
  std::atomic<int> next{0}, done{0}, helpers{0};

  void work() {
    for (int i = next++; i < count; i = next++) {
      (*item)(i);
      ++done;
    }
  }
};

void pause() {
#if defined(__x86_64__)
  __builtin_ia32_pause();
#endif
}

}  // namespace

struct TaskPool::State {
  int threads;
  std::vector<std::thread> workers;
  std::mutex mutex;
  std::condition_variable wake;
  std::atomic<unsigned> signals{0};  // counts what a spinning thread waits for
  bool stop = false;

  // The tree at hand; null between trees.
  const std::function<void(int)>* task = nullptr;
  std::span<const int> parent;
  std::span<const double> priority;
  std::vector<int> waiting_for;
  std::vector<int> ready;
  std::vector<char> failed;
  std::size_t open = 0;
  int busy = 0;
  int failed_task = -1;
  std::exception_ptr error;
  std::vector<Loop*> loops;

  void signal() {
    ++signals;
    wake.notify_all();
  }

  int take_ready() {
    const auto best = std::max_element(ready.begin(), ready.end(), [&](int a, int b) {
      return priority[a] != priority[b] ? priority[a] < priority[b] : a > b;
    });
    const int t = *best;
    ready.erase(best);
    return t;
  }

  // With the mutex held: t and, after a failure, all that needs it are done.
  void finish(int t) {
    for (bool ok = failed[t] == 0;; ok = false) {
      --open;
      const int p = parent[t];
      if (p < 0) return;
      if (!ok) failed[p] = 1;
      if (--waiting_for[p] > 0) return;
      if (failed[p] == 0) {
        ready.push_back(p);
        return;
      }
      t = p;
    }
  }

  // Works until the tree is done (the caller) or the pool ends (a worker).
  void work(bool caller) {
    std::unique_lock lock(mutex);
    while (true) {
      if (stop || (caller && open == 0)) return;
      if (!ready.empty()) {
        const int t = take_ready();
        lock.unlock();
        std::exception_ptr thrown;
        try {
          (*task)(t);
        } catch (...) {
          thrown = std::current_exception();
        }
        lock.lock();
        if (thrown) {
          failed[t] = 1;
          if (failed_task < 0 || t < failed_task) {
            failed_task = t;
            error = thrown;
          }
        }
        finish(t);
        signal();
        continue;
      }
      const auto loop =
          std::find_if(loops.begin(), loops.end(), [](const Loop* l) { return l->next < l->count; });
      if (loop != loops.end()) {
        Loop* mine = *loop;
        ++mine->helpers;
        lock.unlock();
        mine->work();
        --mine->helpers;
        lock.lock();
        continue;
      }
      const unsigned seen = signals;
      if (task != nullptr) {
        lock.unlock();
        for (int k = 0; k < kSpins && signals == seen; ++k) pause();
        lock.lock();
        if (signals != seen) continue;
      }
      wake.wait(lock, [&] { return stop || signals != seen; });
    }
  }
};

TaskPool::TaskPool(int threads) : state_(std::make_unique<State>()) {
  state_->threads = std::max(1, threads);
  for (int t = 1; t < state_->threads; ++t) state_->workers.emplace_back([this] { state_->work(false); });
}

TaskPool::~TaskPool() {
  {
    const std::lock_guard lock(state_->mutex);
    state_->stop = true;
    state_->signal();
  }
  for (std::thread& worker : state_->workers) worker.join();
}

int TaskPool::threads() const {
  return state_->threads;
}

void TaskPool::run_tree(std::span<const int> parent, std::span<const double> priority,
                        const std::function<void(int)>& task) {
  State& s = *state_;
  {
    const std::lock_guard lock(s.mutex);
    s.parent = parent;
    s.priority = priority;
    s.waiting_for.assign(parent.size(), 0);
    for (const int p : parent) {
      if (p >= 0) ++s.waiting_for[p];
    }
    s.ready.clear();
    for (std::size_t t = 0; t < parent.size(); ++t) {
      if (s.waiting_for[t] == 0) s.ready.push_back(static_cast<int>(t));
    }
    s.failed.assign(parent.size(), 0);
    s.failed_task = -1;
    s.error = nullptr;
    s.open = parent.size();
    s.task = &task;
    s.signal();
  }
  s.work(true);
  const std::lock_guard lock(s.mutex);
  s.task = nullptr;
  if (s.error) std::rethrow_exception(s.error);
}

void TaskPool::run_loop(int count, const std::function<void(int)>& item) {
  State& s = *state_;
  if (s.threads == 1 || count <= 1) {
    for (int i = 0; i < count; ++i) item(i);
    return;
  }
  Loop loop{&item, count};
  {
    const std::lock_guard lock(s.mutex);
    s.loops.push_back(&loop);
    s.signal();
  }
  loop.work();
  {
    const std::lock_guard lock(s.mutex);
    s.loops.erase(std::find(s.loops.begin(), s.loops.end(), &loop));
  }
  // No one joins any more; those who did may still be at their last item.
  while (loop.done < count || loop.helpers > 0) pause();
}

}  // namespace brachium::fem
