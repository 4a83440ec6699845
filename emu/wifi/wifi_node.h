#pragma once
// A wireless network between computers as a node: one port for each, to which its packets go, "world", where
// positions come in (physics/world/pose_signals.h), and "messages" for what an event of the scenario sends.
// With an access point all stations send to it, and it passes on; computers by wire are behind it. Without
// one each station sends to the other (ad-hoc), as far as it reaches, or over others between them (a mesh).
//
// Deviations (with those of dcf.h, medium.h, phy.h): 1. All stations have joined from the start. 2. Who has
// an address is known without asking (ARP). 3. In a mesh a packet for all is sent once more by each station
// that gets it, up to its hops; ways are found without frames (routes.h). 4. Wires carry everything at once.

#include "base/fields/field.h"
#include "cosim/core/node.h"
#include "cosim/core/seconds_form.h"
#include "emu/network/computers.h"
#include "emu/wifi/dcf.h"
#include "emu/wifi/frame_capture.h"
#include "emu/wifi/routes.h"

#include <nlohmann/json_fwd.hpp>

#include <cstdint>
#include <cstdio>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <unordered_map>
#include <utility>
#include <vector>

namespace puckloop::wifi {

/// A computer on the network.
struct WifiStation {
    network::Station computer{};
    Position at{};
    int pose = -1;
    bool wired = false;

    template <class Visitor>
    static constexpr auto fields(Visitor&& visit) {
        using S = WifiStation;
        return visit(part(&S::computer), field("at", &S::at, "where it is, at first").in("m"),
                     field("pose", &S::pose,
                           "signal of the world at which its place begins (x, y; m); -1: it does not move"),
                     field("wired", &S::wired, "by wire to the access point, without a radio"));
    }
};
static_assert(lists_all_fields<WifiStation>);

struct WifiSpec {
    static constexpr std::string_view kKind = "wifi";

    std::string name = "network";
    std::uint64_t seed = 1;
    int prefix = 24;
    cosim::Time latency = 500 * cosim::kMicrosecond;
    std::int64_t queue = 1000;
    WifiSettings settings{};
    std::optional<Position> access_point{};
    std::vector<WifiStation> stations{};
    std::vector<Obstacle> obstacles{};
    int first_shape = -1;
    std::string csv{};
    std::string pcapng{};
    std::string routes_csv{};
    std::vector<cosim::CarriedFault> faults{};

    template <class Visitor>
    static constexpr auto fields(Visitor&& visit) {
        using S = WifiSpec;
        return visit(field("name", &S::name, "of the node"), field("seed", &S::seed, "of the run"),
                     field("prefix", &S::prefix, "bits of the network's part of an address").within(8, 30),
                     field("latency_s", &S::latency, "from a packet's last octet to its arrival")
                         .in("s")
                         .above(0)
                         .as<cosim::Seconds>(),
                     field("queue", &S::queue, "packets that an interface keeps").at_least(1),
                     part(&S::settings), field("access_point", &S::access_point, "where it is; none: ad-hoc"),
                     field("stations", &S::stations, "the computers").required(),
                     field("obstacles", &S::obstacles, "walls and things in the way"),
                     field("first_shape", &S::first_shape,
                           "signal of the world at which shapes of things begin; -1: there are none"),
                     field("csv", &S::csv, "what became of frames; empty: none"),
                     field("routes_csv", &S::routes_csv, "ways through a mesh; empty: none"),
                     field("pcapng", &S::pcapng, "captured frames; empty: none"), unlisted(&S::faults));
    }
};
static_assert(lists_all_fields<WifiSpec>);

class WifiNode : public cosim::Node, private DcfUser {
  public:
    /// Throws InputError for settings that cannot be, RunError if the file cannot be written.
    explicit WifiNode(const WifiSpec& spec);
    ~WifiNode() override;
    WifiNode(const WifiNode&) = delete;
    WifiNode& operator=(const WifiNode&) = delete;

