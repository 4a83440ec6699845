#pragma once
// What the machine asks of the rooms above it that save executing instructions one by one. They know the
// machine; of them it knows these calls.

#include <cstdint>

namespace puckloop::avr {

struct Machine;
struct Op;

// fast/idle_loops.cpp
/// At a taken backward branch: leaps over turns of an idle loop if it can. The operation to execute next.
const Op* skip_iterations(Machine& m, const Op* branch, const Op* head);
// translate/translation.cpp
/// The operation at this program word changed: blocks that rest on it are not entered any more.
void forget_blocks(Machine& m, std::uint32_t index);

}  // namespace puckloop::avr
