// puckloop step: single-instruction vectors, one a line on stdin, answers on stdout in the same order.

#include "base/error.h"
#include "emu/dspic/step_vector.h"
#include "tools/cli/command.h"
#include "tools/commands.h"

#include <iostream>
#include <string>

namespace puckloop::tools {

void declare_step(Command& app, int& status) {
    static std::string mcu;
    Command* command = app.add_subcommand("step", "Run single-instruction vectors from stdin");
    command->add_option("--mcu", mcu, "The chip, e.g. dspic30f6014a")->required();
    command->callback([&status] {
        const dspic::DeviceInfo* device = dspic::find_device(mcu);
        if (!device) throw InputError("", "--mcu", "no such chip: " + mcu, dspic::device_names());
        std::ios::sync_with_stdio(false);
        dspic::StepMachine machine(*device);
        for (std::string line; std::getline(std::cin, line);) {
            if (line.empty()) continue;
            std::cout << machine.answer(line) << '\n';
        }
        std::cout.flush();
        if (!std::cout) throw RunError("standard output: cannot write");
        status = 0;
    });
}

}  // namespace puckloop::tools
