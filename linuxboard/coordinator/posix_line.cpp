#include "linuxboard/coordinator/posix_line.h"

#include <cerrno>
#include <cmath>
#include <cstring>
#include <fcntl.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <termios.h>
#include <unistd.h>

namespace puckloop::coordinator {

namespace {

using control::LineError;

constexpr double kStuck = 5.0;      // s without the port taking a byte
constexpr double kLastBytes = 1.0;  // s for what was written to leave
constexpr double kNanoseconds = 1e9;

std::string with_reason(const std::string& what) {
    return what + ": " + std::strerror(errno);
}

timespec duration_of(double seconds) {
    const double whole = std::floor(seconds);
    return {static_cast<time_t>(whole), static_cast<long>((seconds - whole) * kNanoseconds)};
}

}  // namespace

PosixLine::PosixLine(const std::string& port) : port_(port) {
    descriptor_ = ::open(port.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
    if (descriptor_ < 0) throw std::runtime_error(with_reason(port));
    const auto give_up = [this](const std::string& what) {
        const std::string reason = with_reason(what);
        ::close(descriptor_);
        throw std::runtime_error(reason);
    };
    termios attributes{};
    if (::tcgetattr(descriptor_, &attributes) < 0) give_up(port + ": expected a serial port");
    attributes.c_iflag = 0;
    attributes.c_oflag = 0;
    attributes.c_lflag = 0;
    attributes.c_cflag = CLOCAL | CREAD | CS8;
    attributes.c_cc[VMIN] = 1;
    attributes.c_cc[VTIME] = 0;
    ::cfsetispeed(&attributes, B9600);
    ::cfsetospeed(&attributes, B9600);
    if (::tcsetattr(descriptor_, TCSANOW, &attributes) < 0) give_up(port + ": cannot set 9600 8N1");
    ::tcflush(descriptor_, TCIFLUSH);
}

PosixLine::~PosixLine() {
    const double give_up = now() + kLastBytes;
    try {
        for (int left = 1; now() < give_up && (left > 0 || !waiting_.empty());) {
            send_waiting();
            if (::ioctl(descriptor_, TIOCOUTQ, &left) < 0) break;
            if (left > 0 || !waiting_.empty()) clock_.sleep_until(now() + 0.01);
        }
    } catch (const LineError&) {  // then nothing leaves any more
    }
    ::close(descriptor_);
}

std::size_t PosixLine::read(std::span<std::uint8_t> into, double until) {
    send_waiting();
    const timespec left = duration_of(std::fmax(0.0, until - now()));
    pollfd request{descriptor_, static_cast<short>(waiting_.empty() ? POLLIN : POLLIN | POLLOUT), 0};
    const int ready = ::ppoll(&request, 1, &left, nullptr);
    if (ready == 0 || (ready < 0 && errno == EINTR)) return 0;
    if (ready < 0) throw LineError(with_reason(port_));
    if (request.revents & POLLOUT) send_waiting();
    const ssize_t count = ::read(descriptor_, into.data(), into.size());
    if (count > 0) return static_cast<std::size_t>(count);
    if (count < 0 && (errno == EINTR || errno == EAGAIN)) return 0;
    throw LineError(count == 0 ? port_ + ": the port is gone" : with_reason(port_));
}

void PosixLine::write(std::span<const std::uint8_t> bytes) {
    if (waiting_.empty()) stuck_since_ = now();
    waiting_.insert(waiting_.end(), bytes.begin(), bytes.end());
    send_waiting();
}

void PosixLine::send_waiting() {
    if (waiting_.empty()) return;
    const ssize_t count = ::write(descriptor_, waiting_.data(), waiting_.size());
    if (count < 0 && errno != EINTR && errno != EAGAIN) throw LineError(with_reason(port_));
    if (count > 0) {
        waiting_.erase(waiting_.begin(), waiting_.begin() + count);
        stuck_since_ = now();
    } else if (now() - stuck_since_ > kStuck) {
        throw LineError(port_ + ": the port has taken no byte for 5 s");
    }
}

}  // namespace puckloop::coordinator
