#include "emu/avr/assembler/encoder.h"

#include "base/text/suggest.h"
#include "emu/assembly/text.h"
#include "emu/avr/isa/operands.h"

#include <fmt/format.h>

#include <charconv>
#include <optional>
#include <vector>

namespace puckloop::avr {

namespace {

using assembly::equal_ignoring_case;
using assembly::trim;

struct Instruction {
    std::string_view mnemonic;
    std::vector<std::string_view> operands;
};

Instruction parse(std::string_view text) {
    text = trim(text);
    const std::size_t end = std::min(text.find_first_of(" \t"), text.size());
    Instruction instruction{text.substr(0, end), {}};
    const std::string_view rest = trim(text.substr(end));
    if (!rest.empty()) instruction.operands = assembly::split_arguments(rest);
    return instruction;
}

std::vector<const Form*> forms_of(std::string_view mnemonic) {
    std::vector<const Form*> found;
    for (const Form& form : forms())
        if (equal_ignoring_case(form.mnemonic, mnemonic)) found.push_back(&form);
    if (!found.empty()) return found;
    std::vector<std::string_view> known;
    for (const Form& form : forms())
        known.push_back(form.mnemonic);
    const std::string near = nearest_name(mnemonic, known);
    throw EncodeError(fmt::format("unknown instruction \"{}\"", mnemonic),
                      near.empty() ? "an AVR instruction" : near + "?");
}

/// "Y+q" written as Y+1, with blanks or without: the displacement's expression.
std::optional<std::string_view> displacement(std::string_view text, char pointer) {
    if (text.size() < 2 || assembly::lower(text[0]) != assembly::lower(pointer)) return std::nullopt;
    const std::string_view rest = trim(text.substr(1));
    if (rest.size() < 2 || rest[0] != '+') return std::nullopt;
    return trim(rest.substr(1));
}

bool looks_like_pointer(std::string_view text) {
    if (text.starts_with('-')) text.remove_prefix(1);
    constexpr std::string_view kPointers = "xyzXYZ";
    return !text.empty() && kPointers.find(text[0]) != std::string_view::npos &&
           (text.size() == 1 || text[1] == '+' || text[1] == ' ');
}

/// Whether the operand can be one of this kind at all; ranges are checked when its value is known.
bool has_shape(const OperandSpec& operand, std::string_view text) {
    switch (operand.kind) {
    case OperandKind::Register:
    case OperandKind::SameRegister:
        return register_number(text) >= 0;
    case OperandKind::Pointer:
        return equal_ignoring_case(operand.text, text);
    case OperandKind::Displacement:
        return displacement(text, operand.letter).has_value();
    default:
        return register_number(text) < 0 && !looks_like_pointer(text);
    }
}

bool has_shape(const Form& form, const std::vector<std::string_view>& operands) {
    const auto specs = operands_of(form.id).list();
    if (specs.size() != operands.size()) return false;
    for (std::size_t i = 0; i < specs.size(); ++i)
        if (!has_shape(specs[i], operands[i])) return false;
    return true;
}

std::uint32_t in_range(std::string_view what, std::int64_t value, std::int64_t lowest, std::int64_t highest) {
    if (value < lowest || value > highest)
        throw EncodeError(fmt::format("{} {} does not fit", what, value),
                          fmt::format("{} to {}", lowest, highest));
    return static_cast<std::uint32_t>(value);
}

std::uint32_t register_field(const OperandSpec& operand, std::string_view text, int width) {
    const int number = register_number(text);
    const int last = operand.register_of((1u << width) - 1);
    if (number < operand.first || number > last || (number - operand.first) % operand.step != 0)
        throw EncodeError(fmt::format("{} cannot be used here", text),
                          operand.step == 2
                              ? fmt::format("an even register from r{} to r{}", operand.first, last)
                              : fmt::format("r{} to r{}", operand.first, last));
    return static_cast<std::uint32_t>((number - operand.first) / operand.step);
}

class Encoder {
  public:
    Encoder(const Form& form, std::uint32_t address, const assembly::SymbolValue& value_of)
        : form_(form), address_(address), value_of_(value_of) {}

    Encoded run(const std::vector<std::string_view>& operands) {
        words_ = {form_.pattern.value(), 0};
        const auto specs = operands_of(form_.id).list();
        for (std::size_t i = 0; i < specs.size(); ++i)
            put_operand(specs[i], operands[i]);
        return {words_, form_.two_words ? 2 : 1};
    }

  private:
    std::int64_t value(std::string_view text) const { return evaluate(text, address_, value_of_); }

    void put(char letter, std::uint32_t field) {
        if (form_.two_words) {
            words_[1] = static_cast<std::uint16_t>(words_[1] | form_.second.place(letter, field));
            field >>= form_.second.width(letter);
        }
        words_[0] = static_cast<std::uint16_t>(words_[0] | form_.pattern.place(letter, field));
    }

