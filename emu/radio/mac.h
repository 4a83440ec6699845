#pragma once
// The MAC of every module on the medium: unslotted CSMA-CA, acknowledgements, retries.
// Sources: IEEE 802.15.4-2006, sections 6.4.2, 7.4.2 and 7.5.1.4 (times and constants); XBee/XBee-PRO
// DigiMesh 2.4 manual (90000991): CA, RR.
//
// Deviations:
// 1. Whether RR = 0 or a busy channel use up an attempt the manual does not say; here they do.
// 2. A frame on air is given up by neither side; a receiver locks on to no weaker frame first.

#include "base/random.h"
#include "cosim/core/time.h"
#include "emu/radio/agenda.h"
#include "emu/radio/air_faults.h"
#include "emu/radio/control.h"
#include "emu/radio/medium.h"
#include "protocols/radio/mesh_frame.h"

#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace puckloop::radio {

inline constexpr cosim::Time kSymbol = 16 * cosim::kMicrosecond;
inline constexpr cosim::Time kOctet = 2 * kSymbol;
inline constexpr cosim::Time kTurnaround = 12 * kSymbol;  ///< aTurnaroundTime
inline constexpr cosim::Time kAckWait = 54 * kSymbol;     ///< macAckWaitDuration
inline constexpr std::size_t kPhyOctets = 6;              ///< preamble, delimiter, length

/// Time on air of a PHY payload.
constexpr cosim::Time air_time(std::size_t octets) {
    return static_cast<cosim::Time>(kPhyOctets + octets) * kOctet;
}

/// Counted for each station.
struct MacCounts {
    std::uint64_t frames = 0;  ///< sent, retries included
    std::uint64_t acks = 0;    ///< sent
    std::uint64_t retries = 0;
    std::uint64_t failures = 0;      ///< unicasts without an acknowledgement after all retries
    std::uint64_t channel_busy = 0;  ///< attempts that found no free channel
    std::uint64_t received = 0;      ///< for this station or everybody
    std::uint64_t duplicates = 0;    ///< of these, received before
    air::Losses losses;              ///< of noise: other users of the band among them
    std::uint64_t dropped = 0;       ///< forgotten when the module was reset or switched off
};

/// What a received frame came with.
struct Heard {
    double dbm = 0.0;
    cosim::Time start = 0, end = 0;
};

/// The network layer, as the MAC sees it.
class MacUser {
  public:
    virtual ~MacUser() = default;
    virtual void received(std::size_t station, const protocols::MeshFrame& frame, const Heard& heard) = 0;
    /// The job's fate; `token` as submitted.
    virtual void sent(std::size_t station, std::uint64_t token, bool delivered, bool channel_busy,
                      cosim::Time now) = 0;
};

class Mac {
  public:
    Mac(Medium& medium, Agenda& agenda, const std::vector<std::string>& names, std::uint64_t seed,
        AirFaults& faults, MacUser& user);
    Mac(const Mac&) = delete;
    Mac& operator=(const Mac&) = delete;

    /// A station that is switched off, or to another channel or PAN, forgets what it was to send: the tokens
    /// of these jobs, for which no sent() follows.
    std::vector<std::uint64_t> set(std::size_t station, const RadioSettings& settings);
    const RadioSettings& settings(std::size_t station) const { return stations_[station].settings; }
    /// Sends a frame to frame.hop_to; sent() follows.
    void submit(std::size_t station, const protocols::MeshFrame& frame, std::uint64_t token, cosim::Time now);
    /// Access, NoAccess, FrameEnd, AckEnd and AckMissing.
    void happen(const Event& event);
    /// The earliest time at which what happens at `event` can reach a module.
    static cosim::Time earliest_end(const Event& event);
    const MacCounts& counts(std::size_t station) const { return stations_[station].counts; }

  private:
    struct Job {
        protocols::MeshFrame frame;
        std::uint64_t token = 0;
        int attempts = 0;
    };
    struct Station {
        RadioSettings settings;
        std::deque<Job> queue;
        std::uint64_t turn = 0;  ///< counts what the first job waits for; events of earlier turns are void
        int backoffs = 0, exponent = 0;
        std::uint8_t sequence = 0;
        std::map<std::uint64_t, std::uint8_t> last_heard;  ///< MAC sequence by sender
        MacCounts counts;
        RandomStream backoff, noise;
        Station(RandomStream backoff_stream, RandomStream noise_stream)
            : backoff(backoff_stream), noise(noise_stream) {}
    };
    /// A frame on air, to its end.
    struct Flying {
        Transmission transmission;
        protocols::MeshFrame frame;
        std::uint64_t turn = 0;
    };

    void attempt(std::size_t station, cosim::Time now);
    void back_off(std::size_t station, cosim::Time now);
    void access(std::size_t station, cosim::Time now);
    void transmit(std::size_t station, cosim::Time start);
    void frame_end(std::uint64_t id, cosim::Time now);
    void ack_end(std::uint64_t id, cosim::Time now);
    void failed_attempt(std::size_t station, bool busy, cosim::Time now);
    void finish(std::size_t station, bool delivered, bool busy, cosim::Time now);
    void acknowledge(std::size_t station, const Flying& flying, cosim::Time now);
    /// True if the station reads the transmission that ends now. A fault may change `frame`, which is empty
    /// for an acknowledgement.
    bool reads(std::size_t station, const Transmission& transmission,
               std::optional<protocols::MeshFrame>& frame);
    /// Whether it finds the channel busy.
    bool finds_busy(std::size_t station, cosim::Time now);

    Medium& medium_;
    Agenda& agenda_;
    AirFaults& faults_;
    MacUser& user_;
    std::vector<Station> stations_;
    std::map<std::uint64_t, Flying> flying_;
    std::uint64_t next_id_ = 1;
};

}  // namespace puckloop::radio
