// `--uartN -`: standard input to the chip, the chip to standard output.

#include "base/error.h"
#include "ends/queued_end.h"

#include <fmt/format.h>
#include <poll.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

namespace puckloop::exec {

namespace {

/// Longest wait, in wall time, for a pipe's writer to be done.
constexpr int kPatienceMilliseconds = 1000;

class StdioEnd : public QueuedEnd {
  public:
    explicit StdioEnd(const StdioOptions& options)
        : options_(options), live_(options.live || isatty(STDIN_FILENO) == 1) {}

    bool live() const override { return live_; }

    void poll(cosim::Time now, cosim::Time listening_since) override {
        flush();
        if (ended_ || waiting()) return;
        if (live_ || patient_done_) {
            while (read_some(0, now)) {
            }
            return;
        }
        if (options_.start ? now + cosim::kMillisecond < *options_.start
                           : listening_since == cosim::kNever || now - listening_since < options_.settle)
            return;
        while (read_some(kPatienceMilliseconds, options_.start.value_or(now))) {
        }
        patient_done_ = true;
    }

    void finish() override { flush(); }

  private:
    /// False once there is no more for now.
    bool read_some(int patience, cosim::Time ready) {
        pollfd waiting{STDIN_FILENO, POLLIN, 0};
        if (::poll(&waiting, 1, patience) <= 0) return false;
        std::uint8_t block[4096];
        const ssize_t got = ::read(STDIN_FILENO, block, sizeof block);
        if (got <= 0) {
            ended_ = got == 0 || (errno != EINTR && errno != EAGAIN);
            return false;
        }
        offer(block, static_cast<std::size_t>(got), ready);
        return true;
    }
    void flush() {
        std::size_t done = 0;
        while (done < outgoing_.size()) {
            const ssize_t written = ::write(STDOUT_FILENO, outgoing_.data() + done, outgoing_.size() - done);
            if (written < 0 && errno == EINTR) continue;
            if (written < 0)
                throw RunError(fmt::format("standard output: cannot be written: {}", std::strerror(errno)));
            done += static_cast<std::size_t>(written);
        }
        outgoing_.clear();
    }

    StdioOptions options_;
    bool live_;
    bool ended_ = false;
    bool patient_done_ = false;
};

}  // namespace

std::unique_ptr<UartEnd> make_stdio_end(const StdioOptions& options) {
    return std::make_unique<StdioEnd>(options);
}

}  // namespace puckloop::exec
