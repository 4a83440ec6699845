#pragma once
// What the functions taken over share among themselves.

#include "linuxboard/shim/preload/threads/scheduler.h"

#include <stdio.h>
#include <sys/select.h>
#include <time.h>

namespace puckloop::shim {

// time_calls.cpp
bool is_wall_clock(clockid_t clock);
/// Reading of `clock` now, in nanoseconds (a Time since 1970 would not fit).
std::int64_t clock_nanoseconds(clockid_t clock);
timespec timespec_of_nanoseconds(std::int64_t nanoseconds);
Time from_timespec(const timespec& time);
timespec to_timespec(Time time);
/// What the board's clocks count in `simulated` time, and the simulated time in which they count so much, at
/// least: they are fast or slow by Page::clock_error.
Time board_time(Time simulated);
Time simulated_time(Time of_board);
/// Simulated time at which the board has counted `duration` from now on; kNever stays.
Time time_after(Time duration);
/// Simulated time at which `clock` reads `time`.
Time absolute_deadline(clockid_t clock, const timespec& time);
bool is_valid(const timespec& time);
bool sleep_until(Time deadline);

// processor_time.cpp
/// Reading of a clock of processor time, in picoseconds; false if `clock` is none that there is.
bool processor_time(clockid_t clock, Time& reading);
bool is_processor_clock(clockid_t clock);

// identity_calls.cpp
/// The number of a thread of this process, as gettid() gives it.
pid_t thread_number(std::uint32_t index);

// file_calls.cpp: descriptors that stand for devices
struct OpenFile;
OpenFile* open_file(int fd);

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
/// The descriptor is closed, or another file: nobody watches it any more.
void drop_watches(int fd);
/// A host's epoll watches something that neither this program nor time moves.
bool epoll_watches_outside();

// channel.cpp
/// A pipe or a socket: what waits for it waits for another process.
bool is_channel(int fd);

// external.cpp
bool is_named_pipe(const char* path);
/// Lets a millisecond pass, or until `deadline`, before something outside is looked at again. False after a
/// signal that ends the call.
bool look_again(Time deadline);

// shared_calls.cpp
/// F_SETLKW and F_OFD_SETLKW.
int wait_for_lock(int fd, int command, void* lock);
/// park() on an object that may be `shared` with other processes: theirs do not wake, so it is looked at
/// every millisecond as long as there are some.
Wake park_shared(const void* key, WaitOptions options, bool shared);

// machine_files.cpp
/// A file of /proc whose contents would be the host's, and other in each run: a descriptor of what it holds
/// on the board at this moment. -1 with errno unchanged: the path is none.
int open_machine_file(const char* path);

// process_calls.cpp
void begin_process(Thread* main_thread);

}  // namespace puckloop::shim
