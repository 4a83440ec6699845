#include "tests/debug/gdb_client.h"

#include "debug/gdb/rsp_packet.h"

#include <catch2/catch.hpp>

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <fstream>
#include <sstream>
#include <thread>
#include <vector>

namespace puckloop::tests {

namespace {

constexpr int kPatienceMs = 60'000;

std::string content(const std::string& path) {
    std::ifstream in(path, std::ios::binary);
    std::ostringstream text;
    text << in.rdbuf();
    return text.str();
}

}  // namespace

GdbServer::GdbServer(const std::string& folder, const std::string& arguments)
    : GdbServer(folder, "exec " + arguments + " --gdb unix:{}", Whole{}) {}

GdbServer::GdbServer(const std::string& folder, std::string arguments, Whole)
    : folder_(folder), socket_(folder + "/gdb.sock") {
    ::unlink(socket_.c_str());
    arguments.replace(arguments.find("{}"), 2, socket_);
    const std::string command = "exec " + std::string(PUCKLOOP_PROGRAM) + " " + arguments + " >" + folder +
                                "/server.out 2>" + folder + "/server.err </dev/null";
    process_ = ::fork();
    REQUIRE(process_ >= 0);
    if (process_ == 0) {
        ::execl("/bin/sh", "sh", "-c", command.c_str(), nullptr);
        ::_exit(127);
    }
}

GdbServer::~GdbServer() {
    if (process_ <= 0) return;
    ::kill(process_, SIGKILL);
    ::waitpid(process_, nullptr, 0);
}

std::string GdbServer::out() const {
    return content(folder_ + "/server.out");
}
std::string GdbServer::err() const {
    return content(folder_ + "/server.err");
}

void GdbServer::await_listening() const {
    for (int waited = 0; waited < kPatienceMs / 2; waited += 10) {
        if (err().find(socket_ + "\n") != std::string::npos) return;
        std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    FAIL("nobody listens at " << socket_ << ": " << err());
}

int GdbServer::wait() {
    for (int waited = 0; waited < kPatienceMs; waited += 10) {
        int status = 0;
        if (::waitpid(process_, &status, WNOHANG) == process_) {
            process_ = -1;
            return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
        }
        std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    FAIL("the run does not end");
    return -1;
}

GdbClient::GdbClient(const std::string& path) {
    sockaddr_un name{};
    name.sun_family = AF_UNIX;
    REQUIRE(path.size() < sizeof name.sun_path);
    path.copy(name.sun_path, path.size());
    for (int waited = 0; waited < kPatienceMs / 2; waited += 10) {
        socket_ = ::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
        if (::connect(socket_, reinterpret_cast<const sockaddr*>(&name), sizeof name) == 0) return;
        ::close(socket_);
        std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    socket_ = -1;
    FAIL("nobody listens at " << path);
}

GdbClient::~GdbClient() {
    if (socket_ >= 0) ::close(socket_);
}

void GdbClient::send_raw(std::string_view bytes) {
    REQUIRE(::send(socket_, bytes.data(), bytes.size(), MSG_NOSIGNAL) == static_cast<ssize_t>(bytes.size()));
}

void GdbClient::send(std::string_view packet) {
    send_raw(debug::rsp_packet(packet));
}

std::optional<char> GdbClient::byte() {
    if (taken_ == buffer_.size()) {
        pollfd asked{socket_, POLLIN, 0};
        REQUIRE(::poll(&asked, 1, kPatienceMs) > 0);
        char block[4096];
        const ssize_t got = ::recv(socket_, block, sizeof block, 0);
        if (got <= 0) return std::nullopt;
        buffer_.assign(block, static_cast<std::size_t>(got));
        taken_ = 0;
    }
    return buffer_[taken_++];
}

std::optional<std::string> GdbClient::receive() {
    debug::RspReader reader;
    while (true) {
        const std::optional<char> next = byte();
        if (!next) return std::nullopt;
        reader.feed({&*next, 1});
        if (const auto event = reader.next()) {
            if (event->kind == debug::RspEvent::Kind::Again) continue;  // of a packet that we damaged
            REQUIRE(event->kind == debug::RspEvent::Kind::Packet);
            // Whoever hangs up behind its answer needs none.
            (void)!::send(socket_, "+", 1, MSG_NOSIGNAL);
            return event->data;
        }
    }
}

std::string GdbClient::ask(std::string_view packet) {
    send(packet);
    const auto answer = receive();
    REQUIRE(answer);
    return *answer;
}

std::string GdbClient::monitor(std::string_view text) {
    const auto bytes = debug::from_hex(ask("qRcmd," + debug::to_hex(text)));
    REQUIRE(bytes);
    return {bytes->begin(), bytes->end()};
}

std::uint64_t GdbClient::register_value(unsigned number) {
    char packet[16];
    std::snprintf(packet, sizeof packet, "p%x", number);
    const auto bytes = debug::from_hex(ask(packet));
    REQUIRE((bytes && !bytes->empty()));
    std::uint64_t value = 0;
    for (std::size_t i = bytes->size(); i > 0; --i)
        value = value << 8 | (*bytes)[i - 1];
    return value;
}

}  // namespace puckloop::tests
