#pragma once
// Where a program waits: the loop that it has been going round in, at each CPU level, and since when.
//
// Every taken short backward branch is an arrival. A stay in a loop ends when another loop at the same depth
// of the stack comes round, when nothing came round for half a second (of the loops behind it: its arrivals
// are counted through calls and interrupts), at a reset, and, for a routine, when the program below it goes
// on. A program that leaves a loop and is back in it within half a second without passing another loop counts
// as having stayed: whoever states that a stay is a hang shows that it cannot have left (judge.h).

#include "emu/dspic/machine/stays.h"

#include <cstdint>

namespace puckloop::dspic {

struct Machine;
struct Op;

/// Sets WaitWatch::stale_after by the clock's present rate.
void note_rate(Machine& m);
/// A taken backward branch.
struct Arrival {
    const Op* branch = nullptr;
    const Op* head = nullptr;
    std::uint16_t stack = 0;  ///< W15
    int level = 0;            ///< of the CPU
    Cycle now = 0;            ///< start of the branch
};
/// Before anything is skipped; the machine is at the branch wherever needs_look().
void note_arrival(Machine& m, const Arrival& arrival);
void note_arrival(Machine& m, const Op* branch, const Op* head);
/// The arrival is one at which the loop is looked at.
bool needs_look(const Machine& m, const Arrival& arrival);
/// After a skip at `branch`: the loop came round all the time.
void note_skip(Machine& m, const Op* branch);
/// At the first skip of iterations of a loop: whether it polls what no model drives.
void note_polls(Machine& m, const Op* branch, const Op* head);
/// The stay at the highest level that still lasts and was looked at; null if there is none.
const WaitWatch::Stay* present_stay(const Machine& m, int& level);

}  // namespace puckloop::dspic
