#pragma once
/// Work space of the fronts, used again from one factorisation to the next so that its pages are touched
/// once.

#include <cstddef>
#include <memory>
#include <mutex>
#include <vector>

namespace brachium::fem {

struct FreeAligned {
  void operator()(double* p) const;
};

/// Room for `size` doubles, aligned to 64 bytes, not initialised.
using AlignedArray = std::unique_ptr<double[], FreeAligned>;
AlignedArray allocate_aligned(std::size_t size);

struct Buffer {
  AlignedArray data;
  std::size_t capacity = 0;
};

class BufferPool {
 public:
  Buffer take(std::size_t size);
  void give(Buffer buffer);
  std::size_t bytes() const { return bytes_; }  ///< of all buffers, taken or not

 private:
  std::mutex mutex_;
  std::vector<Buffer> free_;  // capacity ascending
  std::size_t bytes_ = 0;
};

}  // namespace brachium::fem
