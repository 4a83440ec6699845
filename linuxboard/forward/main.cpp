// puckloop-forward: passes bytes between a robot's serial line and a TCP server, such as puckloop-netmanager.
// docs/network.md
//
// While there is no connection it tries to make one; what the robot sends meanwhile is lost, and after it the
// rest of a message up to its CR, so that the server gets whole messages only.
//
// Exit status: 0 ended by a signal; 1 the serial line failed; 2 wrong use, or a line that cannot be opened.

#include <boost/asio/connect.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/posix/stream_descriptor.hpp>
#include <boost/asio/signal_set.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/asio/write.hpp>

#include <array>
#include <cerrno>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fcntl.h>
#include <getopt.h>
#include <string>
#include <termios.h>

namespace {

using boost::asio::ip::tcp;
using Error = boost::system::error_code;

constexpr char kUsage[] = "usage: puckloop-forward --server HOST:PORT [--tty DEVICE] [--retry S]\n"
                          "  --server HOST:PORT where messages go, such as server:7700\n"
                          "  --tty DEVICE       serial line to the main board, 115200 8N1 (/dev/ttyS0)\n"
                          "  --retry S          between two attempts to connect (1)\n";
constexpr int kFailed = 1, kWrongUse = 2;

struct Options {
    std::string host, port, tty = "/dev/ttyS0";
    std::chrono::milliseconds retry{1000};
};

[[noreturn]] void refuse(const std::string& what) {
    std::fprintf(stderr, "puckloop-forward: %s\n", what.c_str());
    std::exit(kWrongUse);
}

Options read_options(int count, char** words) {
    enum { kServer = 1, kTty, kRetry, kHelp };
    const option known[] = {{"server", 1, nullptr, kServer},
                            {"tty", 1, nullptr, kTty},
                            {"retry", 1, nullptr, kRetry},
                            {"help", 0, nullptr, kHelp},
                            {nullptr, 0, nullptr, 0}};
    Options options;
    for (int one; (one = getopt_long(count, words, "", known, nullptr)) != -1;) {
        if (one == kServer) {
            const std::string text = optarg;
            const std::size_t colon = text.rfind(':');
            if (colon == std::string::npos || colon == 0 || colon + 1 == text.size())
                refuse("--server: '" + text + "' is not HOST:PORT");
            options.host = text.substr(0, colon);
            options.port = text.substr(colon + 1);
        } else if (one == kTty) {
            options.tty = optarg;
        } else if (one == kRetry) {
            char* end = nullptr;
            const double seconds = std::strtod(optarg, &end);
            if (*optarg == '\0' || *end != '\0' || !(seconds >= 0.01 && seconds <= 3600))
                refuse(std::string("--retry: '") + optarg + "' is no time from 0.01 to 3600 s");
            options.retry = std::chrono::milliseconds(static_cast<long>(seconds * 1e3));
        } else {
            std::fputs(kUsage, one == kHelp ? stdout : stderr);
            std::exit(one == kHelp ? 0 : kWrongUse);
        }
    }
    if (optind < count) refuse(std::string("'") + words[optind] + "' is not an option");
    if (options.host.empty()) refuse("--server HOST:PORT is missing");
    return options;
}

int open_line(const std::string& tty) {
    const int line = open(tty.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
    termios settings{};
    if (line < 0 || tcgetattr(line, &settings) != 0) refuse(tty + ": " + std::strerror(errno));
    cfmakeraw(&settings);
    cfsetspeed(&settings, B115200);
    settings.c_cflag |= CLOCAL | CREAD;
    if (tcsetattr(line, TCSAFLUSH, &settings) != 0) refuse(tty + ": " + std::strerror(errno));
    return line;
}

class Forwarder {
  public:
    Forwarder(boost::asio::io_context& io, const Options& options)
        : options_(options), line_(io, open_line(options.tty)), socket_(io), resolver_(io), pause_(io) {
        read_line();
        connect();
    }
    int status() const { return status_; }

  private:
    void connect() {
        resolver_.async_resolve(
            options_.host, options_.port, [this](Error error, const tcp::resolver::results_type& places) {
                if (error) return again(error);
                boost::asio::async_connect(socket_, places,
                                           [this](Error failed, const tcp::endpoint&) { connected(failed); });
            });
    }

    void again(Error error) {
        if (said_ != error.message()) {
            said_ = error.message();
            std::fprintf(stderr, "%s:%s: %s\n", options_.host.c_str(), options_.port.c_str(), said_.c_str());
        }
        Error none;
        socket_.close(none);
        connected_ = false;
        whole_ = false;
        pause_.expires_after(options_.retry);
        pause_.async_wait([this](Error stopped) {
            if (!stopped) connect();
        });
    }

    void connected(Error error) {
        if (error) return again(error);
        Error none;
        socket_.set_option(tcp::no_delay(true), none);
        connected_ = true;
        said_.clear();
        std::printf("connected with %s:%s\n", options_.host.c_str(), options_.port.c_str());
        std::fflush(stdout);
        read_server();
    }

    void read_server() {
        socket_.async_read_some(boost::asio::buffer(down_), [this](Error error, std::size_t size) {
            if (error) return again(error);
            boost::asio::async_write(line_, boost::asio::buffer(down_, size),
                                     [this](Error failed, std::size_t) {
                                         if (failed) return fail(failed);
                                         read_server();
                                     });
        });
    }

    void read_line() {
        line_.async_read_some(boost::asio::buffer(up_), [this](Error error, std::size_t size) {
            if (error) return fail(error);
            const char* begin = up_.data();
            const char* const end = begin + size;
            if (!connected_) {
                whole_ = end[-1] == '\r';
                return read_line();
            }
            if (!whole_) {
                const void* mark = std::memchr(begin, '\r', size);
                if (mark == nullptr) return read_line();
                begin = static_cast<const char*>(mark) + 1;
                whole_ = true;
            }
            boost::asio::async_write(socket_,
                                     boost::asio::buffer(begin, static_cast<std::size_t>(end - begin)),
                                     [this](Error, std::size_t) { read_line(); });
        });
    }

    void fail(Error error) {
        if (error == boost::asio::error::operation_aborted) return;
        std::fprintf(stderr, "puckloop-forward: %s: %s\n", options_.tty.c_str(), error.message().c_str());
        status_ = kFailed;
        static_cast<boost::asio::io_context&>(line_.get_executor().context()).stop();
    }

    Options options_;
    boost::asio::posix::stream_descriptor line_;
    tcp::socket socket_;
    tcp::resolver resolver_;
    boost::asio::steady_timer pause_;
    std::array<char, 4096> up_{}, down_{};
    bool connected_ = false;
    bool whole_ = true;  ///< what comes next from the robot begins a message
    std::string said_;
    int status_ = 0;
};

}  // namespace

int main(int count, char** words) {
    const Options options = read_options(count, words);
    boost::asio::io_context io;
    boost::asio::signal_set signals(io, SIGINT, SIGTERM);
    signals.async_wait([&io](Error, int) { io.stop(); });
    Forwarder forwarder(io, options);
    io.run();
    return forwarder.status();
}
