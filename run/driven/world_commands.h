#pragma once
// Commands of `puckloop act` from the client of a driven run. They are handed to the world while the run
// stands still, which does them in its next step, and replies then.

#include <nlohmann/json_fwd.hpp>

#include <memory>
#include <string>

namespace puckloop::tools {

class WorldCommands {
  public:
    /// `socket`: the world's (run/control/control_socket.h).
    explicit WorldCommands(std::string socket);
    ~WorldCommands();

    /// Throws InputError for what is no command, RunError if the world does not listen.
    void act(const std::string& command);
    /// Replies to commands that were done or refused since the last call, in their order.
    nlohmann::ordered_json take_replies();
    /// Nothing is awaited any more: the world begins again.
    void forget();

  private:
    struct Parts;
    std::unique_ptr<Parts> parts_;
};

}  // namespace puckloop::tools
