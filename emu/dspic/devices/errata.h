#pragma once
// What the silicon of the dsPIC30F6014A, revision B0, does otherwise than its manuals say, switched on one by
// one; nothing of it is played unless asked for. Source: the headings of its errata sheet, fact
// sheets semantics.md (DAW.B) and peripherals.md section 5 (output compare).

#include "base/enum_names.h"

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace puckloop::dspic {

enum class Erratum : unsigned char {
    DawCarry,     ///< DAW.B clears C where its own sum carries nothing out, though C was set
    PwmZeroDuty,  ///< a PWM duty that becomes 0 makes a pulse, and the next period's duty stays away
};

inline constexpr std::array<std::string_view, 2> kErratumNames{"daw.b", "pwm-zero-duty"};

constexpr std::string_view name_of(Erratum erratum) {
    return kErratumNames[static_cast<std::size_t>(erratum)];
}
constexpr std::optional<Erratum> erratum_of(std::string_view name) {
    return value_named<Erratum>(kErratumNames, name);
}

/// A set of them.
class Errata {
  public:
    constexpr void add(Erratum erratum) { bits_ |= 1u << static_cast<unsigned>(erratum); }
    constexpr bool has(Erratum erratum) const { return bits_ >> static_cast<unsigned>(erratum) & 1; }

  private:
    unsigned bits_ = 0;
};

/// By names that were checked.
inline Errata errata_named(const std::vector<std::string>& names) {
    Errata errata;
    for (const std::string& name : names)
        errata.add(*erratum_of(name));
    return errata;
}

}  // namespace puckloop::dspic
