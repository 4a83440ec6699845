#pragma once
// What went over a link, counted as it stood on the wire; what a receiver made of it is the receiver's to
// count.

#include "cosim/trace/trace.h"

#include <cstdint>
#include <string>

namespace puckloop::cosim {

/// One direction of a link.
struct LinkStats {
    std::uint64_t messages = 0;     ///< that arrived
    std::uint64_t uart_frames = 0;  ///< breaks included
    std::uint64_t uart_breaks = 0;
    std::uint64_t uart_parity_errors = 0;  ///< parity bit on the wire does not fit the data
    std::uint64_t uart_off_rate = 0;  ///< sender's rate more than 4 % off the link's nominal: cannot be read
    std::uint64_t i2c_transactions = 0;  ///< START and repeated START
    std::uint64_t i2c_bytes = 0;         ///< written by or returned to a master, addresses not counted
    std::uint64_t i2c_nacks = 0;         ///< to a master
    std::uint64_t i2c_bus_lost = 0;
    std::uint64_t signals = 0;
    std::uint64_t radio_frames = 0;
    std::uint64_t radio_octets = 0;  ///< of their PHY payloads
    std::uint64_t can_offers = 0;    ///< frames that a controller wanted to send
    std::uint64_t can_sent = 0;      ///< reported to it, as the next two
    std::uint64_t can_received = 0, can_errors = 0;
    std::uint64_t packets = 0;        ///< of a network
    std::uint64_t packet_octets = 0;  ///< IP headers included
    std::uint64_t faults = 0;         ///< messages harmed by a fault
    std::uint64_t lost = 0;           ///< of these, kept from arriving

    void count(const TraceRecord& record, double nominal_baud);
    friend bool operator==(const LinkStats&, const LinkStats&) = default;
};

/// One JSON object; counters that are zero and belong to another kind of link are left out.
std::string to_json(const LinkStats& stats);

}  // namespace puckloop::cosim
