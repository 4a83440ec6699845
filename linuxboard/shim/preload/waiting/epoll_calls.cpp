// epoll: devices are registered here, everything else with the host's epoll, which is then one outside
// descriptor more. Sockets and serial ports can be edge-triggered, cameras behave as level-triggered ones
// then.

#include "linuxboard/shim/preload/descriptors/external.h"
#include "linuxboard/shim/preload/descriptors/open_file.h"
#include "linuxboard/shim/preload/host/failure.h"
#include "linuxboard/shim/preload/host/host.h"
#include "linuxboard/shim/preload/host/program_memory.h"
#include "linuxboard/shim/preload/host/real.h"
#include "linuxboard/shim/preload/scheduler/board_clock.h"
#include "linuxboard/shim/preload/scheduler/scheduler.h"
#include "linuxboard/shim/preload/time/clocks.h"
#include "linuxboard/shim/preload/waiting/poll.h"

#include <fcntl.h>
#include <poll.h>
#include <sys/epoll.h>
#include <sys/syscall.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <vector>

using namespace puckloop::shim;

namespace {
constexpr int kMostWatches = kMostPolled;

struct Watch {
    int epoll_fd = -1;
    int fd = -1;
    epoll_event event{};
    bool armed = false;
    std::uint32_t seen = 0;  ///< of an edge-triggered one: its activity when it was reported
};
int watch_end = 0;  ///< no watch lies behind
bool watches_outside = false;
Watch watches[kMostWatches];

Watch* find_watch(int epoll_fd, int fd) {
    for (int i = 0; i < watch_end; ++i)
        if (watches[i].epoll_fd == epoll_fd && watches[i].fd == fd) return &watches[i];
    return nullptr;
}

int change_watch(int epoll_fd, int operation, int fd, const epoll_event* event) {
    Watch* watch = find_watch(epoll_fd, fd);
    if (operation == EPOLL_CTL_DEL) {
        if (watch == nullptr) return fail(ENOENT);
        *watch = {};
        return 0;
    }
    if ((operation == EPOLL_CTL_ADD) != (watch == nullptr)) {
        errno = watch == nullptr ? ENOENT : EEXIST;
        return -1;
    }
    if (watch == nullptr) watch = find_watch(-1, -1);
    if (watch == nullptr && watch_end < kMostWatches) watch = &watches[watch_end++];
    if (watch == nullptr) {
        note("the program watches more than %d sockets and devices", kMostWatches);
        return fail(ENOSPC);
    }
    const bool edge = (event->events & EPOLLET) != 0;
    *watch = {epoll_fd, fd, *event, true, edge ? wire::kNeverSeen : 0};
    return 0;
}

PollItem item_of(const Watch& watch) {
    constexpr std::uint32_t kKnown = POLLIN | POLLOUT | POLLPRI | POLLRDNORM | POLLWRNORM | POLLRDHUP;
    return {watch.fd, static_cast<short>(watch.event.events & kKnown), 0, watch.seen};
}

/// An epoll that the one waited for watches, and what it watches in turn among the entries of that wait.
struct Nested {
    Watch* watch = nullptr;
    std::size_t begin = 0, end = 0;
};

/// Epolls of which something watched is ready become events.
int gather_nested(const std::vector<Nested>& all, const std::vector<PollItem>& entries, epoll_event* events,
                  int most) {
    int total = 0;
    for (const Nested& nested : all) {
        const bool ready = std::any_of(entries.begin() + static_cast<std::ptrdiff_t>(nested.begin),
                                       entries.begin() + static_cast<std::ptrdiff_t>(nested.end),
                                       [](const PollItem& entry) { return entry.revents != 0; });
        if (!ready || total == most || (nested.watch->event.events & EPOLLIN) == 0) continue;
        events[total] = nested.watch->event;
        events[total++].events = EPOLLIN;
        if ((nested.watch->event.events & EPOLLONESHOT) != 0) nested.watch->armed = false;
    }
    return total;
}

/// Devices that are ready in `entries` become events.
int gather(int epoll_fd, const PollItem* entries, nfds_t count, epoll_event* events, int most) {
    int total = 0;
    for (nfds_t i = 0; i < count && total < most; ++i) {
        if (entries[i].revents == 0 || entries[i].fd == epoll_fd) continue;
        Watch* watch = find_watch(epoll_fd, entries[i].fd);
        if (watch == nullptr) continue;
        events[total] = watch->event;
        events[total++].events = static_cast<std::uint32_t>(entries[i].revents);
        if (watch->seen != 0) watch->seen = entries[i].seen;
        if ((watch->event.events & EPOLLONESHOT) != 0) watch->armed = false;
    }
    return total;
}
/// A descriptor of the host's epoll; errno if it is another one or none.
bool is_epoll(int fd) {
    if (REAL(fcntl)(fd, F_GETFD) < 0) return false;
    char path[40], target[64] = {};
    std::snprintf(path, sizeof path, "/proc/self/fd/%d", fd);
    host_call(SYS_readlinkat, AT_FDCWD, reinterpret_cast<long>(path), reinterpret_cast<long>(target),
              sizeof target - 1);
    if (std::strcmp(target, "anon_inode:[eventpoll]") == 0) return true;
    errno = EINVAL;
    return false;
}
}  // namespace

