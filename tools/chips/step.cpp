// puckloop step: single-instruction vectors, one a line on stdin, answers on stdout in the same order.

#include "base/error.h"
#include "emu/avr/core/step_vector.h"
#include "emu/dspic/core/step_vector.h"
#include "tools/chips/chips.h"
#include "tools/cli/command.h"
#include "tools/cli/other_programs.h"

#include <iostream>
#include <string>

namespace puckloop::tools {

namespace {

template <class StepMachine>
void answer_lines(StepMachine machine) {
    std::ios::sync_with_stdio(false);
    for (std::string line; std::getline(std::cin, line);) {
        if (line.empty()) continue;
        std::cout << machine.answer(line) << '\n';
    }
    std::cout.flush();
    if (!std::cout) throw RunError("standard output: cannot write");
}

}  // namespace

void declare_step(Command& app, int& status) {
    static std::string mcu;
    Command* command = app.add_subcommand("step", about("step"));
    command->add_option("--mcu", mcu, "The chip, e.g. dspic30f6014a or atmega1284p")->required();
    command->callback([&status] {
        if (const dspic::DeviceInfo* device = dspic::find_device(mcu))
            answer_lines(dspic::StepMachine(*device));
        else if (const avr::DeviceInfo* part = avr::find_device(mcu))
            answer_lines(avr::StepMachine(*part));
        else
            throw InputError("", "--mcu", "no such chip: " + mcu,
                             dspic::device_names() + ", " + avr::device_names());
        status = 0;
    });
}

}  // namespace puckloop::tools
