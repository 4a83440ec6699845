// From program words to operations: decoded when first reached, thrown away when the word changes.

#include "emu/dspic/machine/machine.h"

#include <fmt/format.h>

namespace puckloop::dspic {

namespace {

constexpr std::uint32_t kDebuggerBreak = 0xDA4000;
constexpr std::uint32_t kSimulatorStop = 0xDAC000;

/// Undefined encodings: the two words that debuggers plant run as NOP, every other one resets.
const Op* undefined(Machine& m, const Op* op) {
    if (op->word == kDebuggerBreak || op->word == kSimulatorStop) {
        warn_once(m, op->word, fmt::format("0x{:06X} (debugger stop) executed as NOP", op->word));
        return op + 1;
    }
    request_reset(m, ResetCause::IllegalOpcode);
    return op + 1;
}

/// Instruction fetch from the vector space or from where there is no flash.
const Op* bad_fetch(Machine& m, const Op* op) {
    raise_trap(m, Trap::AddressError);
    if (static_cast<std::uint32_t>(op - m.code) >= m.code_words) return at(m, m.pc_of(op) + 2);
    return op + 1;
}

void steps(std::uint32_t mode, int size, std::int8_t& pre, std::int8_t& post) {
    pre = post = 0;
    const auto step = static_cast<std::int8_t>(size);
    if (mode == 2) post = static_cast<std::int8_t>(-step);
    if (mode == 3) post = step;
    if (mode == 4) pre = static_cast<std::int8_t>(-step);
    if (mode == 5) pre = step;
}

const Op* run_loop_end(Machine& m, const Op* op) {
    const Op* next = op->base(m, op);
    CoreState& st = m.st;
    if (!(st.sr & sr::DA) || m.pc_of(op) != st.loop.doend || next != op + 1) return next;
    if (st.loop.dcount != 0 && !(st.corcon & corcon::EDT)) {
        --st.loop.dcount;
        return at(m, st.loop.dostart);
    }
    // The loop ends: one level up, the outer loop comes back from the shadow.
    st.corcon &= static_cast<std::uint16_t>(~corcon::EDT);
    const int level = (st.corcon & corcon::DL) >> corcon::kDlShift;
    if (level > 0) st.corcon = static_cast<std::uint16_t>(st.corcon - (1 << corcon::kDlShift));
    if (level <= 1) st.sr &= static_cast<std::uint16_t>(~sr::DA);
    st.loop = st.loop_shadow;
    return next;
}

/// A stop address: nothing happens here, the run loop takes over.
const Op* stop_here(Machine& m, const Op* op) {
    m.stopped = true;
    m.limit = 0;
    --m.instructions;
    return op;
}

}  // namespace

Ea bind_source(Op& op, const Form& form, std::uint32_t word, char mode, int size) {
    const std::uint32_t p = form.field(mode, word);
    op.s = static_cast<std::uint8_t>(form.field('s', word));
    if (p == 0) return op.source = Ea::Direct;
    op.uses |= 0x10001u << op.s;
    if (p >= 6) {
        op.uses |= 1u << op.b;
        return op.source = Ea::Offset;
    }
    steps(p, size, op.s_pre, op.s_post);
    return op.source = Ea::Indirect;
}

Ea bind_destination(Op& op, const Form& form, std::uint32_t word, char mode, int size) {
    const std::uint32_t q = form.field(mode, word);
    op.d = static_cast<std::uint8_t>(form.field('d', word));
    if (q == 0) {
        sets(op, op.d);
        return op.destination = Ea::Direct;
    }
    op.uses |= 0x10000u << op.d;
    if (q >= 6) return op.destination = Ea::Offset;
    steps(q, size, op.d_pre, op.d_post);
    if (q != 1) op.writes |= 1u << op.d;
    return op.destination = Ea::Indirect;
}

void decode(Machine& m, Op& op) {
    const auto index = static_cast<std::uint32_t>(&op - m.code);
    const std::uint32_t pc = index * 2;
    if (m.program_undo.on() && op.run == &decode_now) m.program_undo.note_operation(m, index);
    const std::uint8_t marks = op.marks;
    op = Op{};
    op.marks = marks;
    op.word = m.program[index];
    op.keep = 0xFFFF0000;
    op.base = &undefined;
    if (index >= m.code_words || (pc >= m.device.vectors_start && pc < m.device.vectors_end)) {
        op.base = &bad_fetch;
    } else if (const Form* form = find_form(op.word)) {
        op.form = form->id;
        op.cycles = form->cycles;
        op.psv_extra = form->psv_extra;
        op.byte = form->field('B', op.word) != 0;
        const std::uint32_t word2 = m.program[index + 1];
        if (!bind_alu(op, *form, op.word) && !bind_move(op, *form, op.word) &&
            !bind_bits(op, *form, op.word) && !bind_shift(op, *form, op.word) &&
            !bind_multiply(op, *form, op.word) && !bind_dsp(op, *form, op.word))
            bind_flow(op, *form, op.word, word2, pc);
        op.uses &= ~(0x10000u << 15);  // W15 is always set
    }
    op.run = op.marks & kLoopEnd ? &run_loop_end : op.base;
    if (op.marks & kStop) {
        op.run = &stop_here;
        op.uses = op.writes = 0;
        op.keep = 0xFFFFFFFF;
        op.cycles = 0;
    }
}

/// First visit: decode, then leave and come back to the finished operation. What the run loop adds for it
/// afterwards is taken off here.
const Op* decode_now(Machine& m, const Op* op) {
    if (op->word == kErasedWord)  // NOPR: silicon runs through to the end of flash, and into an address error
        warn_once(m, kErasedWord, "runs into erased flash");
    decode(m, m.code[op - m.code]);
    m.st.cycle -= op->cycles;
    --m.instructions;
    return op;
}

Op blank_operation(std::uint32_t word) {
    Op op;
    op.run = &decode_now;
    op.keep = 0xFFFFFFFF;
    op.cycles = 0;
    op.word = word;
    return op;
}

void blank(Machine& m, std::uint32_t index) {
    Op& op = m.code[index];
    const std::uint8_t marks = op.marks;
    op = blank_operation(m.program[index]);
    op.marks = marks;
    forget_blocks(m, index);
}

void invalidate(Machine& m, std::uint32_t address) {
    const auto forget = [&m](std::uint32_t index) {
        if (m.program_undo.on()) m.program_undo.note_operation(m, index);
        blank(m, index);
    };
    const std::uint32_t index = address >> 1;
    forget_loops(m);
    forget(index);
    if (index > 0) forget(index - 1);  // its second word may be this one
}

void renew_code(Machine& m) {
    m.pages.share();
    forget_all_blocks(m);
    forget_loops(m);
    for (const std::uint32_t pc : m.stops)
        mark(m, pc, kStop);
}

void mark(Machine& m, std::uint32_t pc, std::uint8_t what) {
    const std::uint32_t index = pc >> 1;
    if (index >= m.code_words) return;
    Op& op = m.code[index];
    if (op.marks & what) return;
    if (m.program_undo.on()) m.program_undo.note_operation(m, index);
    op.marks |= what;
    forget_blocks(m, index);
    forget_loops(m);
    if (op.run != &decode_now) decode(m, op);
}

}  // namespace puckloop::dspic
