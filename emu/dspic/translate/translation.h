#pragma once
// Execution by translated code: blocks are made where a program comes often (library.h), and entered.

namespace puckloop::dspic {

struct Machine;

/// Executes from Machine::current on while the cycle is below Machine::limit, exactly as the interpreter
/// would; RA is not set.
void run_translated(Machine& m);
}  // namespace puckloop::dspic
