#include "emu/radio/control.h"

#include "cosim/core/codec.h"

namespace puckloop::radio {

namespace {
constexpr std::uint8_t kSettings = 'S', kOutcome = 'O';
constexpr std::uint8_t kFirstChannel = 11, kLastChannel = 26;
}  // namespace

std::vector<std::uint8_t> encode(const RadioSettings& settings) {
    std::vector<std::uint8_t> octets;
    cosim::ByteWriter out(octets);
    out.u8(kSettings);
    out.u8(settings.on ? 1 : 0);
    out.u8(settings.channel);
    out.u16(settings.pan);
    out.u64(settings.address);
    out.u8(static_cast<std::uint8_t>(settings.dbm));
    for (const std::uint8_t value : {settings.cca, settings.mac_retries, settings.repeats,
                                     settings.network_hops, settings.delay_slots, settings.network_retries})
        out.u8(value);
    return octets;
}

std::vector<std::uint8_t> encode(const RadioOutcome& outcome) {
    std::vector<std::uint8_t> octets;
    cosim::ByteWriter out(octets);
    out.u8(kOutcome);
    out.u16(outcome.sequence);
    out.u8(outcome.retries);
    out.u8(outcome.delivery);
    out.u8(outcome.discovery);
    return octets;
}

std::optional<RadioSettings> decode_settings(std::span<const std::uint8_t> octets) {
    try {
        cosim::ByteReader in(octets);
        if (in.u8() != kSettings) return std::nullopt;
        RadioSettings settings;
        settings.on = in.boolean();
        settings.channel = in.u8();
        settings.pan = in.u16();
        settings.address = in.u64();
        settings.dbm = static_cast<std::int8_t>(in.u8());
        for (std::uint8_t* value : {&settings.cca, &settings.mac_retries, &settings.repeats,
                                    &settings.network_hops, &settings.delay_slots, &settings.network_retries})
            *value = in.u8();
        in.end();
        if (settings.channel < kFirstChannel || settings.channel > kLastChannel) return std::nullopt;
        return settings;
    } catch (const cosim::CodecError&) {
        return std::nullopt;
    }
}

std::optional<RadioOutcome> decode_outcome(std::span<const std::uint8_t> octets) {
    try {
        cosim::ByteReader in(octets);
        if (in.u8() != kOutcome) return std::nullopt;
        RadioOutcome outcome;
        outcome.sequence = in.u16();
        outcome.retries = in.u8();
        outcome.delivery = in.u8();
        outcome.discovery = in.u8();
        in.end();
        return outcome;
    } catch (const cosim::CodecError&) {
        return std::nullopt;
    }
}

}  // namespace puckloop::radio
