#include "run/driven/world_commands.h"

#include "base/error.h"
#include "base/json.h"
#include "scenarios/reader/events/event_tables.h"

#include <fmt/format.h>

#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <deque>
#include <utility>

namespace puckloop::tools {

using nlohmann::ordered_json;

struct WorldCommands::Parts {
    struct Asked {
        std::string command;
        int descriptor = -1;
        std::string reply{};
    };
    std::string socket;
    std::deque<Asked> asked;
};

WorldCommands::WorldCommands(std::string socket) : parts_(std::make_unique<Parts>()) {
    parts_->socket = std::move(socket);
}

WorldCommands::~WorldCommands() {
    forget();
}

void WorldCommands::forget() {
    for (const Parts::Asked& one : parts_->asked)
        ::close(one.descriptor);
    parts_->asked.clear();
}

void WorldCommands::act(const std::string& command) {
    scenarios::parse_command(command);  // refused before the world is asked
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    std::strncpy(address.sun_path, parts_->socket.c_str(), sizeof address.sun_path - 1);
    const int descriptor = ::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
    const std::string line = nlohmann::json{{"act", command}}.dump() + "\n";
    // NOLINTNEXTLINE: what connect() takes
    if (descriptor < 0 ||
        ::connect(descriptor, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0 ||
        ::send(descriptor, line.data(), line.size(), MSG_NOSIGNAL) != static_cast<ssize_t>(line.size())) {
        const int reason = errno;
        if (descriptor >= 0) ::close(descriptor);
        throw RunError(fmt::format("the world takes no commands: {}", std::strerror(reason)));
    }
    parts_->asked.push_back({command, descriptor});
}

ordered_json WorldCommands::take_replies() {
    ordered_json replies = ordered_json::array();
    while (!parts_->asked.empty()) {
        Parts::Asked& first = parts_->asked.front();
        char piece[4096];
        for (ssize_t got; (got = ::recv(first.descriptor, piece, sizeof piece, MSG_DONTWAIT)) > 0;)
            first.reply.append(piece, static_cast<std::size_t>(got));
        if (first.reply.find('\n') == std::string::npos) break;  // it waits for its event to be over
        ordered_json reply = ordered_json::parse(first.reply, nullptr, false);
        if (!reply.is_object()) reply = {{"refused", "a reply that is none"}};
        reply["act"] = first.command;
        replies.push_back(std::move(reply));
        ::close(first.descriptor);
        parts_->asked.pop_front();
    }
    return replies;
}

}  // namespace puckloop::tools
