#include "linuxboard/control/devices/posix_serial.h"

#include <cerrno>
#include <cmath>
#include <cstring>
#include <fcntl.h>
#include <poll.h>
#include <termios.h>
#include <unistd.h>

namespace puckloop::control {

namespace {

constexpr double kMilliseconds = 1e3;

std::string with_reason(const std::string& what) {
    return what + ": " + std::strerror(errno);
}

}  // namespace

PosixSerial::PosixSerial(const std::string& device) : device_(device) {
    descriptor_ = ::open(device.c_str(), O_RDWR | O_NOCTTY | O_CLOEXEC);
    if (descriptor_ < 0) throw std::runtime_error(with_reason(device));
    termios attributes{};
    if (::tcgetattr(descriptor_, &attributes) < 0) {
        const std::string reason = with_reason(device + ": expected a serial port");
        ::close(descriptor_);
        throw std::runtime_error(reason);
    }
    attributes.c_iflag = 0;
    attributes.c_oflag = 0;
    attributes.c_lflag = 0;
    attributes.c_cflag = CLOCAL | CREAD | CS8;
    attributes.c_cc[VMIN] = 1;
    attributes.c_cc[VTIME] = 0;
    ::cfsetispeed(&attributes, B115200);
    ::cfsetospeed(&attributes, B115200);
    if (::tcsetattr(descriptor_, TCSAFLUSH, &attributes) < 0) {
        const std::string reason = with_reason(device + ": cannot set 115200 8N1");
        ::close(descriptor_);
        throw std::runtime_error(reason);
    }
}

PosixSerial::~PosixSerial() {
    ::tcdrain(descriptor_);  // the end record must leave before the port closes
    ::close(descriptor_);
}

std::size_t PosixSerial::read(std::span<std::uint8_t> into, double until) {
    const double left = std::fmax(0.0, until - now());
    pollfd request{descriptor_, POLLIN, 0};
    const int ready = ::poll(&request, 1, static_cast<int>(std::ceil(left * kMilliseconds)));
    if (ready == 0 || (ready < 0 && errno == EINTR)) return 0;
    if (ready < 0) throw LineError(with_reason(device_));
    const ssize_t count = ::read(descriptor_, into.data(), into.size());
    if (count > 0) return static_cast<std::size_t>(count);
    if (count < 0 && (errno == EINTR || errno == EAGAIN)) return 0;
    throw LineError(count == 0 ? device_ + ": the line was hung up" : with_reason(device_));
}

void PosixSerial::write(std::span<const std::uint8_t> bytes) {
    while (!bytes.empty()) {
        const ssize_t count = ::write(descriptor_, bytes.data(), bytes.size());
        if (count < 0 && errno != EINTR && errno != EAGAIN) throw LineError(with_reason(device_));
        if (count > 0) bytes = bytes.subspan(static_cast<std::size_t>(count));
    }
}

}  // namespace puckloop::control
