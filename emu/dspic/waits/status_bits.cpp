#include "emu/dspic/waits/status_bits.h"

#include <algorithm>
#include <vector>

namespace puckloop::dspic {

namespace {

/// Calls `each` with every word of a text in which one blank stands between words.
template <typename Each>
void for_words(std::string_view text, Each each) {
    while (!text.empty()) {
        const std::size_t end = std::min(text.find(' '), text.size());
        each(text.substr(0, end));
        text.remove_prefix(std::min(end + 1, text.size()));
    }
}

std::uint16_t bits_of(const DeviceInfo& device, const RegisterInfo& info, bool modelled) {
    std::uint16_t mask = 0;
    for (const StatusBits& line : device.status_bits) {
        if (line.modelled != modelled || !name_fits(line.registers, info.name)) continue;
        if (line.bits == "*") return 0xFFFF;
        for_words(line.bits, [&](std::string_view field) { mask |= field_mask(info, field); });
    }
    return mask;
}

}  // namespace

std::uint16_t driven_bits(const DeviceInfo& device, const RegisterInfo& info) {
    return bits_of(device, info, true);
}

std::uint16_t missing_bits(const DeviceInfo& device, const RegisterInfo& info) {
    return bits_of(device, info, false);
}

std::string register_text(const RegisterInfo& info, std::uint16_t mask) {
    std::vector<std::string_view> names;
    std::uint16_t named = 0;
    for_fields(info, [&](const RegisterField& field) {
        if (!(field.mask & mask)) return;
        names.push_back(field.name);
        named |= field.mask;
    });
    std::string text(info.name);
    if (names.empty() || (mask & ~named) || (mask & info.implemented) == info.implemented) return text;
    text += names.size() > 1 ? ", bits " : ", bit ";
    for (std::size_t i = 0; i < names.size(); ++i) {
        if (i > 0) text += i + 1 == names.size() ? " and " : ", ";
        text += names[i];
    }
    return text;
}

}  // namespace puckloop::dspic
