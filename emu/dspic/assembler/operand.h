#pragma once
// One operand as it is written, before any form is chosen: its shape and registers are known, its numbers are
// expressions still to be evaluated (labels may come later in the file).

#include "emu/assembly/text.h"

#include <cstdint>
#include <string>
#include <string_view>

namespace puckloop::dspic {

struct Operand {
    enum class Shape : std::uint8_t {
        Register,        ///< w3 and [w3], [w3++] ...: `mode` decides
        RegisterOffset,  ///< [w3+w4]
        LiteralOffset,   ///< [w3+8]: `expression` is the signed offset
        Stepped,         ///< [w8]+=2: `step`
        Literal,         ///< #expression
        Expression,      ///< a name or number
        Wreg,            ///< wreg
        Accumulator,     ///< a, b: `number` 0, 1
        Product,         ///< w4*w5
    };
    Shape shape{};
    std::uint8_t mode = 0;    ///< of isa_forms.inc: 0 direct ... 5 pre-increment
    std::uint8_t number = 0;  ///< register
    std::uint8_t second = 0;  ///< register of RegisterOffset and Product
    std::int8_t step = 0;
    bool negative = false;  ///< LiteralOffset: the expression counts downward
    std::string_view expression;
    std::string_view text;  ///< as written, for messages
};

/// Parses one operand. Returns false and sets `problem` when it cannot be read.
bool parse_operand(std::string_view text, Operand& operand, std::string& problem);

/// Register number of "w0".."w15" in any case, or -1.
int register_number(std::string_view name);

/// Names that cannot be labels: registers, accumulators.
bool is_reserved_name(std::string_view name);

using assembly::equal_ignoring_case;
using assembly::trim;

}  // namespace puckloop::dspic
