#pragma once
// `puckloop shell`: a run driven by commands, from a terminal or a script.

#include "view/live/control_client.h"

#include <nlohmann/json_fwd.hpp>

#include <filesystem>
#include <string>
#include <vector>

namespace puckloop::tools {

class Shell {
  public:
    /// Connects to the run in `results`. Throws InputError.
    explicit Shell(const std::filesystem::path& results);

    /// One command. False: the run is over. What is refused is printed, and counted.
    bool execute(const std::string& line);
    /// What the last word of a line may become.
    std::vector<std::string> complete(const std::string& line) const;
    int refused() const { return refused_; }
    /// The run ends, unless it has.
    void finish();

    struct Command;

  private:
    friend struct ShellCommands;
    /// The reply to a request, without what failed: throws InputError for that.
    nlohmann::json ask(nlohmann::json request);
    void take(const nlohmann::json& reply);
    void choose(const std::string& board);

    view::ControlClient run_;
    std::vector<std::string> boards_, links_;
    std::string board_, last_;
    double time_s_ = 0.0;
    bool over_ = false, captures_ = false;
    int refused_ = 0;
};

/// Commands from the terminal, or from standard input, until there are no more. The exit status: 0, or 1 for
/// a script of which something was refused.
int run_shell(const std::filesystem::path& results);

}  // namespace puckloop::tools
