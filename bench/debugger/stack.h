#pragma once
// Who called the function in which a chip is: found by looking for return addresses on its stack.

#include "bench/debugger/program.h"

#include <cstdint>
#include <vector>

namespace puckloop::exec::debugger {

struct Frame {
    std::uint32_t pc = 0;       ///< of the next instruction in this frame
    std::uint16_t stack = 0;    ///< stack pointer once what this frame called has returned
    bool interrupt = false;     ///< the routine of an interrupt: the frame after it called nothing
    std::uint32_t line_pc = 0;  ///< its line is the frame's: a call is followed by the next line's code
};

/// The innermost first, at most `most`. The images' debug information has no frames: a word on the stack
/// counts as a return address where the instruction before it is a call, of the function above it if the call
/// names one. What a function kept on the stack may look like one.
std::vector<Frame> backtrace(const debug::DebugChip& chip, const Program& program, std::size_t most);

/// `left` has more on the stack than `right`.
bool deeper(const debug::DebugChip& chip, std::uint16_t left, std::uint16_t right);

}  // namespace puckloop::exec::debugger
