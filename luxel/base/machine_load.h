// The load that other programs put on the machine.
#pragma once

namespace luxel {
inline namespace base {

/// The time since this thread began that it had a processor or waited for one, over the time that
/// it had one: 1 on an idle machine, 2 where it has to share with another thread. 1 where the
/// system does not tell.
double machine_load();

}  // namespace base
}  // namespace luxel
