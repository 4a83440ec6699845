// `puckloop debug` and `puckloop dap`: the debugger for a person, and for an editor.

#include "bench/debugger/console.h"
#include "bench/debugger/dap_server.h"
#include "tools/chips/chips.h"
#include "tools/cli/check.h"
#include "tools/cli/command.h"
#include "tools/cli/other_programs.h"
#include "tools/cli/time_check.h"
#include "tools/files/scenario_name.h"

#include <memory>

namespace puckloop::tools {

namespace {

using exec::debugger::DebuggerOptions;

constexpr double kLongestDebugged = 1e6;  // seconds

}  // namespace

void declare_debug(Command& app, int& status) {
    auto options = std::make_shared<DebuggerOptions>();
    Command* command = app.add_subcommand("debug", about("debug"));
    exec::ExecOptions& o = options->exec;
    command
        ->add_option("IMAGE", o.image,
                     "firmware: ELF (XC16, avr-gcc) or COFF (C30) for names and lines; Intel HEX")
        ->required();
    auto* mcu = command->add_option("--mcu", o.bench.mcu,
                                    "the chip alone: dspic30f6014a, dspic33fj256gp710 or atmega1284p");
    command
        ->add_option("--board", o.bench.board,
                     "the chip on its board: pic, rab or tam (default: by the image)")
        ->excludes(mcu);
    command->add_option("--sources", options->sources, "folder with source files; repeatable")
        ->allow_extra_args(false)
        ->type_name("DIR");
    command
        ->add_option("--seconds", o.seconds,
                     "the run ends there, in simulated time (without it never; of a script after 60)")
        ->check(seconds_between(0.0, kLongestDebugged))
        ->type_name("TIME");
    command->add_option("--uart1", o.uart[0], "pty, tcp:PORT (on 127.0.0.1) or script:FILE");
    command->add_option("--uart2", o.uart[1], "the same for the second UART");
    command->add_option("--stimulus", o.stimulus, "FILE of `<time_s> <signal> <value>`");
    command->footer("Commands come from the terminal or, as a script, from standard input; `help` lists them "
                    "(docs/debugger.md).\n\nExamples:\n"
                    "  puckloop debug firmware.elf --sources src\n"
                    "  puckloop debug --mcu atmega1284p lamp.elf <script.txt");
    command->callback([options, &status] {
        options->exec.image = image_named(options->exec.image);
        exec::debugger::complete_options(*options);
        status = exec::debugger::run_debugger(*options);
    });
}

void declare_dap(Command& app, int& status) {
    Command* command = app.add_subcommand("dap", about("dap"));
    command->footer(
        "It serves one session of the Debug Adapter Protocol; `launch` takes program, board or mcu, sources, "
        "stopOnEntry (docs/debugger.md).");
    command->callback([&status] { status = exec::debugger::serve_dap(0, 1); });
}

}  // namespace puckloop::tools
