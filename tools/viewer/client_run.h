#pragma once
// `run --view` and `run --shell`: the run in a process of its own, with this one as the client that drives
// it.

#include <filesystem>
#include <functional>

namespace puckloop::tools {

struct RunWithClient {
    std::function<int()> run;                        ///< takes a client, as `run --control`; in a child
    std::function<std::filesystem::path()> results;  ///< folder that it writes into
    std::function<int(const std::filesystem::path&)> client;  ///< drives it; returns an exit status
};

/// Returns the client's exit status if that is not 0, else the run's. Nothing may have been started yet: the
/// process is forked.
int run_with_client(const RunWithClient& parts);

}  // namespace puckloop::tools
