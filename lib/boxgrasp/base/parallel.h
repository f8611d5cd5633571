// Parallel loops whose result does not depend on the number of threads.
#pragma once

#include <cstddef>
#include <functional>

namespace boxgrasp {

// Calls body(i) for every i in [0, n) on up to `threads` threads (1 = the calling thread, 0 = all cores).
// Each call writes only to its own slot, so the result is the same for any number of threads. The exception
// of the smallest throwing index is rethrown.
void parallelFor(std::size_t n, int threads, const std::function<void(std::size_t)>& body);

}  // namespace boxgrasp