    void put_operand(const OperandSpec& operand, std::string_view text) {
        const char letter = operand.kind == OperandKind::Displacement ? 'q' : operand.letter;
        const int width = form_.width(letter);
        const std::int64_t highest = (std::int64_t{1} << width) - 1;
        switch (operand.kind) {
        case OperandKind::SameRegister:
            put('r', register_field(operand, text, width));
            [[fallthrough]];
        case OperandKind::Register:
            return put(letter, register_field(operand, text, width));
        case OperandKind::Constant:
            return put(letter, in_range("the constant", value(text), width == 8 ? -128 : 0, highest) & 0xFF);
        case OperandKind::Complement:
            return put(letter, ~in_range("the constant", value(text), 0, highest));
        case OperandKind::Bit:
            return put(letter, in_range("the bit", value(text), 0, highest));
        case OperandKind::Io:
            return put(letter, in_range("the I/O address", value(text), 0, highest));
        case OperandKind::Data:
            return put(letter, in_range("the data address", value(text), 0, highest));
        case OperandKind::Displacement:
            return put(letter,
                       in_range("the displacement", value(*displacement(text, operand.letter)), 0, highest));
        case OperandKind::Program:
            return put(letter, word_address(text, 2 * highest));
        case OperandKind::Relative:
            return put(letter, relative(text, width));
        case OperandKind::Pointer:
            return;
        }
    }

    std::uint32_t word_address(std::string_view text, std::int64_t highest) const {
        const std::int64_t target = value(text);
        if (target & 1)
            throw EncodeError(fmt::format("the target 0x{:x} is odd", target), "an even byte address");
        return in_range("the target", target, 0, highest) / 2;
    }

    /// The distance may run over either end of the program memory.
    std::uint32_t relative(std::string_view text, int width) const {
        constexpr std::int64_t kWords = kProgramBytes / 2;
        const std::int64_t reach = std::int64_t{1} << (width - 1);
        std::int64_t distance =
            static_cast<std::int64_t>(word_address(text, kProgramBytes - 2)) - (address_ / 2 + 1);
        if (distance < -kWords / 2) distance += kWords;
        if (distance >= kWords / 2) distance -= kWords;
        if (distance < -reach || distance >= reach)
            throw EncodeError(fmt::format("the target is {} words away", distance),
                              fmt::format("{} to {}", -reach, reach - 1));
        return static_cast<std::uint32_t>(distance);
    }

    const Form& form_;
    std::uint32_t address_;
    const assembly::SymbolValue& value_of_;
    std::array<std::uint16_t, 2> words_{};
};

std::optional<std::int64_t> apply(std::string_view name, std::int64_t value) {
    if (equal_ignoring_case(name, "lo8")) return value & 0xFF;
    if (equal_ignoring_case(name, "hi8")) return value >> 8 & 0xFF;
    if (equal_ignoring_case(name, "hh8")) return value >> 16 & 0xFF;
    if (equal_ignoring_case(name, "pm")) return value / 2;
    return std::nullopt;
}

}  // namespace

int register_number(std::string_view name) {
    constexpr std::string_view kHalves[] = {"xl", "xh", "yl", "yh", "zl", "zh"};
    for (int i = 0; i < 6; ++i)
        if (equal_ignoring_case(name, kHalves[i])) return 26 + i;
    if (name.size() < 2 || assembly::lower(name[0]) != 'r') return -1;
    int number = -1;
    const auto [end, error] = std::from_chars(name.data() + 1, name.data() + name.size(), number);
    const bool whole = error == std::errc{} && end == name.data() + name.size();
    return whole && number >= 0 && number < 32 ? number : -1;
}

std::int64_t evaluate(std::string_view text, std::uint32_t here, const assembly::SymbolValue& value_of) {
    constexpr auto is_register = [](std::string_view name) { return register_number(name) >= 0; };
    return assembly::evaluate(text, here, value_of, {is_register, &apply});
}

int size_of(std::string_view text) {
    const Instruction instruction = parse(text);
    return forms_of(instruction.mnemonic).front()->two_words ? 2 : 1;
}

Encoded encode(std::string_view text, std::uint32_t address, const assembly::SymbolValue& value_of) {
    const Instruction instruction = parse(text);
    const auto candidates = forms_of(instruction.mnemonic);
    for (const Form* form : candidates)
        if (has_shape(*form, instruction.operands))
            return Encoder(*form, address, value_of).run(instruction.operands);
    std::string expected;
    for (const Form* form : candidates) {
        if (!expected.empty()) expected += " or ";
        expected += fmt::format("{} {}", form->mnemonic, form->operands);
    }
    throw EncodeError(fmt::format("the operands of \"{}\" do not fit", trim(text)), expected);
}

}  // namespace puckloop::avr
