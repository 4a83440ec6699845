#pragma once
// Sockets of a board that is on a network: descriptors of the node's network stack. Behind each lies a socket
// of the host that is connected to nothing. On a board without a network, and for other families than IPv4,
// sockets are the host's.

#include "linuxboard/shim/preload/descriptors/open_file.h"

#include <netinet/in.h>
#include <sys/socket.h>

#include <cstddef>
#include <cstdint>

namespace puckloop::shim {

/// The board is on a network, and this process is conducted.
bool networked();
/// The socket behind a descriptor, or nullptr.
OpenFile* socket_file(int fd);

/// Names once what the network has refused, by errno; `result` and errno stay.
std::int64_t named(std::int64_t result, const wire::SocketAddress& address);

/// As much of an address as there is room for, as the kernel does; false and errno if it cannot be put.
bool put_address(const OpenFile& file, const wire::SocketAddress& address, sockaddr* theirs,
                 socklen_t* length);

/// What a socket's call sends, from a program's or this library's memory; `to` may be nullptr.
std::int64_t send_bytes(OpenFile& file, const char* data, std::size_t size, int flags,
                        const wire::SocketAddress* to);

// passed_files.cpp: descriptors that go to another process beside a message (SCM_RIGHTS). Those of sockets
// of the network are announced to the node before the message, and taken from it after.
void give_descriptors(const msghdr& message);
void take_descriptors(msghdr& message);
/// The message was not sent.
void forget_given(const msghdr& message);

/// sendfile() to the socket `to`.
std::int64_t send_file(int to, int from, off_t* offset, std::size_t size);

/// A name on the network, without regard to case; 0: unknown. "localhost" and the board's own name are known.
std::uint32_t address_of_name(const char* name);
/// The name of an address, or nullptr.
const char* name_of_address(std::uint32_t address);
/// "10.0.0.1" and what else inet_aton() takes.
bool is_numeric(const char* text, std::uint32_t& address);

/// A descriptor of a file that is of the network (network_files.cpp), -1 for another path.
int open_network_file(const char* path);

}  // namespace puckloop::shim
