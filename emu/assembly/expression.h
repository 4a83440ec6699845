#pragma once
// Assembler expressions: 64-bit integers, C's operators and precedence (| ^ & << >> + - * / % ~ -,
// parentheses), decimal, 0x, 0b and 'c' numbers, names, "." for the current program address, and the
// functions of the chip's dialect.

#include <cstdint>
#include <functional>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>

namespace puckloop::assembly {

/// What is wrong with an expression; the assembler adds file and line.
class ExpressionError : public std::runtime_error {
  public:
    using std::runtime_error::runtime_error;
};

/// Value of a name, or nothing if it is unknown.
using SymbolValue = std::function<std::optional<std::int64_t>(std::string_view name)>;

/// What an expression may contain beyond numbers and names.
struct Dialect {
    bool (*is_register)(std::string_view name) = nullptr;  ///< a name that cannot be a number
    /// The value of `name(value)`, or nothing if there is no such function.
    std::optional<std::int64_t> (*function)(std::string_view name, std::int64_t value) = nullptr;
};

/// Throws ExpressionError: syntax, unknown name, division by zero, a number beyond 32 bits.
std::int64_t evaluate(std::string_view text, std::uint32_t here, const SymbolValue& value_of,
                      const Dialect& dialect);

}  // namespace puckloop::assembly
