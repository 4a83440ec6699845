#pragma once
// The shared assembler expressions with the dsPIC's dialect: register names, and the functions tbloffset(),
// tblpage(), psvoffset(), psvpage() of a program address.

#include "emu/assembly/expression.h"
#include "emu/assembly/text.h"

namespace puckloop::dspic {

using assembly::ExpressionError;
using assembly::is_name_char;
using assembly::is_name_start;
using assembly::SymbolValue;

/// Throws ExpressionError: syntax, unknown name, division by zero, a number beyond 32 bits.
std::int64_t evaluate(std::string_view text, std::uint32_t here, const SymbolValue& value_of);

}  // namespace puckloop::dspic
