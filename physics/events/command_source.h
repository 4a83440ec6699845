#pragma once
// Where a running world hears commands from: whoever implements it has the sockets.

#include "physics/events/event.h"

#include <optional>

namespace puckloop::physics {

struct Command {
    std::uint64_t id = 0;            ///< of the one who asks
    std::optional<Action> action{};  ///< nothing: list what there is
};

class CommandSource {
  public:
    virtual ~CommandSource() = default;
    /// What has come in since; called once a step, never waits.
    virtual std::vector<Command> poll() = 0;
    /// One line of JSON: {"done": text, "at_s": seconds}, {"refused": reason} or {"list": [...], "at_s": s}.
    virtual void reply(std::uint64_t id, const std::string& json) = 0;
};

}  // namespace puckloop::physics
