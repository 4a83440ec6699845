#pragma once
// The air between Bluetooth devices: who finds whom, who is linked with whom, and when what arrives.
//
// Deviations:
// 1. Within `range` everything works, beyond it nothing: no packet is damaged on the air, it only waits (as
//    observed: once linked every packet arrived). Walls and other radios do not matter.
// 2. Links do not share the air: each has its own latency, and no limit of rate beside the serial lines.
// 3. Drawn times: times.h.

#include "base/random.h"
#include "emu/bluetooth/agenda.h"
#include "emu/bluetooth/times.h"

#include <array>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace puckloop::bluetooth {

using Address = std::array<std::uint8_t, 6>;      ///< the low octet first, as in packets
using DeviceClass = std::array<std::uint8_t, 3>;  ///< likewise
using Bytes = std::vector<std::uint8_t>;
using LinkId = std::uint64_t;  ///< never used twice

// RFCOMM: results of a connection attempt, reasons of a release (LMX98xx software user's guides).
inline constexpr std::uint8_t kRfcommOk = 0, kRfcommInvalidPort = 2, kRfcommFailed = 3, kRfcommRejected = 4,
                              kRfcommNobody = 5;
inline constexpr std::uint8_t kReleasedHere = 0, kReleasedThere = 1, kLinkLost = 2;

/// A device: what others see of it, and what happens to it.
class Station {
  public:
    virtual ~Station() = default;

    virtual std::string_view name() const = 0;  ///< the robot's or the computer's, for logs and streams
    virtual Address address() const = 0;
    virtual DeviceClass device_class() const = 0;
    virtual std::string friendly_name() const = 0;
    virtual bool discoverable() const = 0;
    virtual bool connectable() const = 0;
    /// kRfcommOk if a link to this port could be had.
    virtual std::uint8_t port_state(std::uint8_t port) const = 0;
    /// Links need a key that both have, or a PIN that both know.
    virtual bool authenticates() const = 0;
    virtual std::string pin(const Address& peer) const = 0;
    virtual bool has_key(const Address& peer) const = 0;
    virtual void keep_key(const Address& peer) = 0;
    /// How long a link may be silent before it is lost.
    virtual cosim::Time link_timeout() const = 0;

    virtual void found(const Address& address, const DeviceClass& device_class, cosim::Time now) = 0;
    virtual void inquiry_over(cosim::Time now) = 0;
    virtual void named(const Address& address, const std::optional<std::string>& name, cosim::Time now) = 0;
    /// The end of an attempt by this station; `link` is 0 if `status` is not kRfcommOk.
    virtual void linked(const Address& peer, std::uint8_t port, std::uint8_t remote_port, std::uint8_t status,
                        LinkId link, cosim::Time now) = 0;
    virtual void incoming(const Address& peer, std::uint8_t port, LinkId link, cosim::Time now) = 0;
    virtual void received(LinkId link, const Bytes& bytes, cosim::Time now) = 0;
    virtual void released(LinkId link, std::uint8_t reason, cosim::Time now) = 0;
    /// An event of the station's own.
    virtual void happen(const Event& event, cosim::Time now) = 0;
};

struct NetworkCounts {
    std::uint64_t inquiries = 0, found = 0, missed = 0;  ///< missed: in range, but not in time
    std::uint64_t names = 0, names_missing = 0;
    std::uint64_t attempts = 0, links = 0, not_found = 0, refused = 0;
    std::uint64_t lost = 0, bytes = 0, bytes_lost = 0;
};

/// What happened on the air: time, who, what, with whom, since when.
using AirLog = std::function<void(cosim::Time at, std::string_view who, std::string_view what,
                                  std::string_view whom, cosim::Time since)>;

class Network {
  public:
    /// `range` in m.
    Network(const Times& times, double range, std::uint64_t seed, AirLog log);
    Network(const Network&) = delete;
    Network& operator=(const Network&) = delete;

    /// Its number, which counts from 0. `station` stays.
    std::size_t add(Station& station);
    Station& station(std::size_t number) { return *members_[number].station; }
    Agenda& agenda() { return agenda_; }
    const Agenda& agenda() const { return agenda_; }
    const Times& times() const { return times_; }
    const NetworkCounts& counts() const { return counts_; }

    /// Where a station is, m. One that was never placed is near everybody.
    void place(std::size_t station, std::array<double, 2> at, cosim::Time now);

    /// Devices answer within `length`, at most `most` of them (0: any number).
    void inquire(std::size_t station, cosim::Time length, unsigned most, cosim::Time now);
    void ask_name(std::size_t station, const Address& address, cosim::Time now);
    void connect(std::size_t station, const Address& address, std::uint8_t port, std::uint8_t remote_port,
                 cosim::Time now);
    void send(std::size_t station, LinkId link, Bytes bytes, cosim::Time now);
    void release(std::size_t station, LinkId link, cosim::Time now);
    /// It forgets everything and is silent on its links.
    void gone(std::size_t station, cosim::Time now);

    /// Carries out the first event.
    void step();

  private:
    struct Ask {
        Address address{};
        std::uint8_t port = 0, remote_port = 0;
        cosim::Time since = 0;
    };
    struct Inquiry {
        std::uint64_t token = 0;  ///< 0: none
        unsigned most = 0, found = 0;
        cosim::Time since = 0;
    };
    struct Member {
        Station* station = nullptr;
        std::optional<std::array<double, 2>> at{};
        RandomStream discovery, name, link, release;
        Inquiry inquiry{};
        std::map<std::uint64_t, Ask> asks{};  ///< name requests and connection attempts
    };
    struct Link {
        std::array<std::size_t, 2> ends{};
        std::array<bool, 2> there{true, true};
        bool heard = true;                        ///< in range, and both there
        std::uint64_t turn = 0;                   ///< counts outages
        std::array<bool, 2> resumes{};            ///< heard again; what is held of either end comes first
        std::array<std::deque<Bytes>, 2> held{};  ///< sent by either end, not yet through
        cosim::Time since = 0;
    };

    bool near(std::size_t a, std::size_t b) const;
    /// Who has this address, listens and is near.
    std::optional<std::size_t> reach(std::size_t station, const Address& address) const;
    void happen(const Event& event, cosim::Time now);
    void answer_inquiry(const Event& event, cosim::Time now);
    void end_inquiry(std::size_t station, cosim::Time now);
    void name_through(const Event& event, cosim::Time now);
    void link_through(const Event& event, cosim::Time now);
    std::uint8_t admit(std::size_t from, std::size_t to, std::uint8_t remote_port);
    void deliver(const Event& event, cosim::Time now);
    void look_at(LinkId id, Link& link, cosim::Time now);
    void end_link(LinkId id, std::array<std::uint8_t, 2> reasons, std::string_view what, cosim::Time now);
    void note(cosim::Time now, std::size_t who, std::string_view what, std::string_view whom,
              cosim::Time since);
    std::string name_of(const Address& address) const;

    Times times_;
    double range_;
    std::uint64_t seed_;
    AirLog log_;
    Agenda agenda_;
    std::vector<Member> members_;
    std::map<LinkId, Link> links_;
    std::uint64_t next_token_ = 1;
    NetworkCounts counts_;
};

}  // namespace puckloop::bluetooth
