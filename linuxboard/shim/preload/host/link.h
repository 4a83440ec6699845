#pragma once
// The way to the node: memory that the program's processes share with it, and a socket that the node passed
// on.

#include "linuxboard/shim/wire/wire.h"

#include <cstddef>

namespace puckloop::shim {

namespace wire = linuxboard::wire;

/// True if this process is one of a program that a node started. Ends it if it is one that the node does not
/// know.
bool connect_link();
using Completed = void (*)(const wire::Completion& completion, const char* data);
/// Gives `request` with `size` bytes of data, at most kMaximumData, to the node and waits for the reply; ends
/// the process if the node is gone.
void exchange(const wire::Request& request, const void* data, std::size_t size, wire::Reply& reply,
              Completed completed);
void send_only(const wire::Request& request);
/// This process, or one it descends from, was started by a node: page() is there.
bool is_linked();
/// The descriptor belongs to this library: the program may not close it.
bool is_link_descriptor(int fd);
/// How many descriptors a process must be allowed to have for the link to be among them.
int link_descriptors();
/// The descriptor that came with the last reply, or -1; once.
int take_passed();
wire::Page& page();
/// This process's own.
wire::Channel& channel();
std::uint32_t own_slot();
inline wire::ProcessEntry& own() {
    return page().processes[own_slot()];
}
/// Memory that the node shares, `offset` bytes from its beginning, at an address as mmap() finds it.
void* map_shared(void* address, std::size_t length, int protection, int flags, std::uint64_t offset);
/// In a forked child: from now on this process is the one at `slot`, linked by `socket`, which is taken.
void change_link(int socket, std::uint32_t slot);
/// "<socket>,<page>,<slot>", the value of the variable that leads a program to its link.
void print_link(char* text, std::size_t size, std::uint32_t slot);
/// In a process that only makes another one: puts `socket` where that one will look for its link.
void place_link(int socket);
/// Ends the process with one line on standard error.
[[noreturn]] void refuse(const char* text);

}  // namespace puckloop::shim
