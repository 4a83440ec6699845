#include "run/report/live_trace.h"

#include "base/error.h"
#include "base/files/new_file.h"
#include "cosim/trace/trace_csv.h"

#include <fmt/format.h>

#include <fcntl.h>
#include <poll.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <climits>
#include <cstdio>
#include <cstring>
#include <streambuf>

namespace puckloop::tools {

namespace {

constexpr int kPollMilliseconds = 200;  // ms, whether the user has interrupted a wait

/// A pipe without a reader reports it by EPIPE only, in this thread; children keep their signals.
class NoSigpipe {
  public:
    NoSigpipe() {
        sigemptyset(&pipe_);
        sigaddset(&pipe_, SIGPIPE);
        pthread_sigmask(SIG_BLOCK, &pipe_, &before_);
    }
    ~NoSigpipe() {
        const timespec now{};
        while (sigtimedwait(&pipe_, nullptr, &now) > 0) {
        }
        pthread_sigmask(SIG_SETMASK, &before_, nullptr);
    }
    NoSigpipe(const NoSigpipe&) = delete;
    NoSigpipe& operator=(const NoSigpipe&) = delete;

  private:
    sigset_t pipe_{}, before_{};
};

}  // namespace

class LiveTrace::Pipe : public std::streambuf {
  public:
    Pipe(const std::string& path, const volatile std::sig_atomic_t* interrupted)
        : path_(path == "-" ? "the standard output" : path), interrupted_(interrupted) {
        setp(buffer_.data(), buffer_.data() + buffer_.size());
        if (path == "-") {
            if (isatty(STDOUT_FILENO))
                throw InputError("", "--live", "the standard output is a terminal",
                                 "a pipe, as in `... --live - | wireshark -k -i -`");
            descriptor_ = fcntl(STDOUT_FILENO, F_DUPFD_CLOEXEC, 3);
        } else {
            struct stat status {};
            if (stat(path.c_str(), &status) == 0 && S_ISFIFO(status.st_mode))
                std::fprintf(stderr, "puckloop: waiting for a reader of %s\n", path.c_str());
            descriptor_ = open_new_file(path);
        }
        if (descriptor_ >= 0) return;
        if (errno == EINTR) throw RunError(fmt::format("interrupted while nobody read {}", path_));
        throw InputError(path, "--live", "cannot be written: " + why_not_written(errno),
                         "a file, a named pipe or -");
    }
    ~Pipe() override {
        if (descriptor_ >= 0) close(descriptor_);
    }
    Pipe(const Pipe&) = delete;
    Pipe& operator=(const Pipe&) = delete;

    /// Reported already, or nobody reads any more.
    bool gone() const { return gone_; }

  protected:
    int overflow(int c) override {
        sync();
        if (c != traits_type::eof()) {
            *pptr() = static_cast<char>(c);
            pbump(1);
        }
        return 0;
    }
    int sync() override {
        const NoSigpipe quiet;
        const char* at = pbase();
        while (at < pptr() && !gone_) {
            pollfd ready{descriptor_, POLLOUT, 0};
            const int count = poll(&ready, 1, kPollMilliseconds);
            if (count == 0 && interrupted_ != nullptr && *interrupted_ != 0) gone_ = true;
            if (count <= 0) continue;
            // A pipe that is ready takes so much without blocking.
            const auto size = std::min<std::size_t>(static_cast<std::size_t>(pptr() - at), PIPE_BUF);
            const ssize_t written = write(descriptor_, at, size);
            if (written >= 0)
                at += written;
            else if (errno != EINTR && errno != EAGAIN)
                fail();
        }
        setp(buffer_.data(), buffer_.data() + buffer_.size());
        return 0;
    }

  private:
    void fail() {
        const int cause = errno;
        gone_ = true;
        if (cause != EPIPE) throw RunError(fmt::format("{}: cannot write: {}", path_, std::strerror(cause)));
        std::fprintf(stderr, "puckloop: %s: its reader has gone; the run goes on without it\n",
                     path_.c_str());
    }

    std::string path_;
    const volatile std::sig_atomic_t* interrupted_;
    int descriptor_ = -1;
    bool gone_ = false;
    std::array<char, std::size_t{64} << 10> buffer_{};
};

LiveTrace::LiveTrace(const std::string& path, const volatile std::sig_atomic_t* interrupted)
    : pipe_(std::make_unique<Pipe>(path, interrupted)), out_(std::make_unique<std::ostream>(pipe_.get())) {
    out_->exceptions(std::ios::badbit);  // what the pipe throws comes through
}

LiveTrace::~LiveTrace() = default;

void LiveTrace::begin(const std::vector<cosim::LinkSpec>& links) {
    links_ = links;
    stream_ = std::make_unique<PcapngStream>(*out_);
    out_->flush();
}

void LiveTrace::record(const cosim::TraceRecord& record) {
    if (pipe_->gone()) return;
    const cosim::LinkSpec& link = links_[record.link];
    if (record.direction == cosim::Direction::FromA ? link.record_from_a : link.record_from_b)
        stream_->add(cosim::to_row(record, links_));
}

void LiveTrace::flush() {
    if (!pipe_->gone()) out_->flush();
}

void LiveTrace::end() {
    if (stream_ && !pipe_->gone()) stream_->end();
    flush();
}

}  // namespace puckloop::tools
