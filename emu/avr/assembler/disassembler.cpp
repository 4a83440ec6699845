#include "emu/avr/assembler/disassembler.h"

#include "emu/avr/isa/operands.h"

#include <fmt/format.h>

#include <iterator>

namespace puckloop::avr {

namespace {

std::string address_text(std::uint32_t byte_address, const LabelOf& label_of) {
    std::string name = label_of ? label_of(byte_address) : std::string{};
    return name.empty() ? fmt::format("0x{:x}", byte_address) : name;
}

std::string operand_text(const OperandSpec& operand, std::uint32_t field, int width, std::uint32_t address,
                         const LabelOf& label_of) {
    switch (operand.kind) {
    case OperandKind::Register:
    case OperandKind::SameRegister:
        return fmt::format("r{}", operand.register_of(field));
    case OperandKind::Constant:
    case OperandKind::Io:
        return fmt::format("0x{:02x}", field);
    case OperandKind::Complement:
        return fmt::format("0x{:02x}", ~field & 0xFF);
    case OperandKind::Bit:
        return fmt::format("{}", field);
    case OperandKind::Program:
        return address_text(2 * field, label_of);
    case OperandKind::Relative:
        return address_text(2 * relative_target(address / 2, field, width), label_of);
    case OperandKind::Data:
        return fmt::format("0x{:04x}", field);
    case OperandKind::Pointer:
        return std::string(operand.text);
    case OperandKind::Displacement:
        return fmt::format("{}+{}", operand.letter, field);
    }
    return "?";
}

}  // namespace

Disassembled disassemble(std::uint16_t word, std::uint16_t next, bool has_next, std::uint32_t address,
                         const LabelOf& label_of) {
    const Form* form = find_spelling(word);
    if (!form || (form->two_words && !has_next)) return {fmt::format(".word 0x{:04x}", word), 1};
    Disassembled result{std::string(form->mnemonic), form->two_words ? 2 : 1};
    const char* separator = " ";
    for (const OperandSpec& operand : operands_of(form->id).list()) {
        const char letter = operand.kind == OperandKind::Displacement ? 'q' : operand.letter;
        result.text += separator;
        result.text +=
            operand_text(operand, form->field(letter, word, next), form->width(letter), address, label_of);
        separator = ", ";
    }
    return result;
}

}  // namespace puckloop::avr
