#pragma once
// Descriptors that are not devices (pipes, sockets) and may block the one running thread.

#include "linuxboard/shim/preload/scheduler/scheduler.h"

namespace puckloop::shim {

/// Waits until the host reports that `fd` is ready for `events`; false if a signal came first.
bool await_external(int fd, short events);
void mark_internal(int fd);
void forget_internal(int fd);
bool is_internal(int fd);
bool is_named_pipe(const char* path);
/// A pipe or a socket: what waits for it waits for another process (channel.cpp).
bool is_channel(int fd);
/// Lets a millisecond pass, or until `deadline`, before something outside is looked at again. False after a
/// signal that ends the call.
bool look_again(Time deadline);

}  // namespace puckloop::shim
