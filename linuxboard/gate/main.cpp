// puckloop-gate PATH=HOST:PORT...: whoever connects with a socket at PATH, in the host's file system, is
// connected with HOST:PORT in the emulated network. Started by `puckloop run --join` (docs/network.md).
//
// Exit status: 2 wrong use, or a socket that cannot be made.

#include <netdb.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fcntl.h>
#include <list>
#include <string>
#include <vector>

namespace {

constexpr int kWrongUse = 2;
constexpr std::size_t kBlock = 64 * 1024;  // what waits in one direction at most
constexpr std::size_t kMostCallers = 256;

[[noreturn]] void refuse(const std::string& what) {
    std::fprintf(stderr, "puckloop-gate: %s\n", what.c_str());
    std::exit(kWrongUse);
}

struct Door {
    std::string host, port;
    int listener = -1;
};

/// Octets from one end to the other.
struct Flow {
    std::array<char, kBlock> octets{};
    std::size_t begin = 0, end = 0;
    bool over = false;    ///< the source has ended
    bool passed = false;  ///< and the sink has been informed

    bool empty() const { return begin == end; }
};

struct Caller {
    int outer = -1, inner = -1;
    bool connecting = true;
    Flow in, out;
};

Door open_door(const std::string& text) {
    const std::size_t equals = text.find('='), colon = text.rfind(':');
    if (equals == std::string::npos || colon == std::string::npos || colon < equals)
        refuse("'" + text + "' is not PATH=HOST:PORT");
    const std::string path = text.substr(0, equals);
    Door door{text.substr(equals + 1, colon - equals - 1), text.substr(colon + 1)};
    sockaddr_un place{};
    place.sun_family = AF_UNIX;
    if (path.empty() || path.size() >= sizeof place.sun_path) refuse("'" + path + "' is no path of a socket");
    std::copy(path.begin(), path.end(), place.sun_path);
    door.listener = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
    constexpr int kBacklog = 16;
    if (door.listener < 0 ||
        bind(door.listener, reinterpret_cast<const sockaddr*>(&place), sizeof place) != 0 ||
        listen(door.listener, kBacklog) != 0)
        refuse(path + ": " + std::strerror(errno));
    return door;
}

/// A connection that has begun; -1: there is no way, and why is printed.
int connect_inside(const Door& door) {
    addrinfo wanted{}, *found = nullptr;
    wanted.ai_family = AF_INET;
    wanted.ai_socktype = SOCK_STREAM;
    if (const int error = getaddrinfo(door.host.c_str(), door.port.c_str(), &wanted, &found); error != 0) {
        std::printf("%s:%s: %s\n", door.host.c_str(), door.port.c_str(), gai_strerror(error));
        return -1;
    }
    const int inner = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
    const bool begun =
        inner >= 0 && (connect(inner, found->ai_addr, found->ai_addrlen) == 0 || errno == EINPROGRESS);
    if (!begun) {
        std::printf("%s:%s: %s\n", door.host.c_str(), door.port.c_str(), std::strerror(errno));
        if (inner >= 0) close(inner);
    }
    freeaddrinfo(found);
    return begun ? inner : -1;
}

/// False once the connection is broken.
bool take(int from, Flow& flow) {
    if (!flow.empty() || flow.over) return true;
    const ssize_t got = recv(from, flow.octets.data(), flow.octets.size(), 0);
    if (got < 0) return errno == EAGAIN || errno == EINTR;
    flow.begin = 0;
    flow.end = static_cast<std::size_t>(got);
    flow.over = got == 0;
    return true;
}

bool give(int to, Flow& flow) {
    while (!flow.empty()) {
        const ssize_t sent = send(to, flow.octets.data() + flow.begin, flow.end - flow.begin, MSG_NOSIGNAL);
        if (sent < 0) return errno == EAGAIN || errno == EINTR;
        flow.begin += static_cast<std::size_t>(sent);
    }
    if (flow.over && !flow.passed) {
        shutdown(to, SHUT_WR);
        flow.passed = true;
    }
    return true;
}

/// False once it has ended.
bool serve(Caller& caller, short outer, short inner) {
    if (caller.connecting) {
        if ((inner & (POLLOUT | POLLERR | POLLHUP)) == 0) return true;
        int error = 0;
        socklen_t size = sizeof error;
        getsockopt(caller.inner, SOL_SOCKET, SO_ERROR, &error, &size);
        if (error != 0) {
            std::printf("not connected: %s\n", std::strerror(error));
            return false;
        }
        caller.connecting = false;
        return true;
    }
    if ((outer & (POLLIN | POLLHUP | POLLERR)) != 0 && !take(caller.outer, caller.in)) return false;
    if ((inner & (POLLIN | POLLHUP | POLLERR)) != 0 && !take(caller.inner, caller.out)) return false;
    if (!give(caller.inner, caller.in) || !give(caller.outer, caller.out)) return false;
    return !(caller.in.passed && caller.out.passed);
}

short wanted_of(const Flow& incoming, const Flow& outgoing) {
    short events = 0;
    if (incoming.empty() && !incoming.over) events |= POLLIN;
    if (!outgoing.empty()) events |= POLLOUT;
    return events;
}

void welcome(const Door& door, std::list<Caller>& callers) {
    const int outer = accept4(door.listener, nullptr, nullptr, SOCK_CLOEXEC | SOCK_NONBLOCK);
    if (outer < 0) return;
    const int inner = callers.size() < kMostCallers ? connect_inside(door) : -1;
    if (inner < 0) {
        close(outer);
        return;
    }
    Caller& caller = callers.emplace_back();
    caller.outer = outer;
    caller.inner = inner;
}

}  // namespace

int main(int count, char** words) {
    if (count < 2) refuse("usage: puckloop-gate PATH=HOST:PORT...");
    std::setvbuf(stdout, nullptr, _IOLBF, 0);
    std::vector<Door> doors;
    for (int i = 1; i < count; ++i)
        doors.push_back(open_door(words[i]));
    std::list<Caller> callers;
    std::vector<pollfd> watched;
    for (;;) {
        watched.clear();
        for (const Door& door : doors)
            watched.push_back({door.listener, POLLIN, 0});
        for (const Caller& caller : callers) {
            watched.push_back(
                {caller.outer, caller.connecting ? short{0} : wanted_of(caller.in, caller.out), 0});
            watched.push_back(
                {caller.inner, caller.connecting ? short{POLLOUT} : wanted_of(caller.out, caller.in), 0});
        }
        if (poll(watched.data(), watched.size(), -1) < 0 && errno != EINTR)
            refuse(std::string("poll: ") + std::strerror(errno));
        std::size_t at = doors.size();
        for (auto caller = callers.begin(); caller != callers.end(); at += 2) {
            if (serve(*caller, watched[at].revents, watched[at + 1].revents)) {
                ++caller;
                continue;
            }
            close(caller->outer);
            close(caller->inner);
            caller = callers.erase(caller);
        }
        for (std::size_t i = 0; i < doors.size(); ++i)
            if ((watched[i].revents & POLLIN) != 0) welcome(doors[i], callers);
    }
}
