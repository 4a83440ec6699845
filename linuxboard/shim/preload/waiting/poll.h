#pragma once
// Waiting for several descriptors.

#include "linuxboard/shim/preload/scheduler/scheduler.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace puckloop::shim {

/// Sockets and devices that one wait can be for.
inline constexpr std::size_t kMostPolled = wire::kMaximumData / sizeof(wire::PollEntry);

// poll_calls.cpp
/// An entry of poll(). `seen` is of an edge-triggered socket, as in wire::PollEntry.
struct PollItem {
    int fd = -1;
    short events = 0;
    short revents = 0;
    std::uint32_t seen = 0;
};
int poll_items(PollItem* items, std::size_t count, Time deadline);

// epoll_calls.cpp
/// Adds what the epoll `epoll_fd` watches of devices and sockets, by other epolls too.
void add_watched(int epoll_fd, std::vector<PollItem>& items);
/// A host's epoll watches something that neither this program nor time moves.
bool epoll_watches_outside();

}  // namespace puckloop::shim
