// puckloop-chips: what `puckloop exec`, `debug`, `dap`, `step`, `asm`, `disasm` or `upload` becomes.

#include "tools/chips/chips.h"
#include "tools/cli/command_program.h"

int main(int argc, char** argv) {
    using namespace puckloop::tools;
    return command_program<declare_exec, declare_debug, declare_dap, declare_step, declare_asm,
                           declare_disasm, declare_upload>(argc, argv);
}
