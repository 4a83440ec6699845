// From program words to operations: decoded when first reached, thrown away when the word changes.

#include "emu/avr/isa/operands.h"
#include "emu/avr/machine/execute/handlers.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace puckloop::avr {

namespace {

constexpr Handler kHandlers[] = {
#define FORM(id, ...) &execute::id,
#define ALIAS(...)
#define SYNONYM(...)
#include "emu/avr/isa/forms.inc"
#undef FORM
#undef ALIAS
#undef SYNONYM
};

constexpr std::uint16_t kIoOffset = 0x20;
constexpr std::uint32_t kStartedOver = 0x30000;  ///< key of the warning

/// A stop address: nothing happens here, the run loop takes over.
const Op* stop_here(Machine& m, const Op* op) {
    m.stopped = true;
    m.limit = 0;
    m.cycle -= op->cycles;
    --m.instructions;
    return op;
}

/// The first word of the application: coming here again without a reset is what avr-libc does at an interrupt
/// without a routine, and what a wild jump ends in.
const Op* first_word(Machine& m, const Op* op) {
    if (std::exchange(m.started, true) && !was_warned(m, kStartedOver)) {
        const std::string_view vector = m.last_vector < 0 ? "none" : m.device.vector_name(m.last_vector);
        warn_once(
            m, op, kStartedOver,
            fmt::format("the program starts over at 0 without a reset; the last interrupt was {}", vector));
    }
    return kHandlers[static_cast<std::size_t>(op->form)](m, op);
}

/// A backward branch: the instruction, then perhaps a skip.
template <Handler kInstruction>
const Op* loop_back(Machine& m, const Op* op) {
    const Op* next = kInstruction(m, op);
    if (next > op || !m.skip_idle) return next;
    LoopInfo& loop = m.loops[m.pc_of(op)];
    if (loop.wait == 0) return skip_iterations(m, op, next);
    --loop.wait;
    return next;
}

/// The handler of a short backward branch; null for any other operation.
Handler loop_handler_of(const Op& op, std::uint32_t index) {
    if (op.k > index || index - op.k >= kLongestLoop) return nullptr;
    switch (op.form) {
    case FormId::RJMP:
        return &loop_back<&execute::RJMP>;
    case FormId::BRBS:
        return &loop_back<&execute::BRBS>;
    case FormId::BRBC:
        return &loop_back<&execute::BRBC>;
    default:
        return nullptr;
    }
}

/// Puts one operand's number where the handlers look for it.
void bind(Op& op, const OperandSpec& operand, std::uint32_t field, std::uint32_t here, int width) {
    switch (operand.kind) {
    case OperandKind::Register:
        (operand.letter == 'd' ? op.d : op.r) = operand.register_of(field);
        break;
    case OperandKind::Bit:
        op.b = static_cast<std::uint8_t>(1u << field);
        break;
    case OperandKind::Io:
        op.k = static_cast<std::uint16_t>(kIoOffset + field);
        break;
    case OperandKind::Relative:
        op.k = static_cast<std::uint16_t>(relative_target(here, field, width));
        break;
    case OperandKind::Constant:
    case OperandKind::Program:
    case OperandKind::Data:
    case OperandKind::Displacement:
        op.k = static_cast<std::uint16_t>(field);
        break;
    case OperandKind::Pointer:
    case OperandKind::SameRegister:  // only in spellings
    case OperandKind::Complement:
        break;
    }
}

}  // namespace

void decode(Machine& m, Op& op) {
    const auto index = static_cast<std::uint32_t>(&op - m.code);
    const std::uint16_t word = m.program[index];
    op = Op{};
    op.cycles = 1;
    op.run = &execute::undefined;
    if (const Form* form = find_form(word)) {
        op.form = form->id;
        op.run = kHandlers[static_cast<std::size_t>(form->id)];
        op.cycles = form->cycles;
        if (form->extra == Extra::Skip)
            op.skip = static_cast<std::uint8_t>(1 + length_of(m.program[index + 1]));
        for (const OperandSpec& operand : operands_of(form->id).list()) {
            const char letter = operand.kind == OperandKind::Displacement ? 'q' : operand.letter;
            bind(op, operand, form->field(letter, word, m.program[index + 1]), index, form->width(letter));
        }
    }
    if (const Handler loop = loop_handler_of(op, index))
        op.run = loop;
    else if (index == 0 && op.form != FormId::Undefined)
        op.run = &first_word;
    if (std::find(m.stops.begin(), m.stops.end(), index) != m.stops.end()) {
        op.run = &stop_here;
        op.form = FormId::Undefined;  // nobody looks ahead over it
    }
}

/// First visit: decode, then leave and come back to the finished operation. What the run loop adds for it
/// afterwards is taken off here.
const Op* decode_now(Machine& m, const Op* op) {
    decode(m, m.code_store[static_cast<std::size_t>(op - m.code)]);
    m.cycle -= op->cycles;
    --m.instructions;
    return op;
}

void forget(Machine& m, std::uint32_t address) {
    // Every loop that may hold this word.
    const std::uint32_t last = std::min(address + kLongestLoop, m.device.flash_words);
    std::fill(m.loops.begin() + address, m.loops.begin() + last, LoopInfo{});
    const auto forget_one = [&m](std::uint32_t index) {
        Op& op = m.code_store[index];
        op = Op{};
        op.run = &decode_now;
    };
    forget_one(address);
    if (address > 0) forget_one(address - 1);  // a pair's first word, or a skip over this one
    forget_blocks(m, address);
}

}  // namespace puckloop::avr
