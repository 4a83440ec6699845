#include "bench/upload/serial_upload.h"

#include "base/error.h"
#include "bench/upload/boot_place.h"
#include "ends/pty_speed.h"

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
constexpr Milliseconds kAskEvery{100}, kAskAgainEvery{500}, kRowPatience{3000};
/// Longer than answers take, and far less than the second for which the boot loader waits for an octet.
constexpr Milliseconds kProbePatience{300};
constexpr int kTries = 5, kPasses = 8;

class Port {
  public:
    Port(const std::string& name, double baud)
        : name_(name), file_(::open(name.c_str(), O_RDWR | O_NOCTTY | O_CLOEXEC)) {
        if (file_ < 0)
            throw InputError(name, "", fmt::format("cannot be opened: {}", std::strerror(errno)),
                             "a serial port, such as a run's pty");
        if (!exec::set_raw_terminal(file_, baud)) {
            ::close(file_);
            throw InputError(name, "", "no serial port", "such as a run's pty");
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

/// A conversation with the boot loader. Over the air, and through a pty of a busy machine, bytes and answers
/// may take longer than the time between two hellos.
class Session {
  public:
    Session(Port& port, double patience)
        : port_(port),
          patience_(std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(patience))) {}

    /// Asks until the boot loader answers, and is where a row begins.
    void start();
    void send(const BootPacket& row);
    void end() { write(boot_end()); }

  private:
    enum class Answer { None, Ok, Wrong, Started };

    void write(std::span<const std::uint8_t> octets) {
        port_.write(octets);
        place_.sent(octets);
    }
    Answer answer(Clock::duration patience);
    Answer hello(Milliseconds every, Clock::time_point until, bool started_only);
    void drain();
    bool align(std::size_t most);
    std::optional<bool> align_once(std::size_t most);
    [[noreturn]] void not_taken(const BootPacket& row) const;

    Port& port_;
    Clock::duration patience_;
    BootPlace place_;
    std::size_t hellos_ = 0;  ///< of the last hello()
};

/// What comes within `patience`; anything but answers is ignored.
Session::Answer Session::answer(Clock::duration patience) {
    bool chip = false;
    for (const auto until = Clock::now() + patience; const auto octet = port_.read(until);) {
        if (*octet == kBootWrong) return Answer::Wrong;
        if (*octet == kBootOk) return chip ? Answer::Started : Answer::Ok;
        chip = *octet == kBootChip;
    }
    return Answer::None;
}

Session::Answer Session::hello(Milliseconds every, Clock::time_point until, bool started_only) {
    const std::uint8_t hello = kBootHello;
    for (hellos_ = 0; Clock::now() < until;) {
        write({&hello, 1});
        ++hellos_;
        const Answer got = answer(every);
        if (got == Answer::Started || (got != Answer::None && !started_only)) return got;
    }
    return Answer::None;
}

void Session::drain() {
    for (const auto until = Clock::now() + kProbePatience; port_.read(until);) {
    }
}

/// The boot loader may have taken up to `most` of the octets sent last for the begin of a packet: finds out,
/// and completes that packet. Whether it had none; nothing: it does not answer.
std::optional<bool> Session::align_once(std::size_t most) {
    bool none = true, first = true;
    for (place_.lost(most); !place_.aligned(); first = false) {
        const bool certain = place_.known();
        port_.write(place_.probe());
        Answer got = answer(certain ? kRowPatience : kProbePatience);
        while (got == Answer::Ok)  // of a row, late
            got = answer(kProbePatience);
        if (got == Answer::Started) return false;  // it was reset: another pass
        if (certain && got == Answer::None) return std::nullopt;
        if (first) none = got == Answer::None;
        place_.answered(got == Answer::Wrong);
    }
    return none;
}

/// An answer that is late beyond kProbePatience misleads: it is sure only once the same comes out twice.
/// False: it does not.
bool Session::align(std::size_t most) {
    int sure = 0;
    for (int pass = 0; pass < kPasses && sure < 2; ++pass, most = BootPlace::kPacket - 1) {
        const std::optional<bool> aligned = align_once(most);
        if (!aligned) return false;
        sure = *aligned ? sure + 1 : 0;
    }
    return sure == 2;
}

void Session::start() {
    for (const auto until = Clock::now() + patience_; hello(kAskEvery, until, true) != Answer::None;) {
        if (hellos_ == 1) {
            place_.lost(0);
            return;
        }
        drain();  // hellos that were under way arrive
        if (align(hellos_ - 1)) return;
    }
    throw RunError(fmt::format("no boot loader answered for {} s: it listens for a second after a reset",
                               std::chrono::duration<double>(patience_).count()));
}

void Session::not_taken(const BootPacket& row) const {
    throw RunError(fmt::format("the row at 0x{:05x} was not taken", row[0] | row[1] << 8 | row[2] << 16));
}

/// A row is sent again only where it begins a packet for certain.
void Session::send(const BootPacket& row) {
    for (int attempt = 0; attempt < kTries; ++attempt) {
        write(row);
        Answer got = answer(kRowPatience);
        hellos_ = 0;
        // It may have been reset, or be late.
        if (got == Answer::None) got = hello(kAskAgainEvery, Clock::now() + patience_, false);
        if (got == Answer::None) break;
        if (got == Answer::Ok && hellos_ == 0) return;
        drain();
        if (!align(got == Answer::Ok ? hellos_ : BootPlace::kPacket - 1)) start();
        if (got == Answer::Ok) return;
    }
    not_taken(row);
}

}  // namespace

void upload(const std::string& name, const std::vector<BootPacket>& packets, double baud, double patience,
            const std::function<void(double)>& progress) {
    Port port(name, baud);
    Session session(port, patience);
    session.start();
    for (std::size_t i = 0; i < packets.size(); ++i) {
        session.send(packets[i]);
        progress(static_cast<double>(i + 1) / static_cast<double>(packets.size()));
    }
    session.end();
}

}  // namespace puckloop::tools
