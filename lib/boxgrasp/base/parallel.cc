#include "boxgrasp/base/parallel.h"

#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <exception>
#include <vector>

namespace boxgrasp {
namespace {

void inArena(std::size_t n, int threads, const std::function<void(std::size_t)>& body) {
  std::vector<std::exception_ptr> failures(n);
  tbb::task_arena arena(threads == 0 ? tbb::task_arena::automatic : threads);
  arena.execute([&] {
    tbb::parallel_for(std::size_t{0}, n, [&](std::size_t i) {
      try {
        body(i);
      } catch (...) {
        failures[i] = std::current_exception();
      }
    });
  });
  for (const auto& failure : failures) {
    if (failure) std::rethrow_exception(failure);
  }
}

}  // namespace

void parallelFor(std::size_t n, int threads, const std::function<void(std::size_t)>& body) {
  if (threads == 1 || n <= 1) {
    for (std::size_t i = 0; i < n; ++i) body(i);
    return;
  }
  inArena(n, threads, body);
}

}  // namespace boxgrasp
