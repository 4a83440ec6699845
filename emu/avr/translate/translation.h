#pragma once
// Execution by translated code: blocks are made where a program comes often (library.h), and entered.

namespace puckloop::avr {

struct Machine;

/// Executes from Machine::current on while the cycle is below Machine::limit, exactly as the interpreter
/// would. False: this host cannot, and nothing was executed.
bool run_translated(Machine& m);
}  // namespace puckloop::avr
