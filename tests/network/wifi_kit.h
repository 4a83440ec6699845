#pragma once
// Stations that flood an access point, and what of it gets through.

#include "base/json.h"
#include "emu/wifi/wifi_node.h"
#include "tests/network/wire_kit.h"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

namespace puckloop::tests {

inline constexpr std::size_t kFloodOctets = 1500;  // a packet, with its headers
inline constexpr double kFloodPayload = 8.0 * (1500 - 28);

/// `count` stations on a circle of `radius` m round the access point, and a sink by wire behind it. All
/// powers are alike: no frame is read that another one overlaps.
inline wifi::WifiSpec ring(std::size_t count, double radius = 5.0) {
    wifi::WifiSpec spec;
    spec.settings.standard = "b";
    spec.settings.rate = 11e6;
    spec.settings.shadowing = 0;
    spec.access_point = {0, 0};
    spec.queue = 10;
    for (std::size_t i = 0; i < count; ++i) {
        const double angle = 2 * std::numbers::pi * static_cast<double>(i) / static_cast<double>(count);
        spec.stations.push_back({{fmt::format("s{}", i), fmt::format("10.0.0.{}", i + 1)},
                                 {radius * std::cos(angle), radius * std::sin(angle)}});
    }
    spec.stations.push_back({.computer = {"sink", "10.0.0.254"}, .wired = true});
    return spec;
}

struct Flooded {
    double bits = 0;                ///< of payload that reached the sink, a second
    std::vector<double> of_each{};  ///< of it by each station
    nlohmann::json report{};
    std::vector<cosim::Message> outbox{};
};

/// Every station always has something to send.
inline Flooded flood(const wifi::WifiSpec& spec, double seconds, cosim::Time step = 4 * cosim::kMillisecond) {
    wifi::WifiNode node(spec);
    Flooded result;
    const std::size_t count = spec.stations.size() - 1;
    const cosim::Time end = cosim::from_seconds(seconds), refill = 2 * cosim::kMillisecond;
    std::vector<cosim::Message> inbox;
    cosim::Time fed = 0;
    for (cosim::Time now = step; now <= end; now += step) {
        inbox.clear();
        for (; fed < now; fed += refill)
            for (std::size_t s = 0; s < count; ++s)
                for (int i = 0; i < 8; ++i)
                    inbox.push_back(packet(fed, s, kFirst + 253, "flood", kFloodOctets));
        node.advance(now, inbox, result.outbox);
    }
    result.of_each.resize(count);
    for (const cosim::Message& message : result.outbox) {
        const auto read = protocols::decode_ip(std::get<cosim::Packet>(message.payload).octets.view());
        result.of_each.at(read->from - kFirst) += kFloodPayload / seconds;
        result.bits += kFloodPayload / seconds;
    }
    result.report = nlohmann::json::parse(node.finish());
    return result;
}

}  // namespace puckloop::tests
