#pragma once
// `run --view`: the run in a process of its own, with this one as the client that its page drives it by.

#include <filesystem>
#include <functional>

namespace puckloop::tools {

/// Calls `run`, which takes a client (`run --control`), in a child; it writes into `results`, known once
/// `results` is called. Returns the run's exit status once Ctrl-C has ended the page. Nothing may have been
/// started yet: the process is forked.
int run_and_view(const std::function<int()>& run, const std::function<std::filesystem::path()>& results,
                 int port);

}  // namespace puckloop::tools
