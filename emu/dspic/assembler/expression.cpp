#include "emu/dspic/assembler/expression.h"

#include "emu/dspic/assembler/operand.h"

namespace puckloop::dspic {

namespace {

std::optional<std::int64_t> apply(std::string_view name, std::int64_t value) {
    if (equal_ignoring_case(name, "tbloffset")) return value & 0xFFFF;
    if (equal_ignoring_case(name, "tblpage")) return value >> 16 & 0xFF;
    if (equal_ignoring_case(name, "psvoffset")) return (value & 0x7FFF) | 0x8000;
    if (equal_ignoring_case(name, "psvpage")) return value >> 15 & 0xFF;
    return std::nullopt;
}

}  // namespace

std::int64_t evaluate(std::string_view text, std::uint32_t here, const SymbolValue& value_of) {
    return assembly::evaluate(text, here, value_of, {&is_reserved_name, &apply});
}

}  // namespace puckloop::dspic
