#include "fem/linear/blas_threads.hpp"

extern "C" {
int openblas_get_num_threads(void);
void openblas_set_num_threads(int threads);
}

namespace brachium::fem {

BlasThreads::BlasThreads(int threads) : former_(openblas_get_num_threads()) {
  if (threads != former_) openblas_set_num_threads(threads);
}

BlasThreads::~BlasThreads() {
  if (openblas_get_num_threads() != former_) openblas_set_num_threads(former_);
}

}  // namespace brachium::fem
