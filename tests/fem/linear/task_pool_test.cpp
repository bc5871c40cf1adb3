#include "fem/linear/task_pool.hpp"

#include <atomic>
#include <stdexcept>
#include <vector>

namespace brachium::fem {
namespace {

// A binary tree in postorder, children before parents.
std::vector<int> binary_tree(int depth) {
  std::vector<int> parent;
  const std::function<int(int)> build = [&](int level) {
    const int left = level > 0 ? build(level - 1) : -1, right = level > 0 ? build(level - 1) : -1;
    const int me = static_cast<int>(parent.size());
    parent.push_back(-1);
    if (left >= 0) parent[left] = parent[right] = me;
    return me;
  };
  build(depth);
  return parent;
}

TEST(TaskPool, RunsEveryTaskOnceAndChildrenFirst) {
  const std::vector<int> parent = binary_tree(8);
  const std::vector<double> priority(parent.size(), 1.0);
  for (const int threads : {1, 2, 4}) {
    TaskPool pool(threads);
    for (int repeat = 0; repeat < 20; ++repeat) {
      std::vector<std::atomic<int>> runs(parent.size()), children(parent.size());
      std::atomic<bool> early{false};
      pool.run_tree(parent, priority, [&](int t) {
        const bool leaf = t == 0 || parent[t - 1] != t;
        if (!leaf && children[t] != 2) early = true;
        ++runs[t];
        if (parent[t] >= 0) ++children[parent[t]];
      });
      EXPECT_FALSE(early);
      for (const auto& r : runs) EXPECT_EQ(r, 1);
    }
  }
}

TEST(TaskPool, LoopsInsideTasksDoEveryItemOnceBeforeTheyReturn) {
  const std::vector<int> parent = binary_tree(4);
  const std::vector<double> priority(parent.size(), 1.0);
  TaskPool pool(3);
  for (int repeat = 0; repeat < 50; ++repeat) {
    std::atomic<bool> wrong{false};
    pool.run_tree(parent, priority, [&](int) {
      for (const int count : {0, 1, 7, 100}) {
        std::vector<std::atomic<int>> done(count);
        pool.run_loop(count, [&](int i) { ++done[i]; });
        for (const auto& d : done) wrong = wrong || d != 1;
      }
    });
    EXPECT_FALSE(wrong);
  }
}

TEST(TaskPool, AnExceptionEndsTheTreeAndThePoolGoesOn) {
  const std::vector<int> parent = binary_tree(5);
  const std::vector<double> priority(parent.size(), 1.0);
  for (const int threads : {1, 3}) {
    TaskPool pool(threads);
    std::atomic<bool> root_ran{false};
    const auto fail = [&](int t) {
      if (t == 5) throw std::runtime_error("five");
      if (parent[t] < 0) root_ran = true;
    };
    EXPECT_THROW(pool.run_tree(parent, priority, fail), std::runtime_error);
    EXPECT_FALSE(root_ran);
    std::atomic<int> count{0};
    pool.run_tree(parent, priority, [&](int) { ++count; });
    EXPECT_EQ(count, static_cast<int>(parent.size()));
  }
}

}  // namespace
}  // namespace brachium::fem
