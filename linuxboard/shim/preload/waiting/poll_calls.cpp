// poll, select and epoll over our devices and everything else the program has open.
//
// Devices are waited for by the node, in simulated time; other descriptors are looked at on each wake-up and
// every millisecond of simulated time.

#include "linuxboard/shim/preload/descriptors/external.h"
#include "linuxboard/shim/preload/descriptors/open_file.h"
#include "linuxboard/shim/preload/host/failure.h"
#include "linuxboard/shim/preload/host/program_memory.h"
#include "linuxboard/shim/preload/host/real.h"
#include "linuxboard/shim/preload/scheduler/board_clock.h"
#include "linuxboard/shim/preload/scheduler/outside_news.h"
#include "linuxboard/shim/preload/scheduler/scheduler.h"
#include "linuxboard/shim/preload/scheduler/timers.h"
#include "linuxboard/shim/preload/time/clocks.h"
#include "linuxboard/shim/preload/waiting/outside.h"
#include "linuxboard/shim/preload/waiting/poll.h"

#include <poll.h>
#include <signal.h>
#include <sys/epoll.h>
#include <sys/select.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <vector>

using namespace puckloop::shim;

namespace puckloop::shim {

namespace {
constexpr nfds_t kMostEntries = FD_SETSIZE;

/// Room for so many, which are few nearly always.
template <typename T>
class Room {
  public:
    explicit Room(std::size_t count) {
        if (count > kFew) many_.resize(count);
        items_ = count > kFew ? many_.data() : few_;
    }
    Room(const Room&) = delete;
    Room& operator=(const Room&) = delete;
    T& operator[](std::size_t i) { return items_[i]; }
    T* data() { return items_; }

