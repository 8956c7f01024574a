#include "luxel/base/thread_priority.h"

#ifdef __linux__
#include <sys/resource.h>
#endif

namespace luxel {
inline namespace base {

void lower_priority_of_this_thread() {
#ifdef __linux__
  // On Linux the nice value is a thread's own, though POSIX says it is the process's. At 10 a
  // thread gets a tenth of a processor that another one wants.
  setpriority(PRIO_PROCESS, 0, 10);
#endif
}

}  // namespace base
}  // namespace luxel
