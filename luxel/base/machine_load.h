// How busy other programs keep the machine.
#pragma once

namespace luxel {
inline namespace base {

/// How many times as long as on an idle machine this thread has taken since it began: the time that
/// it had a processor or waited for one, over the time that it had one. 1 where the system does not
/// tell.
double machine_load();

}  // namespace base
}  // namespace luxel