  private:
    static constexpr std::size_t kFew = 32;
    T few_[kFew];
    std::vector<T> many_;
    T* items_;
};

/// The device entries through the node until `deadline`; number ready, or -1 and EINTR.
int poll_devices(PollItem* entries, nfds_t count, Time deadline) {
    Room<wire::PollEntry> list(count);
    Room<nfds_t> indices(count);
    std::size_t total = 0;
    bool only_ttys = true;
    for (nfds_t i = 0; i < count; ++i) {
        const OpenFile* file = open_file(entries[i].fd);
        if (file == nullptr) continue;
        if (total == kMostPolled) {
            note("the program waits for more than %d sockets and devices; the others are not looked at",
                 static_cast<int>(kMostPolled));
            break;
        }
        if (file->kind == OpenFile::Kind::Random) {
            entries[i].revents = static_cast<short>(entries[i].events & (POLLIN | POLLOUT));
            continue;
        }
        only_ttys = only_ttys && file->kind == OpenFile::Kind::Tty;
        list[total] = {file->handle, entries[i].events, 0, entries[i].seen};
        indices[total++] = i;
    }
    wire::Request request;
    request.op = wire::Op::Poll;
    request.deadline = deadline;
    request.a = only_ttys ? 1 : 0;
    const std::size_t size = total * sizeof list[0];
    const auto ready = device_call(request, list.data(), size, list.data(), size, true);
    if (ready < 0) return -1;
    for (std::size_t i = 0; i < total; ++i) {
        entries[indices[i]].revents = list[i].returned;
        entries[indices[i]].seen = list[i].seen;
    }
    return static_cast<int>(ready);
}

/// What the host reports of the entries that are no devices, right now.
int poll_outside(PollItem* entries, nfds_t count) {
    Room<pollfd> list(count);
    Room<nfds_t> indices(count);
    nfds_t total = 0;
    for (nfds_t i = 0; i < count && total < kMostEntries; ++i) {
        if (entries[i].fd < 0 || open_file(entries[i].fd) != nullptr) continue;
        list[total] = {entries[i].fd, entries[i].events, 0};
        indices[total++] = i;
    }
    if (total == 0) return 0;
    const int ready = REAL(poll)(list.data(), total, 0);
    for (nfds_t i = 0; i < total; ++i)
        entries[indices[i]].revents = list[i].revents;
    return ready;
}

void name_outside_wait(const PollItem* entries, nfds_t count) {
    for (nfds_t i = 0; i < count; ++i) {
        const int fd = entries[i].fd;
        const bool waits = fd >= 0 && open_file(fd) == nullptr && !is_internal(fd);
        if (waits && !(page().networked != 0 && is_file(fd)))  // a file is always ready
            note("the program waits on descriptor %d, which is outside of simulated time: runs may differ",
                 fd);
    }
}

/// Nothing but the devices, this one thread and time can make an entry ready: there is nothing to look at
/// meanwhile.
bool nobody_else_moves(const PollItem* entries, nfds_t count) {
    if (page().networked == 0 || page().alive > 1 || epoll_watches_outside()) return false;
    std::size_t threads = 0;
    for (std::size_t i = 0; i < thread_count(); ++i) {
        const Thread* thread = thread_at(i);
        threads += thread != nullptr && thread->state != Thread::State::Finished ? 1 : 0;
    }
    if (threads > 1) return false;
    for (nfds_t i = 0; i < count; ++i)
        if (entries[i].fd >= 0 && open_file(entries[i].fd) == nullptr && !is_internal(entries[i].fd))
            return false;
    return true;
}

int poll_until(PollItem* entries, nfds_t count, Time deadline) {
    mark_call("poll");
    pthread_testcancel();
    charge(page().charges.device);
    bool has_device = false;
    bool has_outside = false;
    for (nfds_t i = 0; i < count; ++i) {
        entries[i].revents = 0;
        if (entries[i].fd < 0) continue;
        (open_file(entries[i].fd) != nullptr ? has_device : has_outside) = true;
    }
    if (has_device && !has_outside) return poll_devices(entries, count, deadline);
    while (true) {
        int ready = poll_outside(entries, count);
        if (ready < 0) return -1;
        if (has_device) {
            const bool waits = ready == 0 && deadline > now();
            const Time look = nobody_else_moves(entries, count) ? kNever : time_after(kExternalPeriod);
            const Time until = waits ? std::min({deadline, look, next_timer()}) : now();
            if (waits) name_outside_wait(entries, count);
            const int devices = poll_devices(entries, count, until);
            if (devices < 0) return -1;
            ready += devices;
            if (ready == 0 && waits) ready = poll_outside(entries, count);
        }
        if (ready != 0 || now() >= deadline) return ready;
        if (has_device) continue;
        if (has_outside) name_outside_wait(entries, count);
        WaitOptions options;
        options.deadline = has_outside ? std::min(deadline, time_after(kExternalPeriod)) : deadline;
        options.interruptible = true;
        options.cancellable = true;
        if (park(external_key(), options) == Wake::Signal) return fail(EINTR);
    }
}

}  // namespace

int poll_items(PollItem* items, std::size_t count, Time deadline) {
    return poll_until(items, count, deadline);
}

namespace {
/// poll_until(), where an epoll among the items is ready when something is that it watches.
int poll_with_epolls(PollItem* items, std::size_t count, Time deadline) {
    std::vector<PollItem> all;
    std::vector<std::size_t> ends(count);
    for (std::size_t i = 0; i < count; ++i) {
        if (items[i].fd >= 0 && (items[i].events & POLLIN) != 0 && open_file(items[i].fd) == nullptr)
            add_watched(items[i].fd, all);
        ends[i] = all.size();
    }
    if (all.empty()) return poll_until(items, count, deadline);
    all.insert(all.begin(), items, items + count);
    if (poll_until(all.data(), all.size(), deadline) < 0) return -1;
    int ready = 0;
    for (std::size_t i = 0; i < count; ++i) {
        items[i].revents = all[i].revents;
        for (std::size_t at = i > 0 ? ends[i - 1] : 0; at < ends[i]; ++at)
            if (all[count + at].revents != 0) items[i].revents |= POLLIN;
        ready += items[i].revents != 0 ? 1 : 0;
    }
    return ready;
}
}  // namespace

namespace {
Time deadline_of(const timespec* timeout) {
    return timeout == nullptr ? kNever : time_after(from_timespec(*timeout));
}

int select_until(int count, fd_set* reads, fd_set* writes, fd_set* errors, Time deadline) {
    Room<PollItem> entries(static_cast<std::size_t>(std::max(count, 0)));
    nfds_t total = 0;
    for (int fd = 0; fd < count && total < kMostEntries; ++fd) {
        int events = 0;
        if (reads != nullptr && FD_ISSET(fd, reads)) events |= POLLIN;
        if (writes != nullptr && FD_ISSET(fd, writes)) events |= POLLOUT;
        if (errors != nullptr && FD_ISSET(fd, errors)) events |= POLLPRI;
        if (events != 0) entries[total++] = {fd, static_cast<short>(events), 0, 0};
    }
    const int result = poll_with_epolls(entries.data(), total, deadline);
    if (result < 0) return result;
    int bits = 0;
    for (nfds_t i = 0; i < total; ++i) {
        if ((entries[i].revents & POLLNVAL) != 0) return fail(EBADF);
    }
    for (nfds_t i = 0; i < total; ++i) {
        const PollItem& entry = entries[i];
        const auto settle = [&](fd_set* set, int wanted, int happened) {
            if (set == nullptr || (entry.events & wanted) == 0) return;
            if ((entry.revents & happened) != 0) {
                ++bits;
            } else {
                FD_CLR(entry.fd, set);
            }
        };
        settle(reads, POLLIN, POLLIN | POLLHUP | POLLERR);
        settle(writes, POLLOUT, POLLOUT | POLLERR);
        settle(errors, POLLPRI, POLLPRI);
    }
    return bits;
}
}  // namespace

}  // namespace puckloop::shim

