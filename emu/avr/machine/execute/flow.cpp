// Jumps, calls, returns, branches, skips and the control instructions.

#include "emu/avr/machine/execute/handlers.h"

#include <fmt/format.h>

namespace puckloop::avr::execute {

namespace {

const Op* target(const Machine& m, const Op* op) {
    return m.code + op->k;
}

const Op* call(Machine& m, const Op* op, const Op* routine, int words) {
    push_pc(m, op, static_cast<std::uint32_t>(m.pc_of(op)) + static_cast<std::uint32_t>(words));
    return routine;
}

const Op* return_address(Machine& m, const Op* op) {
    const std::uint8_t high = pop(m, op);
    const std::uint8_t low = pop(m, op);
    return m.code + (high << 8 | low);
}

const Op* branch_if(bool taken, Machine& m, const Op* op) {
    if (!taken) return op + 1;
    ++m.cycle;
    return target(m, op);
}

const Op* skip_if(bool skipped, Machine& m, const Op* op) {
    if (!skipped) return op + 1;
    m.cycle += op->skip - 1u;
    return op + op->skip;
}

}  // namespace

const Op* RJMP(Machine& m, const Op* op) {
    return target(m, op);
}
const Op* JMP(Machine& m, const Op* op) {
    return target(m, op);
}
const Op* IJMP(Machine& m, const Op*) {
    return m.code + pair(m, kZ);
}
const Op* RCALL(Machine& m, const Op* op) {
    return call(m, op, target(m, op), 1);
}
const Op* CALL(Machine& m, const Op* op) {
    return call(m, op, target(m, op), 2);
}
const Op* ICALL(Machine& m, const Op* op) {
    return call(m, op, m.code + pair(m, kZ), 1);
}
const Op* RET(Machine& m, const Op* op) {
    return return_address(m, op);
}
const Op* RETI(Machine& m, const Op* op) {
    const Op* next = return_address(m, op);
    write_sreg(m, op, m.sreg | sreg::I);
    m.hold_at = m.cycle + op->cycles;  // one more instruction of the main program, I set before or not
    return next;
}

const Op* BRBS(Machine& m, const Op* op) {
    return branch_if(m.sreg & op->b, m, op);
}
const Op* BRBC(Machine& m, const Op* op) {
    return branch_if(!(m.sreg & op->b), m, op);
}

const Op* CPSE(Machine& m, const Op* op) {
    return skip_if(rd(m, op) == rr(m, op), m, op);
}
const Op* SBRC(Machine& m, const Op* op) {
    return skip_if(!(rr(m, op) & op->b), m, op);
}
const Op* SBRS(Machine& m, const Op* op) {
    return skip_if(rr(m, op) & op->b, m, op);
}
const Op* SBIC(Machine& m, const Op* op) {
    return skip_if(!(load(m, op, op->k) & op->b), m, op);
}
const Op* SBIS(Machine& m, const Op* op) {
    return skip_if(load(m, op, op->k) & op->b, m, op);
}

const Op* NOP(Machine&, const Op* op) {
    return op + 1;
}
/// No debugger is connected: the data sheet's NOP.
const Op* BREAK(Machine&, const Op* op) {
    return op + 1;
}
const Op* SLEEP(Machine& m, const Op* op) {
    m.current = op;
    m.now = m.cycle;
    m.now = m.cycle;
    if (m.hooks.sleep) m.hooks.sleep();
    constexpr std::uint32_t kForGood = 0x30001;  // key of the warning
    if (m.asleep && !(m.sreg & sreg::I))
        warn_once(m, op, kForGood, "sleeps with interrupts off: only a reset ends it");
    return op + 1;
}
const Op* WDR(Machine& m, const Op* op) {
    m.current = op;
    m.now = m.cycle;
    if (m.hooks.watchdog_reset) m.hooks.watchdog_reset();
    return op + 1;
}

const Op* undefined(Machine& m, const Op* op) {
    const std::uint16_t word = m.program[m.pc_of(op)];
    if (word == kErasedWord)
        warn_once(m, op, word, "runs into erased flash, which counts as NOPs");
    else
        warn_once(m, op, word, fmt::format("undefined word 0x{:04X} executed as NOP", word));
    return op + 1;
}

}  // namespace puckloop::avr::execute
