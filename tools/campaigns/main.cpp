// puckloop-campaigns: what `puckloop faults` or `experiment` becomes.

#include "tools/campaigns/campaigns.h"
#include "tools/cli/command_program.h"

int main(int argc, char** argv) {
    using namespace puckloop::tools;
    return command_program<declare_faults, declare_experiment>(argc, argv);
}
