#pragma once
// What the preloaded library and the Linux node exchange, through one shared memory (Page) in which each
// process of the program has a Channel. The node is the program's kernel: it owns the devices, the clock and
// the processes. Of all processes the one that is earliest in simulated time runs, and of its threads one; it
// asks the node whenever time must pass, another process may be concerned, or a device is touched and what
// the node's last reply contained (TtyView) is not enough to answer.
//
// A socket pair for each process carries what memory cannot: the descriptor of a new process's own socket.
// Its other end is closed when the node is gone.

#include "linuxboard/shim/wire/turn.h"

#include <atomic>
#include <cstdint>

namespace puckloop::linuxboard::wire {

inline constexpr std::uint32_t kVersion = 10;
inline constexpr const char* kLinkVariable = "PUCKLOOP_SHIM_LINK";  ///< "<socket>,<page>,<slot>"
inline constexpr std::int64_t kNever = INT64_MAX;
/// Most bytes that one request or reply carries after its header.
inline constexpr std::uint32_t kMaximumData = 16'384;

enum class Op : std::uint32_t {
    Hello,        ///< a = kVersion, b = 1: forked, same image; data of the answer: what Exec or Fork kept
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
    Poll,         ///< data: PollEntry[], a = 1: all of serial ports; deadline; the same back with `returned`
    Transfer,     ///< handle (I2C), a = timeout in ms, b = segments, data: I2cSegment headers each followed
                  ///< by the bytes to write; result: segments done; data: all bytes read
    Cancel,       ///< the thread's pending request is withdrawn
    Note,         ///< data: a line for the node's log and report
    Exit,         ///< a = exit status; no reply
    Fork,         ///< a process more, data: for its Hello; result: its slot, and its socket as SCM_RIGHTS
    Forked,       ///< a = slot, b = 1: the host made it, 0: it did not
    Exec,         ///< this process is about to become another program; data: for its Hello
    Changed,      ///< something was written or closed that other processes may wait for
    Kill,         ///< a = slot, b = signal for that process
    Reap,         ///< a = slot: its parent has taken its status
    Ioctl,        ///< handle (camera), a = request, data: its struct, and what that points to; the same back
    Map,  ///< handle (camera), a, b = offset and length to be mapped; result: where in the shared memory
    VideoRead,  ///< handle (camera), a = most bytes; data: where they are in the shared memory (uint64)
    Insert,     ///< handle, a = a byte that is as if it had come in (TIOCSTI)
    Resolve,    ///< data: a computer's name, for a board whose names a fault may keep from it; fails with
                ///< EAGAIN
    // Sockets; addresses are SocketAddress
    Socket,       ///< a = 0: datagrams, 1: a stream, 2: ICMP echoes, 3: NETLINK_ROUTE, whose
                  ///< addresses are numbers of sockets; result: handle
    Bind,         ///< handle, data: address
    Connect,      ///< handle, data: address
    Listen,       ///< handle, a = backlog
    Accept,       ///< handle; result: handle; data: address
    Send,         ///< handle, a = 1: `data` begins with the address to send to; result: bytes taken;
                  ///< b = of kSend...
    Receive,      ///< handle, a = most bytes, b = of kReceive...; data: SocketReceived, bytes
    Shutdown,     ///< handle, a = as in shutdown(2)
    SetOption,    ///< handle, a = level, b = name, data: value
    GetOption,    ///< handle, a = level, b = name; data: value
    SocketName,   ///< handle, a = 1: the other end's; data: address
    SocketQueue,  ///< handle, a = 1: bytes that are not acknowledged, 0: bytes to read
    Give,         ///< handle is on its way to another process (SCM_RIGHTS); data: PassedFile
    Take,         ///< data: PassedFile, of which the inode counts; result: handle, data: all of it
};

enum class DeviceKind : std::uint32_t { None, Tty, I2c, Video, Socket };

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
    std::uint8_t wait = 0;     ///< no thread can run: reply only once one can
    std::uint8_t watches = 0;  ///< with `wait`: Changed and the end of a process may let one run
};

/// With it `count` Completions, each followed by its `length` bytes.
struct Reply {
    std::int64_t now = 0;
    /// Before this time nothing happens to the program: it may run on, and sleep, before it must ask again.
    std::int64_t limit = 0;
    std::uint64_t signals = 0;  ///< bit n: signal n for the program
    std::uint32_t count = 0;
    std::uint8_t changed = 0;  ///< 1: what another process did may let a thread run that watches
    std::uint8_t more = 0;     ///< 1: give the turn back for the Completions for which there was no room
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
    /// Of a socket or serial port; 0: level-triggered. Else it is ready only if its activity is another one;
    /// the same back with the present activity.
    std::uint32_t seen = 0;
};
inline constexpr std::uint32_t kNeverSeen = 0xffffffff;

