#include "debug/core_register.h"

namespace puckloop::debug {

std::string upper_case(std::string_view name) {
    std::string made(name);
    for (char& c : made)
        if (c >= 'a' && c <= 'z') c = static_cast<char>(c - 'a' + 'A');
    return made;
}

std::optional<std::size_t> core_register(std::string_view name, const DebugChip& chip) {
    const std::string wanted = upper_case(name);
    const auto registers = chip.registers();
    for (std::size_t i = 0; i < registers.size(); ++i)
        if (upper_case(registers[i].name) == wanted) return i;
    return std::nullopt;
}

}  // namespace puckloop::debug
