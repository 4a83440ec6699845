// `--uartN pty`: a pseudo terminal that any terminal program can open, with the rate that the program sets.

#include "base/error.h"
#include "ends/live_end.h"
#include "ends/pty_speed.h"

#include <boost/asio/posix/stream_descriptor.hpp>
#include <fmt/format.h>

#include <fcntl.h>
#include <poll.h>
#include <stdlib.h>
#include <sys/ioctl.h>
#include <sys/stat.h>
#include <termios.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstring>

namespace puckloop::exec {

namespace {

/// How often a terminal that everybody has closed is looked at.
constexpr auto kReopenedEvery = std::chrono::milliseconds(5);

/// Before the first program opens it the kernel keeps the first 4 kB for it; once the last one has closed it,
/// or has set B0, what comes is lost, as at a serial port.
class Pty final : public HostStream {
  public:
    Pty(boost::asio::io_context& io, double baud) : master_(io), timer_(io) {
        const int master = posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
        if (master < 0) fail();
        master_.assign(master);
        char name[128];
        if (grantpt(master) != 0 || unlockpt(master) != 0 || ptsname_r(master, name, sizeof name) != 0 ||
            ::chmod(name, S_IRUSR | S_IWUSR) != 0 || !set_raw_terminal(master, baud))
            fail();
        name_ = name;
    }

    std::string announcement() const override { return "pty " + name_; }
    bool there() const override { return !closed_; }
    std::optional<double> baud() const override { return terminal_baud(descriptor()); }

    void await_readable(std::function<void()> then) override {
        if (closed()) {
            timer_.expires_after(kReopenedEvery);
            timer_.async_wait([this, then](const boost::system::error_code& error) {
                if (!error) await_readable(then);
            });
            return;
        }
        master_.async_wait(boost::asio::posix::descriptor_base::wait_read,
                           [then](const boost::system::error_code& error) {
                               if (!error) then();
                           });
    }
    std::size_t read(std::span<std::uint8_t> block) override {
        const ssize_t got = ::read(descriptor(), block.data(), block.size());
        return got > 0 ? static_cast<std::size_t>(got) : 0;
    }
    std::size_t write(std::span<const std::uint8_t> bytes) override {
        const ssize_t taken = ::write(descriptor(), bytes.data(), bytes.size());
        if (taken >= 0) return static_cast<std::size_t>(taken);
        if (errno != EAGAIN && errno != EIO) fail();
        closed();  // it may be that nobody is there any more
        return 0;
    }
    bool waits() const override { return false; }

  private:
    int descriptor() const {
        return const_cast<boost::asio::posix::stream_descriptor&>(master_).native_handle();
    }
    /// Nobody has it open any more, and all that was written to it has been read.
    bool closed() {
        pollfd look{descriptor(), POLLIN, 0};
        const bool now =
            ::poll(&look, 1, 0) == 1 && (look.revents & POLLHUP) != 0 && (look.revents & POLLIN) == 0;
        if (now && !closed_) tcflush(descriptor(), TCOFLUSH);
        closed_ = now;
        return now;
    }
    [[noreturn]] static void fail() { throw RunError(fmt::format("pty: {}", std::strerror(errno))); }

    boost::asio::posix::stream_descriptor master_;
    boost::asio::steady_timer timer_;
    std::string name_;
    std::atomic<bool> closed_{false};
};

}  // namespace

std::unique_ptr<UartEnd> make_pty_end(const LiveOptions& options) {
    return std::make_unique<LiveEnd>(options, [&](boost::asio::io_context& io) {
        return std::make_unique<Pty>(io, 1e12 / static_cast<double>(options.bit_period));
    });
}

}  // namespace puckloop::exec
