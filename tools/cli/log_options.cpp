#include "tools/cli/log_options.h"

#include "base/logs/log.h"

namespace puckloop::tools {

void declare_log_options(Command& command, LogOptions& options) {
    command.add_flag("-v,--verbose", options.verbose,
                     "say on standard error what is done: processes, files, timings (--log-level info)");
    command
        .add_option("--log-level", options.level,
                    "how much is said: trace, debug, info, warning, error or off (off)")
        ->type_name("LEVEL");
    command
        .add_option("--log-file", options.file, "append it to this file instead (info, if no level is given)")
        ->type_name("FILE")
        ->check(not_empty());
}

void start_log(const std::string& name, const LogOptions& options) {
    log::Settings settings;
    settings.file = options.file;
    if (options.verbose || !options.file.empty()) settings.level = log::Level::Info;
    if (!options.level.empty()) settings.level = log::level_named(options.level);
    log::start(name, settings);
}

}  // namespace puckloop::tools
