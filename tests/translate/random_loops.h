#pragma once
// Random programs that go round: hot code of every kind, with calls, hardware loops, skips, traps, an
// interrupt service routine, stack frames and pointers that mostly lead to RAM.

#include "base/random.h"
#include "emu/dspic/machine/isa.h"

#include <cstdint>
#include <map>

namespace puckloop::tests {

struct LoopProgram {
    static constexpr std::uint32_t kBody = 0x400, kBodyWords = 96;
    std::map<std::uint32_t, std::uint32_t> words;  ///< by program address
};

/// A form that goes on to the next word, if nothing is wrong with its operands, in one cycle.
bool is_plain(const dspic::Form& form);
/// Of the DSP class.
bool is_dsp(const dspic::Form& form);
/// A word of that form, with pointers that mostly lead to RAM if W8 to W12 do.
std::uint32_t random_word_of(RandomStream& random, const dspic::Form& form);
/// A word of a random form that is plain and not of the DSP class.
std::uint32_t random_plain_word(RandomStream& random);
/// A word for the body, at program address `pc`: mostly plain instructions, branches stay inside.
std::uint32_t random_word(RandomStream& random, std::uint32_t pc);
LoopProgram random_loops(RandomStream& random);

}  // namespace puckloop::tests
