#include "emu/dspic/skip_loops.h"
#include "emu/dspic/machine.h"
namespace puckloop::dspic {
void try_skip(Machine&, const Op*, const Op*) {}
}  // namespace puckloop::dspic
