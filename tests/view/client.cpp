#include "tests/view/client.h"

#include <catch2/catch.hpp>

#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <thread>

namespace puckloop::tests {

Connection::Connection(std::uint16_t port) : socket_(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
    sockaddr_in place{};
    place.sin_family = AF_INET;
    place.sin_port = htons(port);
    place.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    if (socket_ >= 0 && ::connect(socket_, reinterpret_cast<const sockaddr*>(&place), sizeof place) != 0) {
        ::close(socket_);
        socket_ = -1;
    }
}

Connection::~Connection() {
    if (socket_ >= 0) ::close(socket_);
}

bool Connection::send(const std::string& bytes) const {
    return ::send(socket_, bytes.data(), bytes.size(), MSG_NOSIGNAL) == static_cast<::ssize_t>(bytes.size());
}

std::string Connection::answer(double limit) const {
    std::string text;
    const double end = wall_seconds() + limit;
    while (wall_seconds() < end) {
        if (const std::size_t body = text.find("\r\n\r\n"); body != std::string::npos) {
            const std::size_t length = text.find("Content-Length: ");
            if (length < body &&
                text.size() >= body + 4 + std::strtoul(text.c_str() + length + 16, nullptr, 10))
                return text;
        }
        pollfd watched{socket_, POLLIN, 0};
        if (::poll(&watched, 1, 50) <= 0) continue;
        char bytes[65536];
        const ::ssize_t got = ::recv(socket_, bytes, sizeof bytes, 0);
        if (got <= 0) break;
        text.append(bytes, static_cast<std::size_t>(got));
    }
    return text;
}

bool Connection::closed(double limit) const {
    const double end = wall_seconds() + limit;
    while (wall_seconds() < end) {
        pollfd watched{socket_, POLLIN, 0};
        if (::poll(&watched, 1, 50) <= 0) continue;
        char bytes[65536];
        if (::recv(socket_, bytes, sizeof bytes, 0) <= 0) return true;
    }
    return false;
}

std::string Viewer::request(const std::string& rest, const std::string& more) const {
    return "GET /" + token + "/" + rest + " HTTP/1.1\r\nHost: " + host() + "\r\n" + more + "\r\n";
}

std::string Viewer::get(const std::string& rest) const {
    const Connection connection(port);
    connection.send(request(rest));
    return connection.answer();
}

Viewer start_viewer(const std::filesystem::path& folder, const std::filesystem::path& scratch) {
    std::filesystem::create_directories(scratch);
    Viewer viewer;
    viewer.process = std::make_unique<Process>(
        std::vector<std::string>{PUCKLOOP_PROGRAM, "view", folder.string()}, scratch);
    const std::string before = "http://127.0.0.1:";
    const double end = wall_seconds() + 30;
    std::string out;
    while (out.find("\n") == std::string::npos && wall_seconds() < end) {
        std::this_thread::sleep_for(std::chrono::milliseconds(10));
        for (const auto& entry : std::filesystem::directory_iterator(scratch))
            if (const std::string text = text_of(entry.path()); text.starts_with(before)) out = text;
    }
    REQUIRE(out.starts_with(before));
    viewer.port = static_cast<std::uint16_t>(std::strtoul(out.c_str() + before.size(), nullptr, 10));
    const std::size_t slash = out.find('/', before.size());
    viewer.token = out.substr(slash + 1, out.find('/', slash + 1) - slash - 1);
    REQUIRE(viewer.token.size() == 32);
    return viewer;
}

std::string status_of(const std::string& answer) {
    return answer.starts_with("HTTP/1.1 ") ? answer.substr(9, 3) : "";
}

}  // namespace puckloop::tests
