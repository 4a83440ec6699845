#pragma once
// Bits of registers by their names in the device tables, looked up when the program is compiled: a name that
// no table has does not compile.
//
//     constexpr RegisterBits kCon{"T?CON"};
//     if (con & kCon["TON"]) prescale = kPrescale[kCon["TCKPS"].of(con)];

#include "emu/dspic/devices/register_tables.h"

#include <bit>

namespace puckloop::dspic {

/// A mask, and the number in its place.
class BitField {
  public:
    constexpr explicit BitField(std::uint16_t mask) : mask_(mask) {}
    constexpr operator std::uint16_t() const { return mask_; }
    constexpr BitField operator|(BitField other) const {
        return BitField(static_cast<std::uint16_t>(mask_ | other.mask_));
    }
    constexpr unsigned of(unsigned value) const { return (value & mask_) >> std::countr_zero(mask_); }

  private:
    std::uint16_t mask_;
};

/// The registers whose names fit a pattern (name_fits), such as all of one kind of module. Those that have a
/// field have it in the same place.
class RegisterBits {
  public:
    consteval explicit RegisterBits(const char* pattern) : pattern_(pattern) {}
    /// The field's name may be a pattern too.
    consteval BitField operator[](const char* field) const {
        std::uint16_t mask = 0;
        const auto look = [&](const auto& table) {
            for (const RegisterInfo& info : table) {
                if (!name_fits(pattern_, info.name)) continue;
                const std::uint16_t found = mask_of(info, field);
                if (found != 0 && mask != 0 && found != mask) throw "a field in different places";
                if (found != 0) mask = found;
            }
        };
        look(kRegisters30F6014A);
        look(kRegisters33FJ256GP710);
        if (mask == 0) throw "no register has this field";
        return BitField(mask);
    }

  private:
    static constexpr std::uint16_t mask_of(const RegisterInfo& info, std::string_view pattern) {
        std::uint16_t mask = 0;
        for_fields(info, [&](const RegisterField& field) {
            if (name_fits(pattern, field.name)) mask = field.mask;
        });
        return mask;
    }
    const char* pattern_;
};

}  // namespace puckloop::dspic
