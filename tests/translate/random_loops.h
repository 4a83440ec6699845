#pragma once
// Random programs that go round: hot code of every kind, with calls, hardware loops, skips, traps, an
// interrupt service routine, stack frames and pointers that mostly lead to RAM.

#include "base/random.h"

#include <cstdint>
#include <map>

namespace puckloop::tests {

struct LoopProgram {
    static constexpr std::uint32_t kBody = 0x400, kBodyWords = 96;
    std::map<std::uint32_t, std::uint32_t> words;  ///< by program address
};

/// A word for the body, at program address `pc`: mostly plain instructions, branches stay inside.
std::uint32_t random_word(RandomStream& random, std::uint32_t pc);
LoopProgram random_loops(RandomStream& random);

}  // namespace puckloop::tests
