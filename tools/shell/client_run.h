#pragma once
// `run --view` and `run --shell`: the run in a process of its own, with this one as the client that drives
// it, or as what becomes the client.

#include <filesystem>
#include <functional>

#include <sys/types.h>

namespace puckloop::tools {

struct RunWithClient {
    std::function<int()> run;                        ///< takes a client, as `run --control`; in a child
    std::function<std::filesystem::path()> results;  ///< folder that it writes into
    /// Drives it; returns an exit status. It may become another program, which then is the parent of the run.
    std::function<int(const std::filesystem::path&, pid_t run)> client;
};

/// Returns the client's exit status if that is not 0, else the run's. Nothing may have been started yet: the
/// process is forked.
int run_with_client(const RunWithClient& parts);

/// The end of that, for a program that the client became: what `client` returns, then the run. If it throws,
/// the run ends.
int with_child_run(pid_t run, const std::function<int()>& client);

}  // namespace puckloop::tools
