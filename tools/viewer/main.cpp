// puckloop-view: what `puckloop view` becomes.

#include "tools/cli/command_program.h"
#include "tools/viewer/view.h"

int main(int argc, char** argv) {
    using namespace puckloop::tools;
    return command_program<declare_view>(argc, argv);
}