/// In place of a level and an option: what /proc/net has.
inline constexpr std::uint32_t kNetworkTables = 0x70757070;
enum class NetworkTable : std::uint32_t { Interfaces, Routes, Neighbours, Streams, Datagrams };

/// A socket on its way between processes: found by the host's descriptor that goes with it.
struct PassedFile {
    std::uint64_t inode = 0;
    std::int32_t flags = 0;
    std::uint32_t kind = 0;  ///< 0: datagrams, 1: a stream, 2: netlink
};

inline constexpr std::uint32_t kNetlinkSocket = 3;  ///< of Op::Socket

/// IPv4, both as numbers of the host.
struct SocketAddress {
    std::uint32_t address = 0;
    std::uint16_t port = 0;
    std::uint16_t padding = 0;
};

/// kSendPart: the beginning of a datagram, of which the rest follows; kSendMore: MSG_MORE on a stream.
inline constexpr std::uint32_t kSendPart = 1, kSendMore = 2;
/// kReceiveRest: what a reply had no room for of the datagram before, whose size was its result.
inline constexpr std::uint32_t kReceivePeek = 1, kReceiveAll = 2, kReceiveRest = 4;
/// What recvmsg() is to give beside the data, as options of the socket want it.
inline constexpr std::uint32_t kWithPacketInfo = 1, kWithTimeToLive = 2, kWithService = 4, kWithTime = 8,
                               kWithFineTime = 16;
struct SocketReceived {
    SocketAddress from{};
    std::uint32_t size = 0;  ///< of the whole datagram
    std::uint32_t to = 0;    ///< its receiver's address
    std::uint32_t with = 0;  ///< kWith...
    std::uint8_t time_to_live = 0, service = 0;
    std::uint16_t padding = 0;
    std::int64_t time = 0;  ///< of its arrival, picoseconds of simulated time
};

/// A computer of the network, as in /etc/hosts.
struct HostEntry {
    std::uint32_t address = 0;
    char name[60] = {};
};
inline constexpr std::uint32_t kMaximumHosts = 512;

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
    std::uint32_t device = 0;  ///< index of the device that it names: its own, or of one with another name
    char path[56] = {};
};

/// How much later than asked a sleep ends: timer slack and whatever else runs on the board. Picoseconds.
struct Oversleep {
    std::int64_t mean = 0;    ///< below 0: sleeps end earlier than asked
    std::int64_t jitter = 0;  ///< standard deviation; no sleep ends earlier than asked by it
};

/// The serial port as it is after a reply. With it the library answers by itself, until `valid_until` and
/// the reply's limit, what the node would answer at the same simulated time.
struct TtyView {
    static constexpr std::uint32_t kShown = 256;
    std::int64_t valid_until = 0;  ///< no character comes in before
    std::uint32_t readable = 0;    ///< bytes that a read may return, or that FIONREAD counts
    std::uint32_t room = 0;        ///< bytes that a write takes at once, or more
    std::uint32_t first = 0;       ///< of `input`, not yet read
    std::uint32_t shown = 0;       ///< bytes in `input`: not in canonical mode, and the first ones of many
    std::uint8_t usable = 0;       ///< 0: not open
    std::uint8_t hung_up = 0;
    std::uint8_t canonical = 0;
    std::uint8_t has_line = 0;
    std::uint8_t raw_output = 0;  ///< what is written goes out as it is
    std::uint8_t minimum = 0;     ///< VMIN
    std::uint8_t pause = 0;       ///< VTIME
    char input[kShown] = {};
};

/// What the library did by itself: the node catches up with it, at its time, before the next request.
struct Done {
    std::int64_t time = 0;
    std::uint32_t read = 0;     ///< bytes taken from the serial port's input, or
    std::uint32_t written = 0;  ///< bytes, next in Channel::written
};

/// One process's exchange with the node. Only the side whose turn it is touches it.
struct alignas(4096) Channel {
    static constexpr std::uint32_t kMostDone = 16;
    static constexpr std::uint32_t kMostWritten = 512;
    /// At least one completion with the most data.
    static constexpr std::uint32_t kReplyRoom = 2 * kMaximumData;

    Turn turn;
    std::uint32_t request_size = 0;  ///< bytes in `request_data`
    Request request;
    Reply reply;
    std::uint64_t answered = 0;  ///< requests that the library answered by itself since the node last looked
    TtyView tty;
    std::uint32_t done_count = 0;
    std::uint32_t written_size = 0;
    Done done[kMostDone];
    char written[kMostWritten];
    char request_data[kMaximumData];
    char reply_data[kReplyRoom];
};

