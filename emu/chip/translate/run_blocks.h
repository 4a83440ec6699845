#pragma once
// The run loop over translated blocks and what they leave to the interpreter.
//
// `Family` is the chip family's part, with
//   Machine, Op             its core and a decoded operation
//   cycle(m)                its present cycle, a reference
//   may_enter(m)            whether blocks hold in the core's present state
//   block_at(m, index)      offset of the block at that program word, made if it is time; 0: none
//   enter(m, block)         executes from there on
//   execute(m, op)          what the interpreter does of one operation: the next one, or null if the run
//                           ends before it

#include "emu/chip/translate/left.h"

#include <cstdint>

namespace puckloop::chip {

/// Executes from Machine::current on while the cycle is below Machine::limit.
template <class Family>
void run_blocks(typename Family::Machine& m) {
    using Op = typename Family::Op;
    const auto& translated = m.translated;
    const Op* op = m.current;
    bool at_head = true;  // a block may begin here
    do {
        bool resumes = false;
        if (at_head && Family::may_enter(m)) {
            const auto index = static_cast<std::uint32_t>(op - m.code);
            if (const std::uint32_t block = index < translated.words ? Family::block_at(m, index) : 0) {
                const Left left = Family::enter(m, block);
                op = m.current;
                if (left == Left::NoEntry) continue;
                if (Family::cycle(m) >= m.limit) break;
                resumes = left == Left::Slow;
            } else {
                resumes = index < translated.words && translated.heat[index] == translated.kNever;
            }
        }
        const Op* const next = Family::execute(m, op);
        if (next == nullptr) break;
        at_head = resumes || next != op + 1;
        op = next;
    } while (Family::cycle(m) < m.limit);
    m.current = op;
}

}  // namespace puckloop::chip
