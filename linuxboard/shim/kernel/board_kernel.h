#pragma once
// The kernel of the emulated Linux board as far as the program's devices need one: open files, and the calls
// of the program's threads that wait on a device, in simulated time.

#include "cosim/core/message.h"
#include "cosim/core/time.h"
#include "linuxboard/shim/devices/i2c_adapter.h"
#include "linuxboard/shim/devices/tty_port.h"
#include "linuxboard/shim/devices/video_device.h"
#include "linuxboard/shim/kernel/linux_faults.h"
#include "linuxboard/shim/kernel/spec.h"
#include "linuxboard/shim/network/network_stack.h"
#include "linuxboard/shim/wire/wire.h"

#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace puckloop::linuxboard {

/// A call that has ended, of the thread thread_of(slot, number).
struct FinishedCall {
    wire::Completion header;
    std::string data;
    bool opens = false;  ///< its result is the handle of a file that it opened
};

/// A thread of a process, for BoardKernel.
constexpr std::uint32_t thread_of(std::uint32_t slot, std::uint32_t thread) {
    return slot << 16 | thread;
}
constexpr std::uint32_t slot_of(std::uint32_t thread) {
    return thread >> 16;
}

class BoardKernel {
  public:
    /// `faults` outlives the kernel.
    BoardKernel(const LinuxSpec& spec, LinuxFaults& faults);

    /// The next camera, in the order of the spec.
    void add_camera(std::unique_ptr<VideoDevice> camera) { cameras_.push_back(std::move(camera)); }
    const std::vector<std::unique_ptr<VideoDevice>>& cameras() const { return cameras_; }

    /// One call of the program at `request.now`, to which the kernel has been advanced. It ends at once, or
    /// later, or never.
    void call(const wire::Request& request, std::string_view data);
    void deliver_uart(const cosim::UartFrame& frame, cosim::Time now);
    void deliver_i2c(const cosim::I2cPhase& phase, cosim::Time now);
    void deliver_packet(const cosim::Packet& packet, cosim::Time now);
    void hang_up(cosim::Time now);
    /// Nobody runs until `until`, so that no call ends before; transfers on the bus go on.
    void hold_calls(cosim::Time until) { resumes_ = until; }
    /// Handles everything due up to and including `now`.
    void advance(cosim::Time now);
    /// When advance() next has something to do.
    cosim::Time next_event() const;
    /// When a call that waits may end at the earliest, if nothing comes in before `message`.
    cosim::Time next_completion(cosim::Time message) const;
    /// When a call that waits may end at the earliest, if what comes in next is `next`, all of one time, and
    /// nothing else does before. As next_completion(), but it looks at what comes in.
    cosim::Time next_wake(std::span<const cosim::Message> next) const;
    /// Serial port and I2C adapter: all that changes while no call begins or ends.
    struct Devices {
        TtyPort tty{};
        I2cAdapter adapter{0, 0};
    };
    void copy_devices(std::optional<Devices>& copy) const {
        if (!copy) copy.emplace();
        copy->tty = tty_;  // into what it has allocated
        copy->adapter = adapter_;
    }
    void put_back(const Devices& devices) {
        tty_ = devices.tty;
        adapter_ = devices.adapter;
    }
    /// The library may answer reads and writes by itself.
    bool lets_library_answer() const { return !faults_.watches_calls(); }
    /// A read and a write that ended at once at `now`, to which the kernel has been advanced.
    void was_read(std::size_t bytes) { tty_.read(bytes); }
    void was_written(std::string_view data, cosim::Time now) { tty_.write(data, now); }
    /// A process is gone, or became another program: the calls of its threads are forgotten.
    void forget(std::uint32_t slot, cosim::Time now);
    /// One more process has the open file `handle`.
    bool is_serial_port(int handle) const;
    void share(int handle);
    /// One process less has it; the last one closes the device.
    void release(int handle, cosim::Time now);
    /// All processes are gone: calls are forgotten, files closed. What was written still goes out.
    void reset(cosim::Time now);

    std::vector<FinishedCall> take_finished();
    bool has_finished() const { return !finished_.empty(); }
    /// Some thread waits on a device, so that a message can wake it.
    bool has_waiting() const { return !waiting_.empty(); }
    /// Since when a thread waits for bytes at the serial port and for nothing else, without a time-out.
    std::optional<cosim::Time> waits_for_bytes_since() const;

