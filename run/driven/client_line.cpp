#include "run/driven/client_line.h"

#include "base/error.h"
#include "base/json.h"

#include <fmt/format.h>

#include <poll.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

namespace puckloop::tools {

namespace {

constexpr std::size_t kLongestClientLine = 1 << 20;
constexpr int kLookMs = 100;  ///< so often it is looked for Ctrl-C

bool set(const volatile std::sig_atomic_t* flag) {
    return flag != nullptr && *flag != 0;
}

/// Something is to be had of `descriptor`, or (`events`) can be given to it.
bool ready(int descriptor, short events = POLLIN) {
    pollfd asked{descriptor, events, 0};
    return ::poll(&asked, 1, kLookMs) > 0;
}

}  // namespace

ClientLine::ClientLine(const std::string& path, const volatile std::sig_atomic_t* interrupted)
    : interrupted_(interrupted) {
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    if (path.size() >= sizeof address.sun_path)
        throw RunError(fmt::format("{}: the path is too long for a socket", path));
    std::memcpy(address.sun_path, path.c_str(), path.size() + 1);
    listener_ = ::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
    // Before there is a file: Linux gives it the descriptor's mode, so at no time may others open it.
    const bool good = listener_ >= 0 && ::fchmod(listener_, S_IRUSR | S_IWUSR) == 0 &&
                      // NOLINTNEXTLINE: what the socket calls take
                      ::bind(listener_, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0 &&
                      ::listen(listener_, 1) == 0;
    if (good) return;
    const int reason = errno;
    if (listener_ >= 0) ::close(listener_);
    throw RunError(fmt::format("{}: {}", path, std::strerror(reason)));
}

ClientLine::~ClientLine() {
    drop();
    ::close(listener_);
}

void ClientLine::drop() {
    if (client_ >= 0) ::close(client_);
    client_ = -1;
}

bool ClientLine::await_client() {
    while (client_ < 0) {
        if (set(interrupted_)) return false;
        if (ready(listener_)) client_ = ::accept4(listener_, nullptr, nullptr, SOCK_CLOEXEC);
    }
    return true;
}

std::optional<std::string> ClientLine::next() {
    while (client_ >= 0) {
        if (const std::size_t end = text_.find('\n'); end != std::string::npos) {
            std::string line = text_.substr(0, end);
            text_.erase(0, end + 1);
            return line;
        }
        if (set(interrupted_)) return std::nullopt;
        if (!ready(client_)) continue;
        char piece[4096];
        const ssize_t got = ::recv(client_, piece, sizeof piece, 0);
        if (got > 0) text_.append(piece, static_cast<std::size_t>(got));
        const bool lost = got == 0 || (got < 0 && errno != EINTR);
        if (lost || text_.size() > kLongestClientLine) drop();
    }
    return std::nullopt;
}

void ClientLine::send(const nlohmann::ordered_json& reply) {
    const std::string line =
        reply.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
    for (std::size_t at = 0; at < line.size() && client_ >= 0;) {
        if (!ready(client_, POLLOUT)) {
            if (set(interrupted_)) drop();
            continue;
        }
        const ssize_t sent = ::send(client_, line.data() + at, line.size() - at, MSG_NOSIGNAL | MSG_DONTWAIT);
        if (sent > 0) at += static_cast<std::size_t>(sent);
        if (sent < 0 && errno != EINTR && errno != EAGAIN) drop();
    }
}

}  // namespace puckloop::tools
