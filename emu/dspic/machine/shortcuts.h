#pragma once
// What the machine asks of the rooms above it that save executing instructions one by one. They know the
// machine; of them it knows these calls. What they keep lies in Machine, by value where translated code
// reaches it, behind a pointer else.

#include <cstdint>

namespace puckloop::dspic {

struct Machine;
struct Op;

// fast/idle_loops.cpp
/// At a taken backward branch: leaps over iterations of a pure loop if it can.
void try_skip(Machine& m, const Op* branch, const Op* head);
/// Code, marks or pointer rules changed: nothing known about loops holds any more.
void forget_loops(Machine& m);
// translate/translation.cpp
/// The operation at this program word changed: blocks that rest on it are not entered any more.
void forget_blocks(Machine& m, std::uint32_t index);
void forget_all_blocks(Machine& m);

}  // namespace puckloop::dspic
