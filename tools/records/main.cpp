// puckloop-records: what `puckloop replay`, `trace` or `frames` becomes.

#include "tools/cli/command_program.h"
#include "tools/records/records.h"

int main(int argc, char** argv) {
    using namespace puckloop::tools;
    return command_program<declare_replay, declare_trace, declare_frames>(argc, argv);
}