inline constexpr std::uint32_t kMaximumDevices = 8;
inline constexpr std::uint32_t kNameLength = 64;
/// Processes of a program that live at the same time, ended ones that nobody waited for included.
inline constexpr std::uint32_t kMaximumProcesses = 64;
/// Process number of the program's first process; the next ones follow.
inline constexpr std::int32_t kFirstProcess = 1000;
/// A process without a parent in the program.
inline constexpr std::int32_t kNoParent = -1;
/// Exit status of a program that cannot be conducted, as a shell's for one that cannot be executed.
inline constexpr int kRefusedStatus = 126;

/// Of the newest signal of its number that the node sent to a process.
struct SignalOrigin {
    std::int32_t process = 0;  ///< who sent it, or the child that ended; 0: nobody of the program
    std::int32_t ended = 0;    ///< 1: a child's end, with
    std::int32_t status = 0;   ///< its status, as waitpid() gives it
};
inline constexpr std::uint32_t kSignals = 65;  ///< their numbers are below

/// One process of the program, by its slot. Everything is written by whoever runs: the process itself or the
/// node.
struct ProcessEntry {
    enum State : std::uint32_t { Free, Alive, Ended };
    std::uint32_t state = Free;
    std::int32_t number = 0;          ///< process number, as the program sees it
    std::int32_t parent = kNoParent;  ///< slot
    std::int32_t group = 0;           ///< process group
    std::int32_t host = 0;            ///< the host's process number
    std::int32_t status = 0;          ///< of one that ended, as waitpid() gives it
    std::atomic<std::int64_t> now{0};
    std::atomic<std::uint32_t> thread{0};
    char call_name[kNameLength] = {};  ///< the last call taken over
    /// Processor time used, picoseconds: what the process's calls were charged, and those of its children
    /// that it has waited for.
    std::int64_t computed = 0;
    std::int64_t children_computed = 0;
    // Faults that went to a handler of the program, at the same simulated time.
    std::uint32_t fault_signal = 0;
    std::int64_t fault_time = 0;
    std::uint64_t fault_place = 0;    ///< of the instruction
    std::uint64_t fault_address = 0;  ///< that it asked for
    std::atomic<std::uint64_t> faults{0};
    SignalOrigin origins[kSignals] = {};
};

/// What the node sets before the program starts, and the processes, so that the node can find where one hangs
/// or died.
struct Page {
    std::uint32_t version = kVersion;
    std::uint32_t real_time = 0;
    std::uint32_t ask_always = 0;  ///< 1: the library answers nothing by itself
    std::int64_t epoch = 0;        ///< CLOCK_REALTIME at simulated time 0, nanoseconds since 1970
    std::int64_t uptime = 0;       ///< CLOCK_MONOTONIC at simulated time 0, nanoseconds
    std::int64_t clock_error = 0;  ///< of all its clocks (board_clock.h)
    std::int64_t wall_origin = 0;  ///< real-time mode: host CLOCK_MONOTONIC at simulated time 0, ns
    std::uint64_t seed = 0;
    Charges charges;
    Oversleep oversleep;
    DeviceName devices[kMaximumDevices];
    char host_name[kNameLength] = {};
    std::uint32_t alive = 0;  ///< processes
    // The network that the board is on.
    std::uint8_t networked = 0;  ///< 0: sockets are the host's
    std::uint8_t network_prefix = 0;
    std::uint8_t asks_for_names = 0;  ///< 1: names of other computers are asked for (Op::Resolve)
    std::uint32_t network_address = 0;
    std::uint32_t host_count = 0;
    HostEntry hosts[kMaximumHosts];
    ProcessEntry processes[kMaximumProcesses];
};

/// The shared memory: the page, and behind it the channels by slot, made when a process gets the slot.
inline constexpr std::uint64_t kFirstChannel =
    (sizeof(Page) + alignof(Channel) - 1) / alignof(Channel) * alignof(Channel);
inline constexpr std::uint64_t kSharedSize = kFirstChannel + kMaximumProcesses * sizeof(Channel);

/// Frames of the cameras lie behind the channels: each camera has room for its buffers. Pages that nobody
/// writes take no memory.
inline constexpr std::uint32_t kMostVideoBuffers = 16;
inline constexpr std::uint32_t kVideoBufferSize = 640 * 480 * 2;  ///< whole pages of 4096 bytes
inline constexpr std::uint64_t kVideoSize = std::uint64_t{kMostVideoBuffers} * kVideoBufferSize;
/// Where the frames of camera number `camera` begin.
inline constexpr std::uint64_t video_offset(std::uint32_t camera) {
    return (kSharedSize + 4095) / 4096 * 4096 + camera * kVideoSize;
}
static_assert(kVideoBufferSize % 4096 == 0);

inline Channel* channel_of(Page& page, std::uint32_t slot) {
    return reinterpret_cast<Channel*>(reinterpret_cast<char*>(&page) + kFirstChannel) + slot;
}

}  // namespace puckloop::linuxboard::wire
