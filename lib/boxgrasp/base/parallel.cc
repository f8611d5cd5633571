#include "boxgrasp/base/parallel.h"

#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <exception>
#include <vector>

#ifdef BOXGRASP_THREAD_SANITIZER
#include <sanitizer/tsan_interface.h>
#endif

namespace boxgrasp {
namespace {

// TBB is not built with the thread sanitizer, which so cannot see how it hands work over; it is told. One
// side releases what the other acquires; that the bodies order nothing among themselves stays visible.
class HandOver {
 public:
#ifdef BOXGRASP_THREAD_SANITIZER
  void release() { __tsan_release(this); }
  void acquire() { __tsan_acquire(this); }
#else
  void release() {}
  void acquire() {}
#endif
};

void inArena(std::size_t n, int threads, const std::function<void(std::size_t)>& body) {
  std::vector<std::exception_ptr> failures(n);
  HandOver to_bodies, from_bodies;
  to_bodies.release();
  tbb::task_arena arena(threads == 0 ? tbb::task_arena::automatic : threads);
  arena.execute([&] {
    tbb::parallel_for(std::size_t{0}, n, [&](std::size_t i) {
      to_bodies.acquire();
      try {
        body(i);
      } catch (...) {
        failures[i] = std::current_exception();
      }
      from_bodies.release();
    });
  });
  from_bodies.acquire();
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
