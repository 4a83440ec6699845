#pragma once
// The network layer of every module on the medium: routes, broadcasts, acknowledgement from end to end.
// Source: XBee/XBee-PRO DigiMesh 2.4 manual (90000991), "DigiMesh networking", "Transmission timeouts", NH,
// NN, MT, MR.
//
// Deviations:
// 1. DigiMesh's algorithms are not published. A route request is answered at its first copy to reach the
//    target, and leaves routes back to the origin on its way, as in AODV; DigiMesh weighs link quality too.
// 2. Before each copy of a broadcast but its origin's first a random time of up to NN slots of 18 ms passes.
// 3. The manual's table of the time of one hop is replaced by what the MAC needs at most (kAttempt).
// 4. Tables of routes have no limit; the module has 32.
// 5. Network acknowledgements are kept from nobody's way: they cost no memory of the module.

#include "emu/radio/mac.h"

#include <array>
#include <deque>
#include <map>
#include <set>
#include <string>
#include <vector>

namespace puckloop::radio {

/// Counted for each station.
struct MeshCounts {
    std::uint64_t unicasts = 0;    ///< of the module
    std::uint64_t broadcasts = 0;  ///< of the module
    std::uint64_t delivered = 0;   ///< unicasts with kDelivered
    std::uint64_t undelivered = 0;
    std::uint64_t retries = 0;      ///< unicasts sent again from end to end
    std::uint64_t discoveries = 0;  ///< route requests begun
    std::uint64_t relayed = 0;      ///< frames of others handed on
    std::uint64_t no_way_on = 0;    ///< frames of others that could not be handed on
    std::uint64_t duplicates = 0;   ///< frames that had come by another way
    std::uint64_t bad_frames = 0;   ///< from the module: FCS, format
};

/// The modules' side of the network layer.
class MeshUser {
  public:
    virtual ~MeshUser() = default;
    virtual void deliver(std::size_t station, const protocols::MeshFrame& frame, const Heard& heard) = 0;
    virtual void report(std::size_t station, const RadioOutcome& outcome, cosim::Time now) = 0;
};

class Mesh : private MacUser {
  public:
    /// `processing`: what a module needs to look at a frame, s > 0.
    Mesh(Medium& medium, const std::vector<std::string>& names, std::uint64_t seed, cosim::Time processing,
         AirFaults& faults, MeshUser& user);

    void set(std::size_t station, const RadioSettings& settings, cosim::Time now);
    /// A module's own frame; report() follows for those whose fate is known to it.
    void send(std::size_t station, const protocols::MeshFrame& frame, cosim::Time now);
    void bad_frame(std::size_t station) { ++stations_[station].counts.bad_frames; }
    /// Everything that happens before `until` (at `until` too, if `inclusive`).
    void run(cosim::Time until, bool inclusive);
    /// Nothing reaches a module before, if no module sends anything.
    cosim::Time earliest_output() const;
    /// From a module's frame to anything that it causes at a module.
    static cosim::Time lookahead() { return kTurnaround + air_time(protocols::kMeshOverhead); }

    const Mac& mac() const { return mac_; }
    const MeshCounts& counts(std::size_t station) const { return stations_[station].counts; }
    /// Unicasts that arrived, by hops from 1 on; the last counts all longer ways.
    static constexpr std::size_t kHopClasses = 8;
    const std::array<std::uint64_t, kHopClasses>& hops() const { return hops_; }

  private:
    struct Route {
        std::uint64_t next = 0;  ///< address of the next hop
        std::uint8_t hops = 0;
    };
    struct Station {
        std::map<std::uint64_t, Route> routes;
        std::deque<std::pair<std::uint64_t, std::uint16_t>> seen;  ///< origins and sequences, newest last
        std::map<std::uint64_t, std::uint64_t> requests;  ///< target: token of the request that is under way
        std::uint16_t sequence = 0x8000;  ///< of frames of the network layer itself; modules count below
        RandomStream delays;
        MeshCounts counts;
        explicit Station(RandomStream stream) : delays(stream) {}
    };
    /// A module's unicast whose fate is open.
    struct Packet {
        std::size_t station = 0;
        protocols::MeshFrame frame;
        int attempts = 0;
        std::uint8_t retries = 0;
        bool discovered = false;  ///< a route was looked for
        bool looked_again = false;
        std::uint64_t turn = 0;  ///< waits of earlier turns are void
    };
    enum class Purpose : std::uint8_t { Packet, Copies, Relay, Own };
    /// What a MAC job, a submission or a repetition is for.
    struct Job {
        Purpose purpose = Purpose::Own;
        std::uint64_t packet = 0;  ///< Packet
        protocols::MeshFrame frame;
        int copies = 0;        ///< still to be sent after this one
        bool reports = false;  ///< a module's own broadcast
        std::size_t station = 0;
    };

    void received(std::size_t station, const protocols::MeshFrame& frame, const Heard& heard) override;
    void sent(std::size_t station, std::uint64_t token, bool delivered, bool busy, cosim::Time now) override;
    void happen(const Event& event);

    bool seen_before(std::size_t station, const protocols::MeshFrame& frame);
    void heard_broadcast(std::size_t station, const protocols::MeshFrame& frame, const Heard& heard);
    void heard_unicast(std::size_t station, const protocols::MeshFrame& frame, const Heard& heard);
    void arrived(std::size_t station, const protocols::MeshFrame& frame, const Heard& heard);
    /// Before a copy of a broadcast goes out.
    cosim::Time random_delay(std::size_t station);
    void answer(std::size_t station, const protocols::MeshFrame& frame, protocols::MeshKind kind,
                cosim::Time now);
    void learn(std::size_t station, std::uint64_t target, const Route& route);
    /// Hands a job to the MAC at `at`.
    void submit_at(std::size_t station, Job job, cosim::Time at);
    void submit(std::size_t station, std::uint64_t token, cosim::Time now);
    void drop(std::size_t station, std::uint64_t token, cosim::Time now);
    void start(std::uint64_t packet, cosim::Time now);
    void look_for_route(std::uint64_t packet, cosim::Time now);
    void route_missing(std::size_t station, std::uint64_t token, cosim::Time now);
    void lost(std::uint64_t packet, std::uint8_t delivery, cosim::Time now);
    void end(std::uint64_t packet, std::uint8_t delivery, cosim::Time now);
    const RadioSettings& settings(std::size_t station) const { return mac_.settings(station); }

    cosim::Time processing_;
    MeshUser& user_;
    Agenda agenda_;
    Mac mac_;
    std::vector<Station> stations_;
    std::map<std::uint64_t, Packet> packets_;
    std::map<std::uint64_t, Job> jobs_;
    std::uint64_t next_token_ = 1;
    std::array<std::uint64_t, kHopClasses> hops_{};
};

/// Longest time of one hop with a MAC's settings: manual, "Unicast one hop time", three retries at most.
cosim::Time one_hop_time(const RadioSettings& settings);
/// Manual, "Transmitting a broadcast" and "Transmitting a unicast with a known route".
cosim::Time broadcast_time(const RadioSettings& settings);
cosim::Time known_route_time(const RadioSettings& settings);

}  // namespace puckloop::radio
