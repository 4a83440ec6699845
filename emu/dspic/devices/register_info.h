#pragma once
// One register of a device's table, and its bits by name. The tables are devices/*_registers.inc: whoever
// needs a bit (models, wait reports, tests) finds it there and nowhere else.

#include <cstddef>
#include <cstdint>
#include <string_view>

namespace puckloop::dspic {

/// The data sheet's name, its address, reset value and implemented bits.
struct RegisterInfo {
    std::string_view name;
    std::uint16_t address = 0;
    std::uint16_t reset = 0;        ///< power-on value; bits the sheet calls unknown are 0 here
    std::uint16_t implemented = 0;  ///< bits that exist; the others read 0
    std::string_view fields;  ///< "TON:15 TCKPS:5:4 ...", high bit first; empty for whole-word registers
};

/// A field of a register: "TCKPS:5:4" or "TON:15" in the table.
struct RegisterField {
    std::string_view name;
    std::uint16_t mask = 0;
};

/// Calls `each` with every field of a register.
template <class Each>
constexpr void for_fields(const RegisterInfo& info, Each each) {
    for (std::string_view rest = info.fields; !rest.empty();) {
        const std::size_t end = rest.find(' ');
        std::string_view text = rest.substr(0, end);
        rest.remove_prefix(end == std::string_view::npos ? rest.size() : end + 1);
        unsigned bits[2]{};
        int count = 0;
        const std::size_t colon = text.find(':');
        for (const char c : text.substr(colon)) {
            if (c == ':')
                ++count;
            else
                bits[count - 1] = bits[count - 1] * 10 + static_cast<unsigned>(c - '0');
        }
        const unsigned high = bits[0], low = count == 2 ? bits[1] : high;
        each(RegisterField{text.substr(0, colon), static_cast<std::uint16_t>((2u << high) - (1u << low))});
    }
}

/// Mask of a field by its name; 0 if there is none.
constexpr std::uint16_t field_mask(const RegisterInfo& info, std::string_view name) {
    std::uint16_t mask = 0;
    for_fields(info, [&](const RegisterField& field) {
        if (field.name == name) mask = field.mask;
    });
    return mask;
}

/// True if a register's name fits: in the pattern ? is any one character, * any characters or none.
constexpr bool name_fits(std::string_view pattern, std::string_view name) {
    if (pattern.empty()) return name.empty();
    if (pattern[0] == '*')
        return name_fits(pattern.substr(1), name) || (!name.empty() && name_fits(pattern, name.substr(1)));
    return !name.empty() && (pattern[0] == '?' || pattern[0] == name[0]) &&
           name_fits(pattern.substr(1), name.substr(1));
}

}  // namespace puckloop::dspic
