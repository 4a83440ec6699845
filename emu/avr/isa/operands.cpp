#include "emu/avr/isa/operands.h"

#include <stdexcept>
#include <string>
#include <vector>

namespace puckloop::avr {

namespace {

/// Rd, Rr and what follows the letter: h r16..r31, m r16..r23, p pairs, w the four word registers.
OperandSpec parse_register(std::string_view text) {
    OperandSpec spec{OperandKind::Register, text[1], 0, 1, text};
    switch (text.size() > 2 ? text[2] : ' ') {
    case 'h':
    case 'm':
        spec.first = 16;
        break;
    case 'p':
        spec.step = 2;
        break;
    case 'w':
        spec.first = 24;
        spec.step = 2;
        break;
    default:
        break;
    }
    return spec;
}

OperandSpec parse_operand(std::string_view text) {
    using enum OperandKind;
    if (text == "Rd=Rr") return {SameRegister, 'd', 0, 1, text};
    if (text[0] == 'R') return parse_register(text);
    if (text == "K") return {Constant, 'K', 0, 1, text};
    if (text == "~K") return {Complement, 'K', 0, 1, text};
    if (text == "b" || text == "s") return {Bit, text[0], 0, 1, text};
    if (text == "A") return {Io, 'A', 0, 1, text};
    if (text == "k") return {Program, 'k', 0, 1, text};
    if (text == ".k") return {Relative, 'k', 0, 1, text};
    if (text == "@k") return {Data, 'k', 0, 1, text};
    if (text.ends_with("+q")) return {Displacement, text[0], 0, 1, text};
    if (text.find_first_not_of("XYZ+-") == std::string_view::npos)
        return {Pointer, text[text.front() == '-'], 0, 1, text};
    throw std::logic_error("forms.inc: operand not understood: " + std::string(text));
}

OperandList parse_operands(std::string_view text) {
    OperandList operands;
    while (!text.empty()) {
        const auto comma = text.find(',');
        operands.items.at(operands.count++) = parse_operand(text.substr(0, comma));
        text.remove_prefix(comma == std::string_view::npos ? text.size() : comma + 1);
    }
    return operands;
}

}  // namespace

const OperandList& operands_of(FormId id) {
    static const std::vector<OperandList> all = [] {
        std::vector<OperandList> lists;
        for (const Form& form : forms())
            lists.push_back(parse_operands(form.operands));
        return lists;
    }();
    return all[static_cast<std::size_t>(id)];
}

}  // namespace puckloop::avr
