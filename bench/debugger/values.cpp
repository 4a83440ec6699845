#include "bench/debugger/values.h"

#include "base/error.h"
#include "base/text/suggest.h"
#include "debug/core_register.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <bit>
#include <charconv>

namespace puckloop::exec::debugger {

namespace {

constexpr std::uint32_t kDataSpace = 0x10000;
constexpr std::size_t kMostShown = 64;  // bytes of an array

std::optional<std::uint64_t> any_number(std::string_view text) {
    const bool hexadecimal = text.starts_with("0x") || text.starts_with("0X");
    if (hexadecimal) text.remove_prefix(2);
    std::uint64_t value = 0;
    const char* const last = text.data() + text.size();
    const auto [end, error] = std::from_chars(text.data(), last, value, hexadecimal ? 16 : 10);
    if (text.empty() || error != std::errc{} || end != last) return std::nullopt;
    return value;
}

/// Lowest bit and mask of a field or bit of a register.
std::optional<std::pair<int, std::uint64_t>> field_bits(const debug::DebugChip::Special& special,
                                                        std::string_view name) {
    const std::string wanted = debug::upper_case(name);
    if (const auto bit = any_number(name); bit && *bit < static_cast<std::uint64_t>(special.bits))
        return std::pair{static_cast<int>(*bit), std::uint64_t{1}};
    for (const debug::DebugChip::Field& field : special.fields)
        if (debug::upper_case(field.name) == wanted)
            return std::pair{field.low, (std::uint64_t{1} << field.bits) - 1};
    return std::nullopt;
}

std::string grouped(const debug::DebugChip::Special& special) {
    std::string text;
    for (const debug::DebugChip::Field& field : special.fields)
        text += fmt::format(" {}={}", field.name, field.value);
    return text;
}

[[noreturn]] void unknown(std::string_view text, std::string_view name, const debug::DebugChip& chip,
                          const Program& program) {
    const std::vector<std::string> names = place_names(chip, program);
    throw InputError("", "", fmt::format("no variable or register '{}'", text),
                     "a variable of the image, a register, or 0xADDRESS of data space" +
                         did_you_mean(name, {names.begin(), names.end()}));
}

}  // namespace

Place place_of(std::string_view text, const debug::DebugChip& chip, const Program& program) {
    Place place;
    place.name = std::string(text);
    std::string_view name = text;
    if (name.starts_with("$")) name.remove_prefix(1);
    std::optional<std::uint64_t> index, bytes;
    if (name.ends_with("]")) {
        const std::size_t open = name.rfind('[');
        index = open == std::string_view::npos ? std::nullopt
                                               : any_number(name.substr(open + 1, name.size() - open - 2));
        if (!index || *index >= kDataSpace)
            throw InputError("", "", fmt::format("'{}' has no index", text), "NAME[NUMBER]");
        name = name.substr(0, open);
    }
    if (const std::size_t colon = name.rfind(':'); colon != std::string_view::npos) {
        bytes = any_number(name.substr(colon + 1));
        if (!bytes || *bytes == 0 || *bytes > kDataSpace)
            throw InputError("", "", fmt::format("'{}' has no number of bytes", text), "NAME:BYTES");
        name = name.substr(0, colon);
    }
    std::uint64_t address = 0;
    if (const auto variable = program.variable(name)) {
        address = variable->address;
        place.bytes = variable->bytes;
        if (bytes || !index) place.integer = place.bytes <= 4 && std::has_single_bit(place.bytes);
    } else if (const auto given = any_number(name); given && name.starts_with("0")) {
        address = *given;
        place.integer = true;
    } else {
        const std::size_t dot = name.find('.');
        const std::string_view reg = name.substr(0, dot);
        place.integer = true;
        if (dot == std::string_view::npos)
            if (const auto core = debug::core_register(name, chip); core && !index && !bytes) {
                place.core = core;
                place.bytes = static_cast<std::uint32_t>(chip.registers()[*core].bits / 8);
                return place;
            }
        const auto special = chip.special(debug::upper_case(reg));
        if (!special || index || bytes) unknown(text, reg, chip, program);
        place.address = static_cast<std::uint16_t>(special->address);
        place.bytes = static_cast<std::uint32_t>(special->bits / 8);
        place.special = true;
        if (dot == std::string_view::npos) return place;
        const std::string_view field = name.substr(dot + 1);
        const auto bits = field_bits(*special, field);
        if (!bits) {
            std::vector<std::string_view> fields;
            for (const debug::DebugChip::Field& one : special->fields)
                fields.push_back(one.name);
            throw InputError(
                "", "", fmt::format("{} has no field '{}'", debug::upper_case(reg), field),
                fmt::format("a bit number below {}", special->bits) +
                    (fields.empty() ? "" : fmt::format(" or one of {}", fmt::join(fields, ", "))) +
                    did_you_mean(field, fields));
        }
        place.field = true;
        place.shift = bits->first;
        place.mask = bits->second;
        return place;
    }
    const bool array = index.has_value();
    if (bytes) place.bytes = static_cast<std::uint32_t>(*bytes);
    if (array) {
        if (!bytes) place.bytes = 1;
        address += *index * place.bytes;
    }
    if (bytes || array) place.integer = place.bytes <= 8 && std::has_single_bit(place.bytes);
    if (address + place.bytes > kDataSpace)
        throw InputError("", "", fmt::format("'{}' is outside data space", text), "up to 0xFFFF");
    place.address = static_cast<std::uint16_t>(address);
    return place;
}

std::optional<std::vector<std::uint8_t>> bytes_of(const Place& place, const debug::DebugChip& chip) {
    std::vector<std::uint8_t> bytes(place.bytes);
    if (place.core) {
        const std::uint64_t value = chip.read_register(*place.core);
        for (std::size_t i = 0; i < bytes.size(); ++i)
            bytes[i] = static_cast<std::uint8_t>(value >> 8 * i);
        return bytes;
    }
    if (!chip.read_memory(debug::DebugChip::address_of_data(place.address), bytes)) return std::nullopt;
    return bytes;
}

std::optional<std::uint64_t> number_of(const Place& place, const debug::DebugChip& chip) {
    const auto bytes = bytes_of(place, chip);
    if (!bytes || bytes->size() > 8) return std::nullopt;
    std::uint64_t value = 0;
    for (std::size_t i = bytes->size(); i-- > 0;)
        value = value << 8 | (*bytes)[i];
    return place.field ? value >> place.shift & place.mask : value;
}

std::string shown(const Place& place, const debug::DebugChip& chip, char format) {
    const auto bytes = bytes_of(place, chip);
    if (!bytes) return "(no such memory)";
    if (format == 's') {
        std::string text;
        for (const std::uint8_t byte : *bytes) {
            if (byte == 0) break;
            text += byte >= 0x20 && byte < 0x7F && byte != '"' && byte != '\\'
                        ? std::string(1, static_cast<char>(byte))
                        : fmt::format("\\x{:02x}", byte);
        }
        return '"' + text + '"';
    }
    if (!place.integer) {
        std::string text;
        for (std::size_t i = 0; i < std::min(bytes->size(), kMostShown); ++i)
            text += format == 'd'   ? fmt::format("{} ", static_cast<std::int8_t>((*bytes)[i]))
                    : format == 'u' ? fmt::format("{} ", (*bytes)[i])
                                    : fmt::format("{:02x} ", (*bytes)[i]);
        text.pop_back();
        return text + (bytes->size() > kMostShown ? fmt::format(" ... ({} bytes)", bytes->size()) : "");
    }
    const std::uint64_t value = *number_of(place, chip);
    if (place.field && format == 0) return fmt::format("{}", value);
    const int bits =
        place.field ? static_cast<int>(std::bit_width(place.mask)) : static_cast<int>(8 * place.bytes);
    const std::string hex = fmt::format("0x{:0{}x}", value, (bits + 3) / 4);
    switch (format) {
    case 'x':
        return hex;
    case 'u':
        return fmt::format("{}", value);
    case 't':
        return fmt::format("0b{:0{}b}", value, bits);
    case 'd':
        return fmt::format("{}", static_cast<std::int64_t>(value << (64 - bits)) >> (64 - bits));
    default:
        break;
    }
    if (place.core) return fmt::format("{} ({})", value, hex);
    std::string text = place.special ? hex : fmt::format("{} ({})", value, hex);
    if (place.special)
        if (const auto special =
                chip.special(debug::upper_case(place.name.substr(place.name.starts_with("$") ? 1 : 0))))
            text += grouped(*special);
    return text;
}

bool write(const Place& place, debug::DebugChip& chip, std::uint64_t value) {
    if (place.core) return chip.write_register(*place.core, value);
    if (place.bytes > 8) return false;
    if (place.field) {
        Place whole = place;
        whole.field = false;
        const auto before = number_of(whole, chip);
        if (!before) return false;
        value = (*before & ~(place.mask << place.shift)) | (value & place.mask) << place.shift;
    }
    std::vector<std::uint8_t> bytes(place.bytes);
    for (std::size_t i = 0; i < bytes.size(); ++i)
        bytes[i] = static_cast<std::uint8_t>(value >> 8 * i);
    return chip.write_memory(debug::DebugChip::address_of_data(place.address), bytes);
}

std::vector<std::string> place_names(const debug::DebugChip& chip, const Program& program) {
    std::vector<std::string> names = program.variable_names();
    for (const debug::RegisterInfo& info : chip.registers())
        names.push_back(info.name);
    for (std::string& name : chip.special_names())
        names.push_back(std::move(name));
    return names;
}

std::string interrupts(const debug::DebugChip& chip) {
    std::string text;
    for (const std::string& name : chip.special_names()) {
        // IEC0, IFS0 ... of the dsPIC; TIMSK0, EIMSK, PCICR, UCSR0B, TIFR0 ... of the AVR.
        const auto special = chip.special(name);
        if (!special) continue;
        std::string set;
        const bool whole = name.find("IMSK") != std::string::npos || name.find("IFR") != std::string::npos;
        for (const debug::DebugChip::Field& field : special->fields) {
            const bool about = field.name.ends_with("IE") || field.name.ends_with("IF") ||
                               field.name.starts_with("OCIE") || field.name.starts_with("TOIE") ||
                               field.name.starts_with("RXCIE") || field.name.starts_with("TXCIE") ||
                               field.name.starts_with("UDRIE") || whole || name.starts_with("IEC") ||
                               name.starts_with("IFS");
            if (about && field.value != 0) set += fmt::format(" {}={}", field.name, field.value);
        }
        if (!set.empty()) text += fmt::format("{}:{}\n", name, set);
    }
    return text.empty() ? "no interrupt is enabled and none is flagged\n" : text;
}

}  // namespace puckloop::exec::debugger
