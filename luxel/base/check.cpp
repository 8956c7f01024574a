#include "luxel/base/check.h"

#include <cstdio>
#include <cstdlib>

namespace luxel {
inline namespace base {

void check_failed(const char* condition, const char* file, int line) {
  std::fprintf(stderr, "luxel: internal error: %s does not hold (%s:%d); please report this\n",
               condition, file, line);
  std::abort();
}

}  // namespace base
}  // namespace luxel
