#pragma once
// The way to the node: a socket that the node passed on, and the page of memory they share.

#include "linuxboard/shim/wire.h"

#include <cstddef>

namespace puckloop::shim {

namespace wire = linuxboard::wire;

/// True if a node started this very process and waits for it.
bool connect_link();
using Completed = void (*)(const wire::Completion& completion, const char* data);
/// Sends `request` and waits for the reply; ends the process if the node is gone.
void exchange(const wire::Request& request, const void* data, std::size_t size, wire::Reply& reply,
              Completed completed);
void send_only(const wire::Request& request);
/// This process, or one it descends from, was started by a node: page() is there.
bool is_linked();
/// The descriptor belongs to this library: the program may not close it.
bool is_link_descriptor(int fd);
wire::Page& page();

}  // namespace puckloop::shim