namespace {
/// poll_until() on entries of the program.
int poll_program(pollfd* theirs, nfds_t count, Time deadline) {
    if (count > FD_SETSIZE) return fail(EINVAL);
    Room<pollfd> entries(count);
    Room<PollItem> items(count);
    if (!copy_from_program(entries.data(), theirs, count * sizeof(pollfd))) return -1;
    for (nfds_t i = 0; i < count; ++i)
        items[i] = {entries[i].fd, entries[i].events, 0, 0};
    const int ready = poll_with_epolls(items.data(), count, deadline);
    for (nfds_t i = 0; i < count; ++i)
        entries[i].revents = items[i].revents;
    return ready >= 0 && !copy_to_program(theirs, entries.data(), count * sizeof(pollfd)) ? -1 : ready;
}

/// A timeout that is given; false and errno if it is none.
bool get_timeout(const timespec* timeout, Time& deadline) {
    timespec given{};
    if (timeout != nullptr && !get_from_program(given, timeout)) return false;
    if (timeout != nullptr && (!is_valid(given) || given.tv_sec < 0)) {
        errno = EINVAL;
        return false;
    }
    deadline = deadline_of(timeout == nullptr ? nullptr : &given);
    return true;
}

/// select_until() on sets of the program, which need not be as long as fd_set.
int select_program(int count, fd_set* reads, fd_set* writes, fd_set* errors, Time deadline) {
    if (count < 0) return fail(EINVAL);
    count = std::min(count, FD_SETSIZE);
    constexpr int kWord = 64;
    const std::size_t bytes = static_cast<std::size_t>((count + kWord - 1) / kWord) * sizeof(std::uint64_t);
    fd_set ours[3];
    fd_set* const theirs[3] = {reads, writes, errors};
    for (int i = 0; i < 3; ++i) {
        FD_ZERO(&ours[i]);
        if (theirs[i] != nullptr && !copy_from_program(&ours[i], theirs[i], bytes)) return -1;
    }
    const auto given = [&](int i) { return theirs[i] != nullptr ? &ours[i] : nullptr; };
    const int ready = select_until(count, given(0), given(1), given(2), deadline);
    for (int i = 0; ready >= 0 && i < 3; ++i)
        if (theirs[i] != nullptr && !copy_to_program(theirs[i], &ours[i], bytes)) return -1;
    return ready;
}
}  // namespace

SHIM_EXPORT int poll(pollfd* entries, nfds_t count, int timeout) {
    if (!active()) return REAL(poll)(entries, count, timeout);
    return poll_program(entries, count, timeout < 0 ? kNever : time_after(timeout * kMillisecond));
}

SHIM_EXPORT int __poll_chk(pollfd* entries, nfds_t count, int timeout, size_t) {
    return poll(entries, count, timeout);
}

SHIM_EXPORT int ppoll(pollfd* entries, nfds_t count, const timespec* timeout, const sigset_t* mask) {
    if (!active()) return REAL(ppoll)(entries, count, timeout, mask);
    Time deadline = kNever;
    return get_timeout(timeout, deadline) ? poll_program(entries, count, deadline) : -1;
}

SHIM_EXPORT int select(int count, fd_set* reads, fd_set* writes, fd_set* errors, timeval* timeout) {
    if (!active()) return REAL(select)(count, reads, writes, errors, timeout);
    Time deadline = kNever;
    timeval given{};
    if (timeout != nullptr) {
        if (!get_from_program(given, timeout)) return -1;
        if (given.tv_sec < 0 || given.tv_usec < 0) return fail(EINVAL);
        deadline = time_after(
            from_timespec({given.tv_sec + given.tv_usec / 1'000'000, given.tv_usec % 1'000'000 * 1000}));
    }
    const int result = select_program(count, reads, writes, errors, deadline);
    if (timeout != nullptr && result >= 0) {  // as Linux does: what is left
        const Time left = board_time(std::max<Time>(0, deadline - now()));
        given = {left / kSecond, left % kSecond / kMicrosecond};
        const int error = errno;
        put_to_program(timeout, given);
        errno = error;
    }
    return result;
}

SHIM_EXPORT int pselect(int count, fd_set* reads, fd_set* writes, fd_set* errors, const timespec* timeout,
                        const sigset_t* mask) {
    if (!active()) return REAL(pselect)(count, reads, writes, errors, timeout, mask);
    Time deadline = kNever;
    return get_timeout(timeout, deadline) ? select_program(count, reads, writes, errors, deadline) : -1;
}
