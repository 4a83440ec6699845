#pragma once
// What the preloaded library and the Linux node say to each other, over one SOCK_SEQPACKET pair and one page
// of shared memory. The node is the program's kernel: it owns the devices and the clock. The library runs one
// thread of the program at a time and asks the node whenever a device is touched or time must pass.
//
// Deviation: one conversation a process. A forked child is outside of simulated time (the library says so).

#include <atomic>
#include <cstdint>

namespace puckloop::linuxboard::wire {

inline constexpr std::uint32_t kVersion = 1;
inline constexpr const char* kLinkVariable = "PUCKLOOP_SHIM_LINK";  ///< "<socket>,<page>,<pid>"
inline constexpr std::int64_t kNever = INT64_MAX;
/// Most bytes that one request or reply carries after its header.
inline constexpr std::uint32_t kMaximumData = 16'384;

enum class Op : std::uint32_t {
    Hello,        ///< a = kVersion; the reply starts the program
    Sync,         ///< nothing asked: let time reach `now`, or wait
    Open,         ///< a = device index; result: handle
    Close,        ///< handle
    Read,         ///< handle, a = most bytes; data: what was read
    Write,        ///< handle, data; result: bytes taken
    GetTermios,   ///< handle; data: termios as in <termios.h>
    SetTermios,   ///< handle, a = TCSANOW, TCSADRAIN, TCSAFLUSH; data
    Flush,        ///< handle, a = TCIFLUSH, TCOFLUSH, TCIOFLUSH
    Flow,         ///< handle, a = TCOOFF, TCOON, TCIOFF, TCION
    Drain,        ///< handle
    Break,        ///< handle, b = length in microseconds
    InputQueue,   ///< handle; result: bytes that a read would return
    OutputQueue,  ///< handle; result: bytes not yet sent
    Counters,     ///< handle; data: TtyCounters
    Poll,         ///< data: PollEntry[]; deadline; the same back with `returned` filled
    Transfer,     ///< handle (I2C), a = timeout in ms, b = segments, data: I2cSegment headers each followed
                  ///< by the bytes to write; result: segments done; data: all bytes read
    Cancel,       ///< the thread's pending request is withdrawn
    Note,         ///< data: a line for the node's log and report
    Exit,         ///< a = exit status; no reply
};

enum class DeviceKind : std::uint32_t { None, Tty, I2c };

struct Request {
    Op op = Op::Sync;
    std::uint32_t thread = 0;
    std::int64_t now = 0;            ///< the program's clock, picoseconds of simulated time
    std::int64_t wait_until = 0;     ///< with `wait`: some thread has something to do then at the latest
    std::int64_t deadline = kNever;  ///< of this operation, where it has one
    std::int32_t handle = -1;
    std::uint32_t a = 0;
    std::uint32_t b = 0;
    std::uint8_t nonblocking = 0;
    std::uint8_t wait = 0;  ///< no thread can run: reply only once one can
    std::uint16_t length = 0;
};

/// Followed by `count` Completions, each followed by its `length` bytes.
struct Reply {
    std::int64_t now = 0;
    std::int64_t limit = 0;     ///< the program may run on to this time before it must ask again
    std::uint64_t signals = 0;  ///< bit n: signal n for the program
    std::uint32_t count = 0;
    std::uint32_t padding = 0;
};

struct Completion {
    std::uint32_t thread = 0;
    std::int32_t error = 0;  ///< errno value, 0 if none
    std::int64_t result = 0;
    std::int64_t time = 0;
    std::uint32_t length = 0;
    std::uint32_t padding = 0;
};

struct PollEntry {
    std::int32_t handle = -1;
    std::int16_t events = 0;
    std::int16_t returned = 0;
};

struct I2cSegment {
    std::uint16_t address = 0;
    std::uint16_t flags = 0;  ///< as in <linux/i2c.h>
    std::uint16_t length = 0;
};

struct TtyCounters {
    std::uint32_t received = 0, sent = 0, framing = 0, parity = 0, overrun = 0, breaks = 0,
                  buffer_overrun = 0;
};

/// What one call that does not block costs, in picoseconds of simulated time.
struct Charges {
    std::int64_t clock = 1'000'000;    ///< gettimeofday, clock_gettime, time: 1 us
    std::int64_t device = 2'000'000;   ///< read, write, ioctl, poll that returns at once: 2 us
    std::int64_t sync = 100'000;       ///< an uncontended lock, unlock, signal, futex call: 0.1 us
    std::int64_t thread = 20'000'000;  ///< creating a thread: 20 us
    std::int64_t yield = 1'000'000;    ///< sched_yield: 1 us
};

struct DeviceName {
    DeviceKind kind = DeviceKind::None;
    char path[60] = {};
};

/// How much later than asked a sleep ends: timer slack and whatever else runs on the board. Picoseconds.
struct Oversleep {
    std::int64_t mean = 0;
    std::int64_t jitter = 0;  ///< standard deviation; no sleep ends early
};

inline constexpr std::uint32_t kMaximumDevices = 8;
inline constexpr std::uint32_t kNameLength = 64;

/// Shared memory. The upper part is written by the node before the program starts, the lower part by the
/// library, so that the node can tell where a program hangs or died.
struct Page {
    std::uint32_t version = kVersion;
    std::uint32_t real_time = 0;
    std::int64_t epoch = 0;        ///< CLOCK_REALTIME at simulated time 0, nanoseconds since 1970
    std::int64_t uptime = 0;       ///< CLOCK_MONOTONIC at simulated time 0, nanoseconds
    std::int64_t wall_origin = 0;  ///< real-time mode: host CLOCK_MONOTONIC at simulated time 0, ns
    std::uint64_t seed = 0;
    Charges charges;
    Oversleep oversleep;
    DeviceName devices[kMaximumDevices];
    char host_name[kNameLength] = {};

    std::atomic<std::int64_t> now{0};
    std::atomic<std::uint32_t> thread{0};
    std::atomic<const char*> call{nullptr};  ///< only meaningful in the program; its name is in call_name
    char call_name[kNameLength] = {};
};

}  // namespace puckloop::linuxboard::wire
