// The command line: a table of subcommands and one place where failures become exit statuses.

#include "base/error.h"
#include "tools/command.h"
#include "tools/commands.h"
#include "tools/run/linux_arguments.h"

#include <CLI/CLI.hpp>

#include <algorithm>
#include <cstdio>
#include <exception>
#include <string>
#include <vector>

int main(int argc, char** argv) {
    using namespace puckloop;
    CLI::App app{"puckloop: real robot firmware, without the robot"};
    app.name("puckloop");
    app.require_subcommand(1);
    app.set_version_flag("--version", "puckloop 0.1.0");
    int status = 0;
    for (const tools::DeclareCommand declare : tools::kCommands)
        declare(app, status);
    try {
        std::vector<std::string> words = tools::pack_linux_arguments({argv + 1, argv + argc});
        std::reverse(words.begin(), words.end());  // CLI11 takes them last first
        app.parse(words);
        return status;
    } catch (const CLI::ParseError& error) {
        const int code = app.exit(error);
        return code == 0 ? 0 : 2;
    } catch (const InputError& error) {
        std::fprintf(stderr, "puckloop: %s\n", error.what());
        return 2;
    } catch (const RunError& error) {
        std::fprintf(stderr, "puckloop: %s\n", error.what());
        return 1;
    } catch (const std::exception& error) {
        std::fprintf(stderr, "puckloop: internal error: %s\n", error.what());
        return 1;
    }
}
