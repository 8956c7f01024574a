// Work that should not slow others down.
#pragma once

namespace luxel {
inline namespace base {

/// From now on this thread, and those that it begins, get processors only where no other thread
/// wants them much. Does nothing where the system knows no priorities of threads.
void lower_priority_of_this_thread();

}  // namespace base
}  // namespace luxel
