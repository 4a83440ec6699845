#pragma once
// What a radio module and its network layer, which lives in the medium's node, say to each other on the radio
// link beside frames on air: RadioFrames of duration 0 with one of these as octets.

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace puckloop::radio {

/// How a module's radio is set; sent at every change. Until the first one it is deaf.
struct RadioSettings {
    bool on = false;  ///< receives, relays and sends
    std::uint8_t channel = 12;
    std::uint16_t pan = 0;
    std::uint64_t address = 0;
    std::int8_t dbm = 0;               ///< power that it sends with
    std::uint8_t cca = 0;              ///< CA: the channel is busy above minus this, dBm; 0: never looks
    std::uint8_t mac_retries = 10;     ///< RR
    std::uint8_t repeats = 3;          ///< MT: a broadcast goes out once and so often again
    std::uint8_t network_hops = 7;     ///< NH
    std::uint8_t delay_slots = 3;      ///< NN
    std::uint8_t network_retries = 1;  ///< MR
    bool operator==(const RadioSettings&) const = default;
};

/// What became of a frame that the module gave to the medium.
struct RadioOutcome {
    std::uint16_t sequence = 0;  ///< of the frame
    std::uint8_t retries = 0;    ///< of the network layer
    std::uint8_t delivery = 0;   ///< as in XBeeTxStatus
    std::uint8_t discovery = 0;  ///< 0, or 2: a route was looked for
    bool operator==(const RadioOutcome&) const = default;
};

inline constexpr std::uint8_t kDelivered = 0x00, kNoMacAck = 0x01, kChannelBusy = 0x02, kNoNetworkAck = 0x21,
                              kNoRoute = 0x25, kTooLong = 0x74;
inline constexpr std::uint8_t kRouteDiscovered = 0x02;

std::vector<std::uint8_t> encode(const RadioSettings& settings);
std::vector<std::uint8_t> encode(const RadioOutcome& outcome);
/// Nothing for octets that are not of this kind, or out of range.
std::optional<RadioSettings> decode_settings(std::span<const std::uint8_t> octets);
std::optional<RadioOutcome> decode_outcome(std::span<const std::uint8_t> octets);

}  // namespace puckloop::radio
