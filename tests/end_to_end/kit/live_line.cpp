#include "tests/end_to_end/kit/live_line.h"

#include <catch2/catch.hpp>

#include <arpa/inet.h>
#include <fcntl.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <thread>

namespace puckloop::tests {

namespace {

int connect_to(const std::string& port) {
    const int file = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
    sockaddr_in here{};
    here.sin_family = AF_INET;
    here.sin_port = htons(static_cast<std::uint16_t>(std::stoi(port)));
    here.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    REQUIRE(::connect(file, reinterpret_cast<const sockaddr*>(&here), sizeof here) == 0);
    return file;
}

}  // namespace

bool has_ptys() {
    if (::access("/dev/pts", R_OK) == 0 && !std::filesystem::is_empty("/dev/pts")) return true;
    WARN("no devpts at /dev/pts (a bare chroot?): skipped");
    return false;
}

std::string place_of(const std::filesystem::path& err, const std::string& end) {
    constexpr double kPatience = 120.0;
    for (const double until = wall_seconds() + kPatience; wall_seconds() < until;) {
        const std::string text = text_of(err);
        const std::size_t line = text.find(end + ": ");
        const std::size_t stop = line == std::string::npos ? line : text.find('\n', line);
        if (stop != std::string::npos) {
            const std::string said = text.substr(line, stop - line);
            const std::size_t name = said.find("/dev/");
            return said.substr(name == std::string::npos ? said.rfind(':') + 1 : name);
        }
        std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    FAIL("nothing is said of " << end << ": " << text_of(err));
    return {};
}

LiveLine::LiveLine(Kind kind, const std::string& place)
    : file_(kind == Kind::Tcp ? connect_to(place) : ::open(place.c_str(), O_RDWR | O_NOCTTY | O_CLOEXEC)) {
    REQUIRE(file_ >= 0);
    REQUIRE(::fcntl(file_, F_SETFL, ::fcntl(file_, F_GETFL) | O_NONBLOCK) == 0);
}

LiveLine::~LiveLine() {
    ::close(file_);
}

void LiveLine::send(const std::string& bytes) const {
    REQUIRE(::write(file_, bytes.data(), bytes.size()) == static_cast<ssize_t>(bytes.size()));
}

std::string LiveLine::read_until(const std::string& end, double patience) const {
    std::string got;
    for (const double until = wall_seconds() + patience; wall_seconds() < until && !got.ends_with(end);) {
        pollfd waiting{file_, POLLIN, 0};
        char byte;
        if (::poll(&waiting, 1, 5) != 1) continue;
        const ssize_t count = ::read(file_, &byte, 1);
        if (count == 1) got += byte;
        if (count == 0 || (count < 0 && errno != EAGAIN)) break;
    }
    return got;
}

bool LiveLine::hung_up(double patience) const {
    pollfd waiting{file_, POLLIN, 0};
    char byte;
    if (::poll(&waiting, 1, static_cast<int>(1000 * patience)) != 1) return false;
    const ssize_t got = ::read(file_, &byte, 1);
    return got == 0 || (got < 0 && errno == ECONNRESET);
}

std::size_t LiveLine::flood(const std::string& bytes, std::size_t most) const {
    constexpr int kQuietMs = 500;
    std::size_t taken = 0;
    while (taken < most) {
        pollfd room{file_, POLLOUT, 0};
        if (::poll(&room, 1, kQuietMs) != 1) break;
        const ssize_t done = ::write(file_, bytes.data(), bytes.size());
        if (done < 0 && errno != EAGAIN) break;
        if (done > 0) taken += static_cast<std::size_t>(done);
    }
    return taken;
}

void LiveLine::reset() {
    const linger at_once{1, 0};
    REQUIRE(::setsockopt(file_, SOL_SOCKET, SO_LINGER, &at_once, sizeof at_once) == 0);
    ::close(file_);
    file_ = -1;
}

}  // namespace puckloop::tests
