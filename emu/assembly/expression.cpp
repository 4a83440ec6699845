#include "emu/assembly/expression.h"

#include "emu/assembly/text.h"

#include <charconv>

namespace puckloop::assembly {

namespace {

constexpr std::int64_t kLargestNumber = 0xFFFFFFFF;
constexpr int kDeepest = 200;

class Parser {
  public:
    Parser(std::string_view text, std::uint32_t here, const SymbolValue& value_of, const Dialect& dialect)
        : text_(text), here_(here), value_of_(value_of), dialect_(dialect) {}

    std::int64_t whole() {
        const std::int64_t value = binary(0);
        if (peek() != '\0') fail("cannot read \"" + std::string(text_.substr(position_)) + "\"");
        return value;
    }

  private:
    [[noreturn]] static void fail(const std::string& what) { throw ExpressionError(what); }

    char peek() {
        while (position_ < text_.size() && (text_[position_] == ' ' || text_[position_] == '\t'))
            ++position_;
        return position_ < text_.size() ? text_[position_] : '\0';
    }

    bool take(std::string_view token) {
        peek();
        if (!text_.substr(position_).starts_with(token)) return false;
        position_ += token.size();
        return true;
    }

    /// Levels: 0 |, 1 ^, 2 &, 3 shifts, 4 sums, 5 products.
    std::int64_t binary(int level) {
        if (level == 6) return unary();
        std::int64_t left = binary(level + 1);
        while (true) {
            if (level == 0 && take("|")) {
                left |= binary(1);
            } else if (level == 1 && take("^")) {
                left ^= binary(2);
            } else if (level == 2 && take("&")) {
                left &= binary(3);
            } else if (level == 3 && take("<<")) {
                left = shifted(left, binary(4));
            } else if (level == 3 && take(">>")) {
                left >>= shift_count(binary(4));
            } else if (level == 4 && take("+")) {
                left = checked(left + binary(5));
            } else if (level == 4 && take("-")) {
                left = checked(left - binary(5));
            } else if (level == 5 && take("*")) {
                left = checked(left * binary(6));
            } else if (level == 5 && take("/")) {
                left /= divisor(binary(6));
            } else if (level == 5 && take("%")) {
                left %= divisor(binary(6));
            } else {
                return left;
            }
        }
    }

    static std::int64_t checked(std::int64_t value) {
        if (value > kLargestNumber || value < -kLargestNumber) fail("the value is beyond 32 bits");
        return value;
    }
    static std::int64_t shift_count(std::int64_t count) {
        if (count < 0 || count > 31) fail("a shift by " + std::to_string(count));
        return count;
    }
    static std::int64_t shifted(std::int64_t left, std::int64_t count) {
        return checked(left * (std::int64_t{1} << shift_count(count)));
    }
    static std::int64_t divisor(std::int64_t value) {
        if (value == 0) fail("division by zero");
        return value;
    }

    std::int64_t unary() {
        if (++depth_ > kDeepest) fail("the expression is nested too deeply");
        std::int64_t value = 0;
        if (take("-"))
            value = -unary();
        else if (take("~"))
            value = ~unary();
        else if (take("+"))
            value = unary();
        else
            value = primary();
        --depth_;
        return value;
    }

    std::int64_t primary() {
        const char c = peek();
        if (take("(")) {
            const std::int64_t value = binary(0);
            if (!take(")")) fail("a ')' is missing");
            return value;
        }
        if (c == '\'') return character();
        if (c >= '0' && c <= '9') return number();
        if (is_name_start(c)) return name();
        fail(c == '\0' ? "the expression ends early"
                       : "cannot read \"" + std::string(text_.substr(position_)) + "\"");
    }

    std::int64_t character() {
        const std::string_view rest = text_.substr(position_);
        if (rest.size() < 3 || rest[2] != '\'') fail("cannot read the character " + std::string(rest));
        position_ += 3;
        return static_cast<unsigned char>(rest[1]);
    }

    std::int64_t number() {
        int base = 10;
        if (take("0x") || take("0X"))
            base = 16;
        else if (take("0b") || take("0B"))
            base = 2;
        std::int64_t value = 0;
        const std::size_t start = position_;
        for (; position_ < text_.size() && is_name_char(text_[position_]); ++position_) {
            const char c = text_[position_];
            int digit = 99;
            if (c >= '0' && c <= '9') digit = c - '0';
            if (c >= 'a' && c <= 'f') digit = c - 'a' + 10;
            if (c >= 'A' && c <= 'F') digit = c - 'A' + 10;
            if (digit >= base)
                fail("'" + std::string(1, c) + "' in a number of base " + std::to_string(base));
            value = checked(value * base + digit);
        }
        if (position_ == start) fail("a number without digits");
        return value;
    }

    std::int64_t name() {
        const std::size_t start = position_;
        while (position_ < text_.size() && is_name_char(text_[position_]))
            ++position_;
        const std::string_view name = text_.substr(start, position_ - start);
        if (name == "." || name == "$") return here_;
        if (peek() == '(') return function(name);
        if (const auto value = value_of_(name)) return *value;
        if (dialect_.is_register && dialect_.is_register(name))
            fail("\"" + std::string(name) + "\" is a register, not a number");
        fail("unknown name \"" + std::string(name) + "\"");
    }

    std::int64_t function(std::string_view name) {
        take("(");
        const std::int64_t value = binary(0);
        if (!take(")")) fail("a ')' is missing");
        if (dialect_.function)
            if (const auto result = dialect_.function(name, value)) return *result;
        fail("unknown function \"" + std::string(name) + "\"");
    }

    std::string_view text_;
    std::uint32_t here_;
    const SymbolValue& value_of_;
    const Dialect& dialect_;
    std::size_t position_ = 0;
    int depth_ = 0;
};

/// A decimal or 0x number and nothing else: most operands are one.
std::optional<std::int64_t> plain_number(std::string_view text) {
    const bool hexadecimal = text.starts_with("0x");
    if (hexadecimal) text.remove_prefix(2);
    std::uint32_t value = 0;
    const auto [end, error] =
        std::from_chars(text.data(), text.data() + text.size(), value, hexadecimal ? 16 : 10);
    if (error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
    return value;
}

}  // namespace

std::int64_t evaluate(std::string_view text, std::uint32_t here, const SymbolValue& value_of,
                      const Dialect& dialect) {
    if (const auto number = plain_number(text)) return *number;
    return Parser(text, here, value_of, dialect).whole();
}

}  // namespace puckloop::assembly