    std::string_view name() const override { return spec_.name; }
    std::span<const cosim::Port> ports() const override { return ports_; }
    void advance(cosim::Time until, std::span<const cosim::Message> inbox,
                 std::vector<cosim::Message>& outbox) override;
    cosim::Time earliest_output(cosim::PortIndex port) const override;
    cosim::Time lookahead(cosim::PortIndex port) const override;
    /// JSON: "stations": {name: counters}, "access_point": counters; with faults "faults"
    /// (cosim/faults/fault_json.h).
    std::string finish() override;

    const Dcf& dcf() const { return dcf_; }

  private:
    static constexpr std::size_t kNobody = ~std::size_t{0};
    /// A frame that a station gets at a time: by wire, behind one that `rate` holds up, or to be passed on
    /// in a mesh.
    struct Waiting {
        std::size_t station = 0;
        Frame frame;
    };

    struct Mesh {
        Routes routes;
        cosim::Time next_update = 0;
        RandomStream jitter;
        std::vector<std::set<std::uint64_t>> flooded{};  ///< of each station: packets for all that it had
        std::vector<std::uint64_t> passed_on{};          ///< by each station
        std::uint64_t changes = 0, no_way = 0;
        std::FILE* csv = nullptr;
    };

    void run(cosim::Time until);
    void take(std::size_t from, const cosim::Packet& packet, cosim::Time now);
    void place(const cosim::Signal& signal);
    void submit(std::size_t station, Frame frame, cosim::Time now);
    bool is_access_point(std::size_t station) const { return computer_of_[station] == kNobody; }
    void change_away(cosim::Time now);
    /// A frame was for the access point, or waited there, while it is away.
    void missed(const Frame& frame, cosim::Time now);
    void pass_on(const Frame& frame, cosim::Time now, const Transmission* last);
    void deliver(const Frame& frame, std::size_t computer, cosim::Time start, cosim::Time end);
    // wifi_mesh.cpp
    void begin_mesh();
    nlohmann::ordered_json mesh_report();
    void find_ways(cosim::Time now);
    void mesh_submit(std::size_t station, Frame frame, cosim::Time now);
    void mesh_received(std::size_t station, const Frame& frame, const Transmission& last);
    bool is_new_at(std::size_t station, std::uint64_t number);
    std::size_t computer_of(protocols::IpAddress to, std::size_t from) const;
    void began(const Transmission& sent, const Frame* frame) override;
    void received(std::size_t station, const Frame& frame, const Transmission& last) override;
    void became(const Transmission& sent, std::size_t station, Fate fate) override;
    void dropped(std::size_t station, const Frame& frame, cosim::Time now) override;
    void write(cosim::Time start, cosim::Time end, std::size_t from, std::string_view to,
               std::string_view kind, const Transmission* sent, double dbm, std::string_view fate);

    WifiSpec spec_;
    network::Computers computers_;
    std::vector<cosim::Port> ports_;
    std::vector<std::size_t> station_of_;   ///< of each computer; kNobody: it is wired
    std::vector<std::size_t> computer_of_;  ///< of each station; kNobody: the access point
    /// By signal of the world: of which station, 0: x, 1: y.
    std::unordered_map<int, std::pair<std::size_t, std::size_t>> coordinates_;
    std::vector<std::string> names_;  ///< of stations
    Dcf dcf_;
    std::map<std::pair<cosim::Time, std::uint64_t>, Waiting> waiting_;
    std::vector<cosim::Time> free_;  ///< of each computer: `rate` holds up its packets until then
    std::uint64_t packets_ = 0, waits_ = 0;
    std::vector<cosim::Time> away_changes_;  ///< when the access point goes away or comes back
    std::size_t next_away_ = 0;              ///< of these
    bool away_ = false;
    cosim::Time last_start_ = 0;
    cosim::Time granted_ = 0;
    bool any_wired_ = false;
    std::optional<Mesh> mesh_;
    std::FILE* csv_ = nullptr;
    std::optional<FrameCapture> capture_;
};

}  // namespace puckloop::wifi
