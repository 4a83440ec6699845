#include "tools/cli/file_size_limit.h"

#include <csignal>

namespace puckloop::tools {

void survive_file_size_limit() {
    struct sigaction action {};
    if (sigaction(SIGXFSZ, nullptr, &action) != 0 || action.sa_handler == SIG_IGN) return;
    action = {};
    // A handler and not SIG_IGN, which programs that are executed would inherit.
    action.sa_handler = [](int) {};
    action.sa_flags = SA_RESTART;
    sigaction(SIGXFSZ, &action, nullptr);
}

}  // namespace puckloop::tools
