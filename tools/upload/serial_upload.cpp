#include "tools/upload/serial_upload.h"

#include "base/error.h"
#include "tools/exec/ends/pty_speed.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <cstring>
#include <optional>
#include <span>

namespace puckloop::tools {

namespace {

using Clock = std::chrono::steady_clock;
using Milliseconds = std::chrono::milliseconds;
constexpr Milliseconds kAskEvery{100}, kRowPatience{3000};
constexpr int kTries = 5;
constexpr double kBaud = 115200.0;

class Port {
  public:
    explicit Port(const std::string& name)
        : name_(name), file_(::open(name.c_str(), O_RDWR | O_NOCTTY | O_CLOEXEC)) {
        if (file_ < 0) throw RunError(fmt::format("{}: {}", name, std::strerror(errno)));
        if (!exec::set_raw_terminal(file_, kBaud)) {
            ::close(file_);
            throw RunError(fmt::format("{}: no serial port", name));
        }
    }
    ~Port() { ::close(file_); }
    Port(const Port&) = delete;
    Port& operator=(const Port&) = delete;

    void write(std::span<const std::uint8_t> bytes) {
        while (!bytes.empty()) {
            const ssize_t done = ::write(file_, bytes.data(), bytes.size());
            if (done < 0 && errno == EINTR) continue;
            if (done < 0) throw RunError(fmt::format("{}: {}", name_, std::strerror(errno)));
            bytes = bytes.subspan(static_cast<std::size_t>(done));
        }
    }
    /// The next byte, if one comes by then.
    std::optional<std::uint8_t> read(Clock::time_point until) {
        for (;;) {
            const auto left = std::chrono::duration_cast<Milliseconds>(until - Clock::now()).count();
            pollfd wait{file_, POLLIN, 0};
            const int ready = ::poll(&wait, 1, static_cast<int>(left > 0 ? left : 0));
            if (ready == 0) return std::nullopt;
            std::uint8_t byte = 0;
            const ssize_t got = ready > 0 ? ::read(file_, &byte, 1) : -1;
            if (got == 1) return byte;
            if (got < 0 && errno == EINTR) continue;
            throw RunError(fmt::format("{}: the other end is gone", name_));
        }
    }

  private:
    std::string name_;
    int file_;
};

void say_hello(Port& port, double patience) {
    const auto end =
        Clock::now() + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(patience));
    const std::uint8_t hello = kBootHello;
    bool chip = false;
    while (Clock::now() < end) {
        port.write({&hello, 1});
        const auto until = Clock::now() + kAskEvery;
        while (const auto byte = port.read(until)) {
            if (chip && *byte == kBootOk) return;
            chip = *byte == kBootChip;
        }
    }
    throw RunError(
        fmt::format("no boot loader answered for {} s: it listens for a second after a reset", patience));
}

void send_row(Port& port, const BootPacket& packet) {
    for (int attempt = 0; attempt < kTries; ++attempt) {
        port.write(packet);
        const auto until = Clock::now() + kRowPatience;
        while (const auto byte = port.read(until)) {
            if (*byte == kBootOk) return;
            if (*byte == kBootWrong) break;
        }
    }
    throw RunError(
        fmt::format("the row at 0x{:05x} was not taken", packet[0] | packet[1] << 8 | packet[2] << 16));
}

}  // namespace

void upload(const std::string& name, const std::vector<BootPacket>& packets, double patience,
            const std::function<void(double)>& progress) {
    Port port(name);
    say_hello(port, patience);
    for (std::size_t i = 0; i < packets.size(); ++i) {
        send_row(port, packets[i]);
        progress(static_cast<double>(i + 1) / static_cast<double>(packets.size()));
    }
    port.write(boot_end());
}

}  // namespace puckloop::tools