    const TtyPort& tty() const { return tty_; }
    const I2cAdapter& adapter() const { return adapter_; }
    /// What the devices put on the wires since the last call, in order of time.
    std::vector<cosim::UartFrame> take_frames();
    std::vector<cosim::I2cPhase> take_phases();
    std::vector<PacketOut> take_packets();
    /// The board's network, or nullptr.
    const NetworkStack* network() const { return network_ ? &*network_ : nullptr; }
    bool tty_was_opened() const { return tty_opened_; }
    bool camera_was_opened() const { return camera_opened_; }
    bool i2c_was_opened() const { return i2c_opened_; }
    bool network_was_used() const { return network_ && network_->was_used(); }

  private:
    struct File {
        wire::DeviceKind kind = wire::DeviceKind::None;
        std::size_t camera = 0;
        int socket = -1;
        bool open = false;
        int references = 1;
    };
    struct Waiting {
        wire::Request request;
        std::string data;
        std::string gathered;
        std::size_t progress = 0;
        cosim::Time since = 0;
    };

    /// True if the call ended.
    bool attempt(std::uint32_t thread, Waiting& waiting, cosim::Time now);
    bool drains_first(const Waiting& waiting, cosim::Time now) const;
    bool attempt_read(std::uint32_t thread, Waiting& waiting, cosim::Time now);
    bool attempt_write(std::uint32_t thread, Waiting& waiting, cosim::Time now);
    bool attempt_poll(std::uint32_t thread, Waiting& waiting, cosim::Time now);
    bool attempt_video(std::uint32_t thread, Waiting& waiting, cosim::Time now);
    std::int16_t events_of(wire::PollEntry& entry, cosim::Time now);
    VideoDevice& camera_of(int handle) { return *cameras_[files_[static_cast<std::size_t>(handle)].camera]; }
    cosim::Time next_frame() const;

    // board_kernel_sockets.cpp
    static bool is_socket_call(wire::Op op);
    void open_socket(const wire::Request& request);
    void take_socket(const wire::Request& request, std::string_view data);
    int new_socket_file(int socket);
    bool attempt_socket(std::uint32_t thread, Waiting& waiting, cosim::Time now);
    /// False if `data` is the beginning of a datagram only.
    bool join_pieces(const wire::Request& request, std::string& data);
    bool attempt_receive(std::uint32_t thread, Waiting& waiting, cosim::Time now, bool late);
    std::int16_t socket_events(wire::PollEntry& entry) const;
    cosim::Time socket_wake_time(const Waiting& waiting) const;
    int socket_of(int handle) const { return files_[static_cast<std::size_t>(handle)].socket; }
    cosim::Time next_network() const { return network_ ? network_->next_event() : cosim::kNever; }

    /// A place for an open file: its handle.
    int place_file(const File& file);
    void finish_open(std::uint32_t thread, int handle, cosim::Time time, std::string data = {});
    void attempt_all(cosim::Time now);
    /// True if the call ended by a fault; may shorten it.
    bool suffers(Waiting& waiting, cosim::Time now);
    void submit_transfer(const wire::Request& request, std::string_view data);
    void open_file(const wire::Request& request);
    void finish(std::uint32_t thread, std::int64_t result, int error, cosim::Time time,
                std::string data = {});
    cosim::Time wake_time(const Waiting& waiting) const;
    std::int16_t tty_events() const;
    std::int16_t tty_news(wire::PollEntry& entry) const;
    static bool asks_for_input_only(const Waiting& waiting);
    /// When the devices by themselves may end the call at the earliest; `transfers_end`: one that waits for a
    /// transfer.
    cosim::Time device_completion(const Waiting& waiting, cosim::Time transfers_end) const;

    LinuxFaults& faults_;
    TtyPort tty_;
    I2cAdapter adapter_;
    std::vector<std::unique_ptr<VideoDevice>> cameras_;
    std::optional<NetworkStack> network_;
    std::vector<File> files_;
    std::map<std::uint32_t, Waiting> waiting_;
    struct Passed {
        int handle = -1;
        wire::PassedFile file;
    };
    std::vector<Passed> passed_;  ///< sockets on their way between processes, each with a reference
    std::map<std::uint32_t, std::string> begun_, rest_;  ///< of datagrams, by thread: sent, received
    std::vector<FinishedCall> finished_;
    std::vector<cosim::UartFrame> frames_;
    std::vector<cosim::I2cPhase> phases_;
    cosim::Time resumes_ = cosim::kNever;  ///< calls that wait are held until then; kNever: they are not
    bool has_tty_ = true;
    std::size_t i2c_files_ = 0;
    bool tty_opened_ = false;
    bool i2c_opened_ = false;
    bool camera_opened_ = false;
};

}  // namespace puckloop::linuxboard
