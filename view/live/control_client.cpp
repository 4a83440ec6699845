#include "view/live/control_client.h"

#include "base/error.h"
#include "base/files/text_file.h"
#include "base/json.h"

#include <fmt/format.h>

#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <fstream>

namespace puckloop::view {

namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr std::size_t kLongestReply = 16U << 20;

/// The client's socket of control.json; empty: there is none, or the run has ended.
std::string socket_of(const fs::path& folder) {
    const auto note = json::parse(read_whole_file(folder / "control.json").value_or(""), nullptr, false);
    return note.is_object() && note.contains("control") && note["control"].is_string()
               ? note["control"].get<std::string>()
               : std::string();
}

}  // namespace

bool ControlClient::is_there(const fs::path& folder) {
    // A run that was killed leaves control.json and its socket, which nobody listens to. To connect to it
    // would be to become its client.
    const std::string socket = socket_of(folder);
    if (socket.empty()) return false;
    std::ifstream all("/proc/net/unix");
    for (std::string line; std::getline(all, line);)
        if (line.size() > socket.size() && line.ends_with(socket) &&
            line[line.size() - socket.size() - 1] == ' ')
            return true;
    return !all.eof();  // the list itself cannot be read
}

ControlClient::ControlClient(const fs::path& folder) {
    const std::string path = socket_of(folder);
    sockaddr_un place{};
    place.sun_family = AF_UNIX;
    if (path.empty() || path.size() >= sizeof place.sun_path)
        throw InputError(folder.string(), "", "no run that takes a client goes on there",
                         "`puckloop run SCENARIO --control`");
    std::memcpy(place.sun_path, path.c_str(), path.size() + 1);
    socket_ = ::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
    const timeval patience{10, 0};  // for its first line: a run that has a client lets others wait
    if (socket_ < 0 || ::setsockopt(socket_, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience) != 0 ||
        ::connect(socket_, reinterpret_cast<const sockaddr*>(&place), sizeof place) != 0) {
        const int reason = errno;
        if (socket_ >= 0) ::close(socket_);
        throw InputError(folder.string(), "",
                         fmt::format("its run does not answer: {}", std::strerror(reason)),
                         "a run that goes on and has no other client");
    }
    try {
        greeting_ = next_line();
        const auto first = json::parse(greeting_, nullptr, false);
        if (!first.is_object() || first.value("protocol", 0) != 1)
            throw InputError(folder.string(), "", "its run speaks another control protocol",
                             "the same version of puckloop for both");
    } catch (const RunError&) {
        ::close(socket_);
        throw InputError(folder.string(), "", "its run does not answer",
                         "a run that has no other client: one drives at a time");
    } catch (...) {
        ::close(socket_);
        throw;
    }
    const timeval none{0, 0};
    ::setsockopt(socket_, SOL_SOCKET, SO_RCVTIMEO, &none, sizeof none);
}

ControlClient::~ControlClient() {
    ::close(socket_);
}

std::string ControlClient::ask(const std::string& request) {
    const std::string line = request + "\n";
    for (std::size_t sent = 0; sent < line.size();) {
        const ::ssize_t now = ::send(socket_, line.data() + sent, line.size() - sent, MSG_NOSIGNAL);
        if (now < 0 && errno == EINTR) continue;
        if (now <= 0) throw RunError("the run has closed the line");
        sent += static_cast<std::size_t>(now);
    }
    return next_line();
}

std::string ControlClient::next_line() {
    while (true) {
        if (const std::size_t end = received_.find('\n'); end != std::string::npos) {
            std::string answer = received_.substr(0, end);
            received_.erase(0, end + 1);
            return answer;
        }
        if (received_.size() > kLongestReply) throw RunError("a reply of the run is too long");
        char piece[65536];
        const ::ssize_t got = ::recv(socket_, piece, sizeof piece, 0);
        if (got < 0 && errno == EINTR) continue;
        if (got <= 0) throw RunError("the run has closed the line");
        received_.append(piece, static_cast<std::size_t>(got));
    }
}

}  // namespace puckloop::view
