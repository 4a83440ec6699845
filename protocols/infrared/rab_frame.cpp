#include "protocols/infrared/rab_frame.h"

#include "base/error.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>

namespace puckloop::protocols {

namespace {

constexpr int kCheckModulus = 1 << kRabCheckBits;

void require_size(int size) {
    if (!is_rab_size(size))
        throw InputError("", "payload size", fmt::format("{} bits cannot be sent", size), kRabSizesText);
}

void put_bit(std::string& chips, bool bit) {
    chips += bit ? "10" : "01";
}

void require_chips(std::string_view chips, std::string_view origin) {
    if (chips.empty()) throw InputError(origin, "chips", "nothing to read", "a frame as 0 and 1");
    for (std::size_t i = 0; i < chips.size(); ++i) {
        const auto byte = static_cast<unsigned char>(chips[i]);
        if (byte == '0' || byte == '1') continue;
        const bool shows = byte > ' ' && byte < 0x7F;
        throw InputError(origin, fmt::format("chip {}", i),
                         shows ? fmt::format("'{}' is no chip", chips[i])
                               : fmt::format("byte {:#04x} is no chip", byte),
                         "0 or 1");
    }
}

int size_by_length(std::size_t chips) {
    for (const int size : kRabSizes)
        if (chips == static_cast<std::size_t>(rab_frame_chips(size))) return size;
    return 0;
}

}  // namespace

int rab_check(std::uint32_t payload) {
    return (kCheckModulus - std::popcount(payload) % kCheckModulus) % kCheckModulus;
}

std::string encode_rab(int size, std::uint32_t payload) {
    require_size(size);
    if (size < 32 && payload >> size != 0)
        throw InputError("", "payload", fmt::format("{:X} is too large for {} bits", payload, size),
                         fmt::format("at most {:X}", (1u << size) - 1));
    std::string chips(kRabPreambleChips, '1');
    for (int bit = 0; bit < size; ++bit)
        put_bit(chips, payload >> bit & 1u);
    for (int bit = kRabCheckBits - 1; bit >= 0; --bit)
        put_bit(chips, rab_check(payload) >> bit & 1);
    return chips;
}

std::string_view name_of(RabFault fault) {
    constexpr std::array<std::string_view, 5> kNames{"none", "preamble", "manchester", "length", "check"};
    return kNames.at(static_cast<std::size_t>(fault));
}

RabFrameReading decode_rab(std::string_view chips, int size, std::string_view origin) {
    if (size != 0) require_size(size);
    require_chips(chips, origin);
    RabFrameReading reading;
    reading.size = size != 0 ? size : size_by_length(chips.size());
    reading.chips = static_cast<int>(chips.size());
    const auto wrong = [&](RabFault fault, int chip) {
        reading.fault = fault;
        reading.chip = chip;
        return reading;
    };
    const int expected = reading.size != 0 ? rab_frame_chips(reading.size) : reading.chips;
    const int end = std::min(expected, reading.chips);
    for (int chip = 0; chip < std::min(end, kRabPreambleChips); ++chip)
        if (chips[static_cast<std::size_t>(chip)] == '0') return wrong(RabFault::Preamble, chip);
    std::uint32_t payload = 0;
    int check = 0;
    for (int bit = 0; kRabPreambleChips + 2 * bit + 1 < end; ++bit) {
        const auto chip = static_cast<std::size_t>(kRabPreambleChips + 2 * bit);
        if (chips[chip] == chips[chip + 1]) return wrong(RabFault::Manchester, static_cast<int>(chip));
        const bool set = chips[chip] == '1';
        if (bit < reading.size)
            payload |= std::uint32_t{set} << bit;
        else if (bit < reading.size + kRabCheckBits)
            check = check << 1 | int{set};
    }
    if (reading.size == 0 || reading.chips != expected) return wrong(RabFault::Length, end);
    reading.payload = payload;
    reading.check = check;
    if (check != rab_check(payload)) return wrong(RabFault::Check, kRabPreambleChips + 2 * reading.size);
    return reading;
}

std::string explain(const RabFrameReading& r) {
    switch (r.fault) {
    case RabFault::None:
        break;
    case RabFault::Preamble:
        return fmt::format("preamble: chip {} is off", r.chip);
    case RabFault::Manchester:
        return fmt::format("manchester: chips {} and {} are equal", r.chip, r.chip + 1);
    case RabFault::Length:
        if (r.size == 0) return fmt::format("length: {} chips, and frames have 30, 46, 62 or 78", r.chips);
        return fmt::format("length: {} chips, and a frame of {} bits has {}", r.chips, r.size,
                           rab_frame_chips(r.size));
    case RabFault::Check:
        return fmt::format("check: {:X} from chip {} on, and payload {:0{}X} needs {:X}", r.check, r.chip,
                           r.payload, r.size / 4, rab_check(r.payload));
    }
    return "ok";
}

}  // namespace puckloop::protocols
