// `--uartN pty`: a pseudo terminal that any terminal program can open.

#include "base/error.h"
#include "tools/exec/ends/queued_end.h"

#include <fmt/format.h>

#include <fcntl.h>
#include <stdlib.h>
#include <termios.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

namespace puckloop::exec {

namespace {

class PtyEnd : public QueuedEnd {
  public:
    PtyEnd() {
        master_ = posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
        char name[128];
        if (master_ < 0 || grantpt(master_) != 0 || unlockpt(master_) != 0 ||
            ptsname_r(master_, name, sizeof name) != 0)
            fail();
        name_ = name;
        // Kept open here, so that the terminal outlives the programs that come and go.
        slave_ = open(name, O_RDWR | O_NOCTTY | O_CLOEXEC);
        termios settings{};
        if (slave_ < 0 || tcgetattr(slave_, &settings) != 0) fail();
        cfmakeraw(&settings);
        if (tcsetattr(slave_, TCSANOW, &settings) != 0) fail();
    }
    ~PtyEnd() override { close_both(); }
    PtyEnd(const PtyEnd&) = delete;
    PtyEnd& operator=(const PtyEnd&) = delete;

    bool live() const override { return true; }
    std::string announcement() const override { return "pty " + name_; }
    void finish() override { write_out(); }

    void poll(cosim::Time now, cosim::Time /*listening_since*/) override {
        write_out();
        if (waiting()) return;
        std::uint8_t block[512];
        const ssize_t got = ::read(master_, block, sizeof block);
        if (got > 0) offer(block, static_cast<std::size_t>(got), now);
    }

  private:
    void write_out() {
        // What does not fit is dropped: a serial line has nobody to wait for.
        if (!outgoing_.empty() && ::write(master_, outgoing_.data(), outgoing_.size()) < 0 && errno != EAGAIN)
            fail();
        outgoing_.clear();
    }
    void close_both() {
        if (slave_ >= 0) close(slave_);
        if (master_ >= 0) close(master_);
    }
    [[noreturn]] void fail() {
        const std::string reason = std::strerror(errno);
        close_both();
        slave_ = master_ = -1;
        throw RunError(fmt::format("pty: {}", reason));
    }

    int master_ = -1;
    int slave_ = -1;
    std::string name_;
};

}  // namespace

std::unique_ptr<UartEnd> make_pty_end() {
    return std::make_unique<PtyEnd>();
}

}  // namespace puckloop::exec
