#pragma once
// How stations share the air: the distributed coordination function of IEEE 802.11-2016, clause 10.3. A
// station sends when the channel was free for a gap (DIFS; EIFS after a frame that it could not read) and,
// unless it was free anyway, for a drawn number of slots more; a count stops while the channel is busy. A
// frame to one station is acknowledged after a SIFS, or sent again after a count from twice the window.
//
// Deviations: 1. No RTS and CTS, fragments, power saving, beacons or joining. 2. A rate is chosen by the
// power that arrives, not by what was lost. 3. All clocks agree, and light takes no time. 4. Who sends to a
// station that is away goes on as with one out of range: nobody leaves a network or joins another one.

#include "emu/wifi/medium.h"

#include <cstdint>
#include <deque>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace puckloop::wifi {

/// Counted for each station.
struct DcfCounts {
    std::uint64_t frames = 0;  ///< sent, with those sent again and acknowledgements
    std::uint64_t again = 0;   ///< of them, a further attempt
    std::uint64_t acks = 0;
    std::uint64_t dropped = 0;     ///< not acknowledged in any attempt
    std::uint64_t queue_full = 0;  ///< not taken
    std::uint64_t read = 0;        ///< frames meant for it
    std::uint64_t twice = 0;       ///< of them, read before
    Losses losses;
    cosim::Time air = 0;  ///< its frames took
};

/// Who uses the stations, and who writes down what becomes of frames.
class DcfUser {
  public:
    virtual ~DcfUser() = default;
    /// A frame begins; `frame` is null for an acknowledgement.
    virtual void began(const Transmission& sent, const Frame* frame) = 0;
    /// A frame that `station` read for the first time.
    virtual void received(std::size_t station, const Frame& frame, const Transmission& last) = 0;
    /// What became of a frame at one that it was meant for.
    virtual void became(const Transmission& sent, std::size_t station, Fate fate) = 0;
    /// Nobody acknowledged it.
    virtual void dropped(std::size_t station, const Frame& frame, cosim::Time now) = 0;
};

class Dcf {
  public:
    /// Each station keeps `queue` frames that wait. Throws InputError for settings that cannot be.
    Dcf(const WifiSettings& settings, const std::vector<std::string>& names,
        const std::vector<Position>& positions, std::int64_t queue, std::uint64_t seed, DcfUser& user);

    Medium& medium() { return medium_; }
    const Phy& phy() const { return phy_; }
    struct Bursts {
        std::uint64_t count = 0;  ///< of interference, begun
        cosim::Time air = 0;      ///< they take
    };
    const Bursts& bursts() const { return bursts_; }
    const DcfCounts& counts(std::size_t station) const { return stations_[station].counts; }

    /// Of a frame to that station, as the power is now.
    const Rate& rate_for(std::size_t station, std::size_t hop_to) const;
    /// So much power arrives, each way, that a frame with the slowest rate is hardly ever lost in noise.
    bool is_neighbour(std::size_t a, std::size_t b) const;
    /// Of a packet of so many octets to one station, from the gap before it to its acknowledgement.
    cosim::Time time_of(std::size_t octets, const Rate& rate) const;

    /// A frame for the station's queue; false: it is full.
    bool submit(std::size_t station, Frame frame, cosim::Time now);
    /// A station that is away reads nothing and sends nothing; what it kept, and that is returned, is lost.
    /// A frame that it sends already goes to its end.
    std::vector<Frame> set_away(std::size_t station, bool away);
    /// When something happens next; kNever.
    cosim::Time next() const { return outlook().next; }
    /// Does it.
    void step();
    /// No frame is read before, if nothing is submitted.
    cosim::Time earliest_end() const { return outlook().end; }

  private:
    struct Station {
        std::deque<Frame> queue;
        std::int64_t attempts = 0;  ///< made for the first of the queue
        std::int64_t window = 0, count = 0;
        cosim::Time base = 0;  ///< the count runs from here
        cosim::Time busy_until = 0;
        bool unread = false;  ///< the last frame on the channel
        bool sends = false;   ///< the first of the queue is on air or waits for its acknowledgement
        bool away = false;
        cosim::Time plan = cosim::kNever;     ///< it sends then
        cosim::Time give_up = cosim::kNever;  ///< no acknowledgement has come by then
        cosim::Time ack_due = cosim::kNever;  ///< it sends one then
        std::size_t ack_for = 0;
        std::int64_t ack_attempt = 0;
        const Rate* ack_rate = nullptr;
        cosim::Time noticed = 0;  ///< the channel became busy so short ago that it does not know yet ...
        bool was_free = false;    ///< ... and until then it might have sent at once
        std::vector<std::uint64_t> last;  ///< number of the last frame of each other one, plus 1
        DcfCounts counts;
        RandomStream backoff, noise;
        Station(RandomStream backoff_stream, RandomStream noise_stream)
            : backoff(backoff_stream), noise(noise_stream) {}
    };

    /// What next() and earliest_end() say: asked for with every message, while little happens on the air.
    struct Outlook {
        cosim::Time next = cosim::kNever, end = cosim::kNever;
    };
    const Outlook& outlook() const;

    void draw(Station& station);
    void plan(Station& station, cosim::Time now);
    void rebase(Station& station, cosim::Time at_least);
    void found_busy(Station& station, cosim::Time start, cosim::Time end);
    void put_on_air(Transmission transmission);
    void plan_burst(cosim::Time after);
    void burst(cosim::Time now);
    void burst_ended(cosim::Time now, double dbm);
    void send(std::size_t station, cosim::Time now);
    void acknowledge(std::size_t station, cosim::Time now);
    void ended(std::size_t on_air);
    void heard(const Transmission& sent, std::size_t station, Fate fate);
    void meant_for(const Transmission& sent, const Frame* frame, std::size_t station, Fate fate);
    void succeeded(std::size_t station, cosim::Time now);
    void failed(std::size_t station, cosim::Time now);
    void next_frame(Station& station, cosim::Time now);

    WifiSettings settings_;
    Phy phy_;
    Medium medium_;
    DcfUser& user_;
    std::int64_t queue_;
    std::vector<Station> stations_;
    std::uint64_t transmissions_ = 0;
    RandomStream burst_random_;
    cosim::Time next_burst_ = cosim::kNever;
    Bursts bursts_;
    mutable std::optional<Outlook> outlook_;  ///< nothing: something has happened since
};

}  // namespace puckloop::wifi
