#include "cosim/trace/link_stats.h"

#include <fmt/format.h>

#include <bit>
#include <cmath>

namespace puckloop::cosim {

namespace {

// Half a bit is lost after ten bits at 5 %; a receiver of 16 samples a bit gives up a little earlier.
constexpr double kReadableRateError = 0.04;

enum RecordedParity : std::uint8_t { kNoParity = 0, kOdd = 1 };

bool parity_fits(const UartFrame& frame) {
    if (frame.parity == kNoParity || frame.is_break) return true;
    const unsigned ones = static_cast<unsigned>(std::popcount(frame.data)) + frame.parity_bit;
    return (ones % 2 == 1) == (frame.parity == kOdd);
}

}  // namespace

void LinkStats::count(const TraceRecord& record, double nominal_baud) {
    if (record.fault != FaultKind::None) ++faults;
    if (puckloop::cosim::lost(record)) {
        ++lost;
        return;
    }
    ++messages;
    if (const auto* frame = std::get_if<UartFrame>(&record.payload)) {
        ++uart_frames;
        if (frame->is_break) ++uart_breaks;
        if (!parity_fits(*frame)) ++uart_parity_errors;
        const double ratio =
            static_cast<double>(frame->bit_period) * nominal_baud / static_cast<double>(kSecond);
        if (std::abs(ratio - 1.0) > kReadableRateError) ++uart_off_rate;
    } else if (const auto* phase = std::get_if<I2cPhase>(&record.payload)) {
        switch (phase->kind) {
        case I2cPhaseKind::Start:
            ++i2c_transactions;
            break;
        case I2cPhaseKind::Write:
        case I2cPhaseKind::Data:
            ++i2c_bytes;
            break;
        case I2cPhaseKind::Acknowledge:
            i2c_nacks += phase->ack == 0;
            break;
        case I2cPhaseKind::BusLost:
            ++i2c_bus_lost;
            break;
        case I2cPhaseKind::Read:
        case I2cPhaseKind::Stop:
            break;
        }
    } else if (const auto* radio = std::get_if<RadioFrame>(&record.payload)) {
        ++radio_frames;
        radio_octets += radio->octets.size();
    } else if (const auto* can = std::get_if<CanMessage>(&record.payload)) {
        can_offers += can->kind == CanKind::Offer;
        can_sent += can->kind == CanKind::Sent;
        can_received += can->kind == CanKind::Received;
        can_errors += can->kind == CanKind::Error;
    } else if (const auto* packet = std::get_if<Packet>(&record.payload)) {
        ++packets;
        packet_octets += packet->octets.size();
    } else {
        ++signals;
    }
}

std::string to_json(const LinkStats& s) {
    std::string text = fmt::format("{{\"messages\": {}", s.messages);
    const auto add = [&](const char* key, std::uint64_t value, bool always) {
        if (always || value != 0) text += fmt::format(", \"{}\": {}", key, value);
    };
    const bool uart = s.uart_frames != 0;
    add("uart_frames", s.uart_frames, false);
    add("uart_breaks", s.uart_breaks, uart);
    add("uart_parity_errors", s.uart_parity_errors, uart);
    add("uart_off_rate", s.uart_off_rate, uart);
    add("i2c_transactions", s.i2c_transactions, false);
    add("i2c_bytes", s.i2c_bytes, s.i2c_transactions != 0);
    add("i2c_nacks", s.i2c_nacks, false);
    add("i2c_bus_lost", s.i2c_bus_lost, false);
    add("signals", s.signals, false);
    add("radio_frames", s.radio_frames, false);
    add("radio_octets", s.radio_octets, false);
    add("packets", s.packets, false);
    add("packet_octets", s.packet_octets, false);
    add("can_offers", s.can_offers, false);
    add("can_sent", s.can_sent, false);
    add("can_received", s.can_received, false);
    add("can_errors", s.can_errors, false);
    add("faults", s.faults, false);
    add("lost", s.lost, false);
    return text + "}";
}

}  // namespace puckloop::cosim
