#include "emu/chip/faults/chip_access.h"

#include <algorithm>
#include <array>

namespace puckloop::chip {

namespace {

constexpr std::array<std::string_view, 7> kCauses{"power_on", "brown_out", "mclr",          "watchdog",
                                                  "software", "trap",      "illegal_opcode"};
constexpr std::array<std::string_view, 4> kSpaces{"ram", "register", "flash", "eeprom"};

template <class Enum>
std::optional<Enum> named(std::span<const std::string_view> names, std::string_view name) {
    const auto found = std::find(names.begin(), names.end(), name);
    if (found == names.end()) return std::nullopt;
    return static_cast<Enum>(found - names.begin());
}

}  // namespace

std::span<const std::string_view> reset_cause_names() {
    return kCauses;
}
std::optional<FaultReset> reset_cause_of_name(std::string_view name) {
    return named<FaultReset>(kCauses, name);
}
std::span<const std::string_view> memory_space_names() {
    return kSpaces;
}
std::optional<MemorySpace> memory_space_of_name(std::string_view name) {
    return named<MemorySpace>(kSpaces, name);
}

}  // namespace puckloop::chip
