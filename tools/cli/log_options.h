#pragma once
// -v, --log-level and --log-file of the commands that do long work.

#include "tools/cli/command.h"

#include <string>

namespace puckloop::tools {

struct LogOptions {
    bool verbose = false;
    std::string level, file;
};

void declare_log_options(Command& command, LogOptions& options);

/// Begins this process's log as asked: -v means info, a file without a level too. Throws InputError.
void start_log(const std::string& name, const LogOptions& options);

}  // namespace puckloop::tools