namespace puckloop::shim {
void drop_watches(int fd) {
    for (int i = 0; i < watch_end; ++i)
        if (watches[i].fd == fd) watches[i] = {};
}

void add_watched(int epoll_fd, std::vector<PollItem>& items) {
    for (int i = 0; i < watch_end; ++i) {
        const Watch& watch = watches[i];
        if (watch.epoll_fd != epoll_fd || !watch.armed) continue;
        if (open_file(watch.fd) != nullptr)
            items.push_back(item_of(watch));
        else
            add_watched(watch.fd, items);  // the kernel lets epolls watch each other in no circle
    }
}

bool epoll_watches_outside() {
    return watches_outside;
}
}  // namespace puckloop::shim

SHIM_EXPORT int epoll_create1(int flags) noexcept {
    const int fd = REAL(epoll_create1)(flags);
    if (active()) mark_internal(fd);
    // Of another epoll that had this number.
    for (int i = 0; i < watch_end; ++i)
        if (watches[i].epoll_fd == fd) watches[i] = {};
    return fd;
}

SHIM_EXPORT int epoll_create(int) noexcept {
    return epoll_create1(0);
}

SHIM_EXPORT int epoll_ctl(int epoll_fd, int operation, int fd, epoll_event* event) noexcept {
    if (open_file(fd) == nullptr) {
        watches_outside = watches_outside || !is_internal(fd);
        const int result = REAL(epoll_ctl)(epoll_fd, operation, fd, event);
        // The host does not see what an epoll watches here.
        const int error = errno;
        if (result == 0 && active() && is_internal(fd) && is_epoll(fd)) {
            Watch* const before = find_watch(epoll_fd, fd);
            if (operation == EPOLL_CTL_ADD && before != nullptr) *before = {};  // of one that was closed
            change_watch(epoll_fd, operation, fd, event);
        }
        errno = error;
        return result;
    }
    charge(page().charges.device);
    epoll_event wanted{};
    if (operation != EPOLL_CTL_DEL && !get_from_program(wanted, event)) return -1;
    if (open_file(fd)->kind == OpenFile::Kind::I2c) {  // i2c-dev has no poll method
        return fail(EPERM);
    }
    if (!is_epoll(epoll_fd)) return -1;
    if (operation != EPOLL_CTL_ADD && operation != EPOLL_CTL_MOD && operation != EPOLL_CTL_DEL)
        return fail(EINVAL);
    return change_watch(epoll_fd, operation, fd, &wanted);
}

static int wait_until(int epoll_fd, epoll_event* events, int most, Time deadline, const sigset_t* mask) {
    if (most <= 0) return fail(EINVAL);
    if (!is_epoll(epoll_fd)) return -1;
    std::vector<PollItem> entries{{epoll_fd, POLLIN, 0, 0}};
    std::vector<Nested> nested;
    for (int i = 0; i < watch_end; ++i) {
        Watch& watch = watches[i];
        if (watch.epoll_fd != epoll_fd || !watch.armed) continue;
        if (open_file(watch.fd) != nullptr)
            entries.push_back(item_of(watch));
        else
            nested.push_back({&watch});
    }
    const std::size_t direct = entries.size();
    for (Nested& one : nested) {
        one.begin = entries.size();
        add_watched(one.watch->fd, entries);
        one.end = entries.size();
    }
    static_cast<void>(mask);  // as ppoll() has it here, and its nanoseconds
    if (deadline != kNever)
        deadline = time_after(from_timespec(to_timespec(board_time(std::max<Time>(deadline - now(), 0)))));
    const int ready = poll_items(entries.data(), entries.size(), deadline);
    if (ready <= 0) return ready;
    std::vector<epoll_event> ready_devices(std::min<std::size_t>(entries.size(), most));
    const int room = static_cast<int>(ready_devices.size());
    int devices = gather(epoll_fd, entries.data(), direct, ready_devices.data(), room);
    devices += gather_nested(nested, entries, ready_devices.data() + devices, room - devices);
    if (!copy_to_program(events, ready_devices.data(),
                         static_cast<std::size_t>(devices) * sizeof(epoll_event)))
        return -1;
    if (entries[0].revents == 0 || devices == most) return devices;
    const int others = REAL(epoll_wait)(epoll_fd, events + devices, most - devices, 0);
    return others < 0 && devices == 0 ? others : devices + std::max(others, 0);
}

SHIM_EXPORT int epoll_pwait(int epoll_fd, epoll_event* events, int most, int timeout, const sigset_t* mask) {
    if (!active()) return REAL(epoll_pwait)(epoll_fd, events, most, timeout, mask);
    return wait_until(epoll_fd, events, most, timeout < 0 ? kNever : time_after(timeout * kMillisecond),
                      mask);
}

SHIM_EXPORT int epoll_wait(int epoll_fd, epoll_event* events, int most, int timeout) {
    if (!active()) return REAL(epoll_wait)(epoll_fd, events, most, timeout);
    return epoll_pwait(epoll_fd, events, most, timeout, nullptr);
}

SHIM_EXPORT int epoll_pwait2(int epoll_fd, epoll_event* events, int most, const timespec* timeout,
                             const sigset_t* mask) {
    if (!active()) return REAL(epoll_pwait2)(epoll_fd, events, most, timeout, mask);
    timespec time{};
    if (timeout != nullptr && !get_from_program(time, timeout)) return -1;
    if (!is_valid(time)) return fail(EINVAL);
    return wait_until(epoll_fd, events, most, timeout == nullptr ? kNever : time_after(from_timespec(time)),
                      mask);
}
