#include "emu/xbee/settings.h"

#include <algorithm>

namespace puckloop::xbee {

using protocols::XBeeBytes;

Settings::Values Settings::factory() {
    Values values;
    for (const AtParameter& parameter : at_table())
        values.numbers.push_back(parameter.factory);
    values.identifier = " ";
    return values;
}

XBeeBytes Settings::read(std::size_t place, bool queued) const {
    const std::uint32_t number = (queued ? queued_ : now_).numbers[place];
    XBeeBytes value;
    for (int octet = at_table()[place].octets - 1; octet >= 0; --octet)
        value.push_back(static_cast<std::uint8_t>(number >> 8 * octet));
    return value;
}

std::uint8_t Settings::write(std::size_t place, const XBeeBytes& value) {
    const AtParameter& parameter = at_table()[place];
    if (parameter.read_only || value.size() > static_cast<std::size_t>(parameter.octets)) return kAtBadValue;
    std::uint64_t number = 0;
    for (const std::uint8_t octet : value)
        number = number << 8 | octet;
    if (!accepts(parameter, number)) return kAtBadValue;
    queued_.numbers[place] = static_cast<std::uint32_t>(number);
    return kAtOk;
}

std::uint8_t Settings::write_identifier(const XBeeBytes& value) {
    const bool printable =
        std::all_of(value.begin(), value.end(), [](std::uint8_t c) { return c >= 0x20 && c < 0x7F; });
    if (value.empty() || value.size() > kMostNodeIdentifier || !printable) return kAtBadValue;
    queued_.identifier.assign(value.begin(), value.end());
    return kAtOk;
}

void Settings::write_destination(std::uint64_t address) {
    queued_.numbers[kDH] = static_cast<std::uint32_t>(address >> 32);
    queued_.numbers[kDL] = static_cast<std::uint32_t>(address);
}

}  // namespace puckloop::xbee
