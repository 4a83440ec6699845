// `puckloop shell RUN`: drives a run of `run --control` by commands.

#include "tools/shell/shell.h"
#include "tools/cli/check.h"
#include "tools/cli/command.h"
#include "tools/commands.h"

#include <memory>
#include <string>

namespace puckloop::tools {

void declare_shell(Command& app, int& status) {
    auto folder = std::make_shared<std::string>();
    Command* command = app.add_subcommand("shell", "a run driven by commands, from a terminal or a script");
    command->add_option("folder", *folder, "results folder of a run that was started with --control")
        ->required()
        ->check(not_empty())
        ->type_name("DIR");
    command->footer("Commands come from the terminal or, as a script, from standard input; `help` lists them "
                    "(docs/view.md). `run --shell` begins both.\n\nExamples:\n"
                    "  puckloop run hello --control & puckloop shell out/hello\n"
                    "  puckloop run hello --shell <script.txt");
    command->callback([folder, &status] { status = run_shell(*folder); });
}

}  // namespace puckloop::tools
