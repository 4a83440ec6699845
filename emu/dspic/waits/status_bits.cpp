#include "emu/dspic/waits/status_bits.h"

#include <algorithm>
#include <charconv>
#include <vector>

namespace puckloop::dspic {

namespace {

bool fits(std::string_view pattern, std::string_view name) {
    return std::equal(pattern.begin(), pattern.end(), name.begin(), name.end(),
                      [](char p, char n) { return p == '?' || p == n; });
}

/// Calls `each` with every word of a text in which one blank stands between words.
template <typename Each>
void for_words(std::string_view text, Each each) {
    while (!text.empty()) {
        const std::size_t end = std::min(text.find(' '), text.size());
        each(text.substr(0, end));
        text.remove_prefix(std::min(end + 1, text.size()));
    }
}

unsigned number(std::string_view text) {
    unsigned value = 0;
    std::from_chars(text.data(), text.data() + text.size(), value);
    return value;
}

/// "TCKPS:5:4" or "TON:15": its name and mask.
struct Field {
    std::string_view name;
    std::uint16_t mask = 0;
};
Field parse_field(std::string_view text) {
    const std::size_t first = text.find(':');
    const std::size_t second = text.find(':', first + 1);
    const unsigned high = number(text.substr(first + 1, second - first - 1));
    const unsigned low = second == std::string_view::npos ? high : number(text.substr(second + 1));
    return {text.substr(0, first), static_cast<std::uint16_t>((2u << high) - (1u << low))};
}

std::uint16_t bits_of(const DeviceInfo& device, const RegisterInfo& info, bool modelled) {
    std::uint16_t mask = 0;
    for (const StatusBits& line : device.status_bits) {
        if (line.modelled != modelled || !fits(line.registers, info.name)) continue;
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

std::uint16_t field_mask(const RegisterInfo& info, std::string_view field) {
    std::uint16_t mask = 0;
    for_words(info.fields, [&](std::string_view text) {
        const Field found = parse_field(text);
        if (found.name == field) mask = found.mask;
    });
    return mask;
}

std::string register_text(const RegisterInfo& info, std::uint16_t mask) {
    std::vector<std::string_view> names;
    std::uint16_t named = 0;
    for_words(info.fields, [&](std::string_view text) {
        const Field field = parse_field(text);
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
