#include "fem/linear/buffer_pool.hpp"

#include <algorithm>
#include <new>

namespace brachium::fem {

namespace {

constexpr std::align_val_t kAlignment{64};

bool smaller(const Buffer& a, std::size_t size) {
  return a.capacity < size;
}

}  // namespace

void FreeAligned::operator()(double* p) const {
  ::operator delete[](p, kAlignment);
}

AlignedArray allocate_aligned(std::size_t size) {
  return AlignedArray(
      static_cast<double*>(::operator new[](sizeof(double) * std::max<std::size_t>(size, 1), kAlignment)));
}

Buffer BufferPool::take(std::size_t size) {
  {
    const std::lock_guard lock(mutex_);
    const auto fit = std::lower_bound(free_.begin(), free_.end(), size, smaller);
    if (fit != free_.end() && fit->capacity <= 2 * size + 4096) {
      Buffer buffer = std::move(*fit);
      free_.erase(fit);
      return buffer;
    }
    // What is free but too small is given back, as much as is asked for: the pool does not grow beyond what
    // is in use.
    std::size_t released = 0;
    while (!free_.empty() && released < size && free_.back().capacity < size) {
      released += free_.back().capacity;
      bytes_ -= sizeof(double) * free_.back().capacity;
      free_.pop_back();
    }
    bytes_ += sizeof(double) * size;
  }
  return {allocate_aligned(size), size};
}

void BufferPool::give(Buffer buffer) {
  if (!buffer.data) return;
  const std::lock_guard lock(mutex_);
  const auto at = std::lower_bound(free_.begin(), free_.end(), buffer.capacity, smaller);
  free_.insert(at, std::move(buffer));
}

}  // namespace brachium::fem
