#include "view/server/loopback_port.h"

#include "base/error.h"

#include <fmt/format.h>

#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <string>

namespace puckloop::view {

int listen_at(std::uint16_t port, std::string_view option) {
    const int listener = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
    const int yes = 1;
    sockaddr_in place{};
    place.sin_family = AF_INET;
    place.sin_port = htons(port);
    place.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    if (listener < 0 || ::setsockopt(listener, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes) != 0 ||
        ::bind(listener, reinterpret_cast<const sockaddr*>(&place), sizeof place) != 0 ||
        ::listen(listener, SOMAXCONN) != 0) {
        const int reason = errno;
        if (listener >= 0) ::close(listener);
        throw InputError("", std::string(option),
                         fmt::format("{} cannot be listened to: {}", port, std::strerror(reason)),
                         "another port, or 0 for one that is free");
    }
    return listener;
}

void check_port(std::uint16_t port, std::string_view option) {
    ::close(listen_at(port, option));
}

}  // namespace puckloop::view
