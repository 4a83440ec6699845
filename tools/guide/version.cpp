// `puckloop version`, and the lines of the list that are handled elsewhere: `help` (tools/cli), `test` (the
// launcher of the sources).

#include "base/version/version.h"
#include "base/error.h"
#include "base/json.h"
#include "tools/cli/command.h"
#include "tools/guide/guide.h"

#include <fmt/format.h>

#include <memory>
#include <string>
#include <vector>

namespace puckloop::tools {

void declare_version(Command& app, int& status) {
    auto json = std::make_shared<bool>(false);
    Command* command = app.add_subcommand("version", "version and commit of this build");
    command->add_flag("--json", *json, "print one JSON object");
    command->callback([json, &status] {
        const Version& version = program_version();
        if (*json)
            fmt::print("{}\n", nlohmann::ordered_json{{"version", version.number},
                                                      {"commit", version.commit},
                                                      {"modified", version.modified}}
                                   .dump());
        else
            fmt::print("puckloop {}\n", version_text());
        status = 0;
    });
}

void declare_help(Command& app, int& status) {
    auto words = std::make_shared<std::vector<std::string>>();
    Command* command = app.add_subcommand("help", "what a command does, with its options");
    command->add_option("command", *words, "its name, such as run or \"trace decode\"")->type_name("COMMAND");
    command->callback(
        [&status] { status = 0; });  // tools/cli/program.cpp turns the words round before they get here
}

void declare_test(Command& app, int&) {
    Command* command =
        app.add_subcommand("test", "build and run everything the project checks (./puckloop of the sources)");
    auto words = std::make_shared<std::vector<std::string>>();
    command->add_option("options", *words, "options of ctest")->type_name("OPTION");
    command->callback([] {
        throw InputError("", "test", "this program does not build itself", "./puckloop test, in the sources");
    });
}

}  // namespace puckloop::tools
