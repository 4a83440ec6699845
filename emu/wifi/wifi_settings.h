#pragma once
// What the radio of a network is set to: keys of a scenario's [network.wifi] (docs/network.md).
// Sources: [8] IEEE 802.11-2016, [R] T. S. Rappaport, Wireless Communications, 2nd edition, table 4.6, [E]
// ETSI EN 300 328 (2.4 GHz band), [C] COST 231 final report, 4.7.2 (multi-wall model); "?": plausible only.

#include "base/fields/field.h"

#include <cstdint>
#include <string>

namespace puckloop::wifi {

struct WifiSettings {
    std::string standard = "g";
    std::string preamble = "long";
    double rate = 0.0;
    double broadcast_rate = 0.0;
    double power = 15.0;
    double loss_at_1m = 40.2;
    double exponent = 3.0;
    double shadowing = 7.0;
    double noise = -91.0;
    double carrier_sense = -82.0;
    std::int64_t attempts = 7;
    std::int64_t shortest_window = 0;
    std::int64_t longest_window = 1023;
    double body_loss = 0.0;
    double wall_loss = 0.0;
    double thing_loss = 0.0;
    double bursts = 0.0;
    double burst_time = 0.002;
    double burst_power = -60.0;
    bool capture = false;
    bool mesh = false;
    std::int64_t mesh_hops = 8;
    double route_every = 1.0;

    template <class Visitor>
    static constexpr auto fields(Visitor&& visit) {
        using S = WifiSettings;
        constexpr double kFastest = 54e6;
        return visit(
            field("standard", &S::standard, "802.11b (\"b\") or 802.11g (\"g\"), of all stations"),
            field("preamble", &S::preamble,
                  "of 802.11b: \"long\" (192 us with its header) or \"short\" (96 us)"),
            field("rate", &S::rate,
                  "of frames to one station; 0: the fastest whose sensitivity their power exceeds by 3 dB")
                .in("bit/s")
                .within(0, kFastest),
            field("broadcast_rate", &S::broadcast_rate, "of frames to all; 0: the standard's slowest")
                .in("bit/s")
                .within(0, kFastest),
            field("power", &S::power, "that stations send with, ?; 20 dBm at most in Europe [E]")
                .in("dBm")
                .within(-30, 30),
            field("loss_at_1m", &S::loss_at_1m, "over the first metre; 40.2 dB: free space at 2.437 GHz")
                .in("dB")
                .within(0, 100),
            field("exponent", &S::exponent,
                  "of distance, by which power falls; 3: offices with hard partitions [R], 2: free space")
                .within(1, 10),
            field("shadowing", &S::shadowing,
                  "standard deviation of the loss from pair to pair; 7 dB: with that exponent [R]")
                .in("dB")
                .within(0, 30),
            field("noise", &S::noise, "of the receiver: -101 dBm in 20 MHz, and a noise figure of 10 dB [8]")
                .in("dBm")
                .within(-120, 0),
            field("carrier_sense", &S::carrier_sense, "from this power on a frame makes the channel busy [8]")
                .in("dBm")
                .within(-120, 0),
            field("attempts", &S::attempts, "to send a frame to one station, at most (retry limit) [8]")
                .within(1, 255),
            field("shortest_window", &S::shortest_window,
                  "first contention window; 0: the standard's, 31 (b) or 15 (g) slots [8]")
                .in("slots")
                .within(0, 1023),
            field("longest_window", &S::longest_window, "last contention window, after doubling [8]")
                .in("slots")
                .within(1, 65535),
            field("body_loss", &S::body_loss,
                  "of each robot's body in the way between two stations, ?; 0: bodies are transparent")
                .in("dB")
                .within(0, 60),
            field(
                "wall_loss", &S::wall_loss,
                "of each wall in the way between two stations, those of the arena too; 3.4 dB light, 6.9 dB "
                "heavy ones at 1.8 GHz [C]")
                .in("dB")
                .within(0, 100),
            field("thing_loss", &S::thing_loss, "of each box or cylinder in the way, ?")
                .in("dB")
                .within(0, 100),
            field("bursts", &S::bursts, "of interference, mean number, ?; 0: none").in("Hz").within(0, 10000),
            field("burst_time", &S::burst_time, "mean length of a burst, drawn (exponential), ?")
                .in("s")
                .within(1e-6, 10),
            field("burst_power", &S::burst_power, "of bursts at every station, ?").in("dBm").within(-120, 0),
            field("capture", &S::capture, "frames go to wifi.pcapng, with radiotap headers"),
            field("mesh", &S::mesh, "without an access point: stations pass on what is for others"),
            field("mesh_hops", &S::mesh_hops, "of a packet in a mesh, at most").within(1, 64),
            field("route_every", &S::route_every, "a mesh's ways are found again after so long, ?")
                .in("s")
                .within(0.01, 3600));
    }
};
static_assert(lists_all_fields<WifiSettings>);

}  // namespace puckloop::wifi
