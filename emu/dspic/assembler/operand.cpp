#include "emu/dspic/assembler/operand.h"

#include "emu/dspic/assembler/codec.h"

#include <optional>

namespace puckloop::dspic {

namespace {

using Shape = Operand::Shape;

char lower(char c) {
    return c >= 'A' && c <= 'Z' ? static_cast<char>(c + ('a' - 'A')) : c;
}

/// Takes a W register off the front of `text`.
std::optional<std::uint8_t> take_register(std::string_view& text) {
    text = trim(text);
    std::size_t length = 0;
    while (length < text.size() && length < 4 &&
           (lower(text[length]) == 'w' || (text[length] >= '0' && text[length] <= '9')))
        ++length;
    const int number = register_number(text.substr(0, length));
    if (number < 0) return std::nullopt;
    text = trim(text.substr(length));
    return static_cast<std::uint8_t>(number);
}

bool take(std::string_view& text, std::string_view token) {
    if (!text.starts_with(token)) return false;
    text = trim(text.substr(token.size()));
    return true;
}

/// The inside of [...]: sets mode, registers, offset.
bool parse_indirect(std::string_view inside, Operand& operand) {
    operand.shape = Shape::Register;
    operand.mode = kModeIndirect;
    if (take(inside, "++"))
        operand.mode = kModePreIncrement;
    else if (take(inside, "--"))
        operand.mode = kModePreDecrement;
    const auto base = take_register(inside);
    if (!base) return false;
    operand.number = *base;
    if (inside.empty()) return true;
    if (operand.mode != kModeIndirect) return false;
    if (inside == "++" || inside == "--") {
        operand.mode = static_cast<std::uint8_t>(inside == "++" ? kModePostIncrement : kModePostDecrement);
        return true;
    }
    operand.negative = inside[0] == '-';
    if (!take(inside, "+") && !take(inside, "-")) return false;
    std::string_view rest = inside;
    if (const auto offset = take_register(rest); offset && rest.empty()) {
        operand.shape = Shape::RegisterOffset;
        operand.second = *offset;
        operand.mode = kModeRegisterOffset;
        return !operand.negative;
    }
    take(inside, "#");
    operand.shape = Shape::LiteralOffset;
    operand.expression = inside;
    return !inside.empty();
}

bool parse_bracketed(std::string_view text, Operand& operand) {
    const std::size_t close = text.find(']');
    if (close == std::string_view::npos) return false;
    if (!parse_indirect(trim(text.substr(1, close - 1)), operand)) return false;
    std::string_view rest = trim(text.substr(close + 1));
    if (rest.empty()) return true;
    if (operand.shape != Shape::Register || operand.mode != kModeIndirect) return false;
    const bool negative = rest.starts_with("-=");
    if (!take(rest, "+=") && !take(rest, "-=")) return false;
    if (rest != "2" && rest != "4" && rest != "6") return false;
    operand.shape = Shape::Stepped;
    operand.step = static_cast<std::int8_t>(negative ? '0' - rest[0] : rest[0] - '0');
    return true;
}

}  // namespace

int register_number(std::string_view name) {
    if (name.size() < 2 || name.size() > 3 || lower(name[0]) != 'w') return -1;
    int number = 0;
    for (const char c : name.substr(1)) {
        if (c < '0' || c > '9') return -1;
        number = number * 10 + (c - '0');
    }
    return number > 15 || (name.size() == 3 && number < 10) ? -1 : number;
}

bool is_reserved_name(std::string_view name) {
    return register_number(name) >= 0 || equal_ignoring_case(name, "wreg") ||
           equal_ignoring_case(name, "a") || equal_ignoring_case(name, "b");
}

bool parse_operand(std::string_view text, Operand& operand, std::string& problem) {
    text = trim(text);
    operand = Operand{};
    operand.text = text;
    if (text.empty()) {
        problem = "an operand is missing";
        return false;
    }
    if (text[0] == '#') {
        operand.shape = Shape::Literal;
        operand.expression = trim(text.substr(1));
        if (!operand.expression.empty()) return true;
        problem = "a literal without a number";
        return false;
    }
    if (text[0] == '[') {
        if (parse_bracketed(text, operand)) return true;
        problem = "cannot read the address \"" + std::string(text) + "\"";
        return false;
    }
    if (const int number = register_number(text); number >= 0) {
        operand.shape = Shape::Register;
        operand.number = static_cast<std::uint8_t>(number);
        return true;
    }
    if (text.size() == 1 && (lower(text[0]) == 'a' || lower(text[0]) == 'b')) {
        operand.shape = Shape::Accumulator;
        operand.number = lower(text[0]) == 'b';
        return true;
    }
    if (equal_ignoring_case(text, "wreg")) {
        operand.shape = Shape::Wreg;
        return true;
    }
    if (const std::size_t star = lower(text[0]) == 'w' ? text.find('*') : std::string_view::npos;
        star != std::string_view::npos) {
        const int first = register_number(trim(text.substr(0, star)));
        const int second = register_number(trim(text.substr(star + 1)));
        if (first >= 0 && second >= 0) {
            operand.shape = Shape::Product;
            operand.number = static_cast<std::uint8_t>(first);
            operand.second = static_cast<std::uint8_t>(second);
            return true;
        }
    }
    operand.shape = Shape::Expression;
    operand.expression = text;
    return true;
}

}  // namespace puckloop::dspic
