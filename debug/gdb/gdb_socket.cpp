#include "debug/gdb/gdb_socket.h"

#include "base/error.h"

#include <arpa/inet.h>
#include <fmt/format.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include <cerrno>
#include <charconv>
#include <cstring>
#include <utility>

namespace puckloop::debug {

namespace {

constexpr std::string_view kUnix = "unix:";
constexpr int kPatienceMs = 100;

std::uint16_t port_of(std::string_view option, std::string_view where) {
    std::uint16_t port = 0;
    const char* const last = where.data() + where.size();
    if (where.size() > 1 && where.front() == ':') {
        const auto [end, error] = std::from_chars(where.data() + 1, last, port);
        if (error == std::errc{} && end == last) return port;
    }
    throw InputError("", option, fmt::format("'{}' is no address to listen on", where),
                     "unix:PATH, or :PORT (on 127.0.0.1; 0 for a free one)");
}

}  // namespace

GdbSocket::GdbSocket(std::string_view option, const std::string& where) {
    const auto check = [&](bool done) {
        if (done) return;
        const std::string why = std::strerror(errno);
        if (listener_ >= 0) ::close(listener_);
        throw InputError("", option, fmt::format("{}: {}", where, why), "a free port or path");
    };
    if (where.starts_with(kUnix) && where.size() > kUnix.size()) {
        sockaddr_un name{};
        name.sun_family = AF_UNIX;
        path_ = where.substr(kUnix.size());
        errno = ENAMETOOLONG;
        check(path_.size() < sizeof name.sun_path);
        path_.copy(name.sun_path, path_.size());
        struct stat there {};
        // A socket that a run before left is in nobody's way; anything else stays.
        if (::lstat(path_.c_str(), &there) == 0 && S_ISSOCK(there.st_mode)) {
            const int probe = ::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
            const bool answers = ::connect(probe, reinterpret_cast<const sockaddr*>(&name), sizeof name) == 0;
            ::close(probe);
            if (!answers) ::unlink(path_.c_str());
        }
        listener_ = ::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
        check(listener_ >= 0);
        // Before there is a file: Linux gives it the descriptor's mode, so at no time may others open it.
        check(::fchmod(listener_, S_IRUSR | S_IWUSR) == 0);
        check(::bind(listener_, reinterpret_cast<const sockaddr*>(&name), sizeof name) == 0);
        check(::listen(listener_, 1) == 0);
        address_ = path_;
        return;
    }
    sockaddr_in name{};
    name.sin_family = AF_INET;
    name.sin_port = htons(port_of(option, where));
    name.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    listener_ = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
    check(listener_ >= 0);
    const int on = 1;
    ::setsockopt(listener_, SOL_SOCKET, SO_REUSEADDR, &on, sizeof on);
    check(::bind(listener_, reinterpret_cast<const sockaddr*>(&name), sizeof name) == 0);
    check(::listen(listener_, 1) == 0);
    socklen_t size = sizeof name;
    check(::getsockname(listener_, reinterpret_cast<sockaddr*>(&name), &size) == 0);
    address_ = fmt::format("127.0.0.1:{}", ntohs(name.sin_port));
    fmt::print(stderr, "{}: {} is open to every user of this machine; unix:PATH is this user's alone\n",
               option, address_);
}

GdbSocket::~GdbSocket() {
    hang_up();
    ::close(listener_);
    if (!path_.empty()) ::unlink(path_.c_str());
}

bool GdbSocket::await(int descriptor, bool wait, const std::function<bool()>& gives_up) const {
    while (true) {
        pollfd asked{descriptor, POLLIN, 0};
        if (::poll(&asked, 1, wait ? kPatienceMs : 0) > 0) return true;
        if (!wait || (gives_up && gives_up())) return false;
    }
}

bool GdbSocket::accept(const std::function<bool()>& gives_up) {
    if (!await(listener_, true, gives_up)) return false;
    return accept_now();
}

bool GdbSocket::accept_now() {
    if (connected() || !await(listener_, false, nullptr)) return false;
    client_ = ::accept4(listener_, nullptr, nullptr, SOCK_CLOEXEC);
    const int on = 1;  // of no meaning, and refused, on a Unix-domain socket
    if (connected()) ::setsockopt(client_, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
    return connected();
}

std::span<const char> GdbSocket::read(bool wait, const std::function<bool()>& gives_up) {
    if (!connected() || !await(client_, wait, gives_up)) return {};
    const ssize_t got = ::recv(client_, buffer_, sizeof buffer_, 0);
    if (got > 0) return {buffer_, static_cast<std::size_t>(got)};
    if (got == 0 || (errno != EINTR && errno != EAGAIN)) hang_up();
    return {};
}

void GdbSocket::write(std::string_view text) {
    while (connected() && !text.empty()) {
        const ssize_t sent = ::send(client_, text.data(), text.size(), MSG_NOSIGNAL);
        if (sent > 0)
            text.remove_prefix(static_cast<std::size_t>(sent));
        else if (errno != EINTR)
            hang_up();
    }
}

void GdbSocket::hang_up() {
    if (connected()) ::close(std::exchange(client_, -1));
}

}  // namespace puckloop::debug
