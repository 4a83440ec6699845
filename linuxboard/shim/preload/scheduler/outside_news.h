#pragma once
// What happens outside of this process: threads that wait for it look again.

#include "linuxboard/shim/preload/scheduler/scheduler.h"

namespace puckloop::shim {

/// Something was written or closed: those who wait outside look again.
void external_changed();
/// The same for the program's other processes, where it has some.
void tell_others();
/// park() on an object that may be `shared` with other processes: theirs do not wake, so it is looked at
/// every millisecond as long as there are some.
Wake park_shared(const void* key, WaitOptions options, bool shared);
/// How often outside descriptors are looked at, in simulated time.
inline constexpr Time kExternalPeriod = kMillisecond;

}  // namespace puckloop::shim
