#include "luxel/base/parallel.h"

#include <tbb/global_control.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <exception>
#include <thread>

#if defined(__SSE2__)
#include <xmmintrin.h>
#endif

#if defined(LUXEL_SANITIZE_THREADS)
#include <sanitizer/tsan_interface.h>
#endif

#include "luxel/base/check.h"

namespace luxel {
inline namespace base {
namespace {

/// Sets flush-to-zero and denormals-are-zero while it lives, then restores what was there.
class FlushDenormals {
 public:
#if defined(__SSE2__)
  FlushDenormals() : before_(_mm_getcsr()) { _mm_setcsr(before_ | 0x8040u); }
  ~FlushDenormals() { _mm_setcsr(before_); }

 private:
  unsigned before_;
#else
  FlushDenormals() {}
  ~FlushDenormals() {}
#endif
};

/// Tells ThreadSanitizer the order of loops in a library that it does not know: all before a loop
/// happens before every body of it, and every body before what follows. Bodies are not ordered.
class LoopOrder {
 public:
#if defined(LUXEL_SANITIZE_THREADS)
  LoopOrder() { __tsan_release(&begin_); }
  ~LoopOrder() { __tsan_acquire(&end_); }
  void body_begins() { __tsan_acquire(&begin_); }
  void body_ends() { __tsan_release(&end_); }

 private:
  char begin_ = 0, end_ = 0;
#else
  LoopOrder() {}
  ~LoopOrder() {}
  void body_begins() {}
  void body_ends() {}
#endif
};

}  // namespace

struct ThreadLimit::State {
  tbb::global_control control;
};

ThreadLimit::ThreadLimit(int threads) : exceptions_before_(std::uncaught_exceptions()) {
  LUXEL_CHECK(threads >= 0);
  const size_t all = std::max(1u, std::thread::hardware_concurrency());
  const size_t limit = threads == 0 ? all : size_t(threads);
  state_.reset(new State{{tbb::global_control::max_allowed_parallelism, limit}});
}
/// Memory that ends within TBB leaves its own lock taken: the end of its limit would wait for ever.
/// Then the limit stays, and the process ends soon.
ThreadLimit::~ThreadLimit() {
  if (std::uncaught_exceptions() > exceptions_before_) static_cast<void>(state_.release());
}

int thread_count() {
  const size_t allowed =
      tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism);
  return int(allowed);
}

void parallel_for(size_t count, size_t grain, const std::function<void(size_t, size_t)>& body) {
  LUXEL_CHECK(grain > 0);
  const size_t blocks = (count + grain - 1) / grain;
  LoopOrder order;
  tbb::parallel_for(size_t(0), blocks, [&](size_t block) {
    const FlushDenormals flush;
    order.body_begins();
    body(block * grain, std::min(count, (block + 1) * grain));
    order.body_ends();
  });
}

}  // namespace base
}  // namespace luxel
