#pragma once
// What travels on links: time-stamped frames and signal changes, plain values that any process can carry.

#include "cosim/core/octets.h"
#include "cosim/core/time.h"

#include <array>
#include <cstdint>
#include <type_traits>
#include <variant>

namespace puckloop::cosim {

using PortIndex = std::uint16_t;

/// One asynchronous character as it stood on the wire, in the sender's own bit time. The receiver samples it
/// with its own baud-rate generator. Sent when its stop bit begins (see docs/architecture.md, "UART on a
/// link").
struct UartFrame {
    Time start = 0;               ///< falling edge of the start bit
    Time bit_period = 0;          ///< of the sender, in picoseconds
    std::uint16_t data = 0;       ///< 5 to 9 data bits, first on the wire = bit 0
    std::uint8_t data_bits = 8;   ///< 5..9
    std::uint8_t parity = 0;      ///< 0 none, 1 odd, 2 even
    std::uint8_t stop_bits = 1;   ///< 1 or 2
    std::uint8_t parity_bit = 0;  ///< level of the parity bit on the wire, if any
    std::uint8_t is_break = 0;    ///< 1: the line was low for the whole frame, stop bits included
    // What only a damaged line does; levels in protocols/serial/uart_sampling.h.
    std::uint8_t line = 0;           ///< of kLineInverted and kLineRestsLow
    std::uint32_t glitch_at = 0;     ///< ns from `start`: the level is the other one from there on ...
    std::uint32_t glitch_width = 0;  ///< ... for so many ns; 0: no glitch

    friend bool operator==(const UartFrame&, const UartFrame&) = default;
};
inline constexpr std::uint8_t kLineInverted = 1;  ///< every level of the frame is the other one
inline constexpr std::uint8_t kLineRestsLow = 2;  ///< the line stays low behind the frame, until the next
/// How the three are written: a byte, and the glitch if there is one. 0 for what a sound line carries.
inline constexpr std::uint8_t kFlagBreak = 1, kFlagGlitch = 8, kMostUartFlags = 15;
constexpr std::uint8_t uart_flags(const UartFrame& frame) {
    return static_cast<std::uint8_t>(frame.is_break | frame.line << 1 |
                                     (frame.glitch_width != 0 ? kFlagGlitch : 0));
}
constexpr void set_uart_flags(UartFrame& frame, std::uint8_t flags) {
    frame.is_break = flags & kFlagBreak;
    frame.line = flags >> 1 & (kLineInverted | kLineRestsLow);
}
/// Levels that a frame or a break of a sound line has.
constexpr bool is_sound(const UartFrame& frame) {
    return frame.line == 0 && frame.glitch_width == 0;
}

/// One phase of an I2C transfer on the shared bus.
enum class I2cPhaseKind : std::uint8_t {
    Start,        ///< master: START or repeated START, then `byte` = address<<1 | read
    Write,        ///< master: one data byte to the slave
    Read,         ///< master: clocks one byte out of the slave and answers with `ack`
    Stop,         ///< master: STOP
    Acknowledge,  ///< to the master: the slave's (or nobody's) ACK of the last Start or Write
    Data,         ///< to the master: the byte that a Read returned
    BusLost,      ///< to the master: arbitration lost or bus stuck
};

inline constexpr std::uint8_t kMostI2cAck = 0x89;  ///< of I2cPhase::ack

struct I2cPhase {
    I2cPhaseKind kind = I2cPhaseKind::Stop;
    std::uint8_t byte = 0;  ///< address byte or data
    std::uint8_t ack = 0;   ///< 1: acknowledged (SDA low in the ninth clock); more: cosim/i2c/i2c_shared.h
    Time start = 0;         ///< when the phase began on the bus
    Time clock_period = 0;  ///< of the master's SCL, in picoseconds
    Time stretch = 0;       ///< how long the slave held SCL beyond the master's clock

    friend bool operator==(const I2cPhase&, const I2cPhase&) = default;
};

/// A change of one of a board's named signals. `id` indexes the signal list that both ends of the link share;
/// the value is in that signal's unit.
struct Signal {
    std::uint16_t id = 0;
    double value = 0.0;

    friend bool operator==(const Signal&, const Signal&) = default;
};

/// A frame of the 2.4 GHz radio (IEEE 802.15.4 O-QPSK: 250 kbit/s). What its octets mean is the radio's own
/// (protocols/radio/mesh_frame.h for the XBee mesh). A module hands it to the medium stamped when it wants to
/// transmit; the medium hands it on stamped when it ends.
struct RadioFrame {
    Time start = 0;            ///< the preamble begins
    Time duration = 0;         ///< on air, preamble to last octet
    Octets octets;             ///< the PHY payload, 1 to 127
    std::uint8_t channel = 0;  ///< 11..26
    std::int8_t dbm = 0;       ///< from a module: what it sends with; to a module: what it receives with

    friend bool operator==(const RadioFrame&, const RadioFrame&) = default;
};
/// Longest PHY payload, 802.15.4 aMaxPHYPacketSize.
inline constexpr std::size_t kMostRadioOctets = 127;

/// What a CAN controller and its bus send each other. The bus (cosim/can/can_bus.h) is bit by bit: it carries
/// out arbitration, acknowledgement, error frames and error counters; what crosses a link is what a
/// controller wants and what became of it.
enum class CanKind : std::uint8_t {
    Join,      ///< to the bus: takes part from now on; `bit_time`, data = quanta of a bit, of them before the
               ///< sample, quanta of a jump; flag Listens
    Watch,     ///< to the bus: off, but wants Wake
    Leave,     ///< to the bus: off
    Offer,     ///< to the bus: this frame is to be sent, in place of one offered before that has not begun
    Withdraw,  ///< to the bus: nothing is to be sent; a frame under way is not repeated
    Sent,      ///< the frame `tag` ended well
    Received,  ///< somebody else's frame ended well
    Error,     ///< an error frame is over; flag Sender: it was this controller's frame `tag`
    Withdrawn,  ///< the frame `tag` will not be sent
    Recovered,  ///< bus-off is over
    Wake,       ///< the bus stirred while this controller watched
};

struct CanMessage {
    Time start = 0;                      ///< of the frame, as this controller saw it; else of the message
    std::array<std::uint8_t, 8> data{};  ///< of the frame
    std::uint32_t id = 0;                ///< as CanFrame::id (protocols/can/can_frame.h)
    std::uint32_t bit_time = 0;          ///< of the controller, ps; at most 4.29 ms
    std::uint16_t transmit_errors = 0;   ///< from the bus: the counter; 256 and more: bus-off
    std::uint8_t receive_errors = 0;
    CanKind kind = CanKind::Leave;
    std::uint8_t length = 0;    ///< DLC: 0..8
    std::uint8_t flags = 0;     ///< of kCanExtended .. kCanListens, and from bit 5 on protocols::CanError
    std::uint8_t tag = 0;       ///< the controller's name for the frame offered: a transmit buffer
    std::uint8_t position = 0;  ///< Error: bits from the start of frame to the one in which it was found

    friend bool operator==(const CanMessage&, const CanMessage&) = default;
};
inline constexpr std::uint8_t kCanExtended = 1, kCanRemote = 2;
inline constexpr std::uint8_t kCanLost = 4;  ///< `tag` lost arbitration on the way
/// Error: the controller sent `tag`. Join: it listens only.
inline constexpr std::uint8_t kCanSender = 8, kCanListens = 8;
inline constexpr std::uint8_t kCanGone = 16;  ///< `tag` had been withdrawn and is not sent again
inline constexpr int kCanErrorShift = 5, kMostCanError = 5;

/// An IPv4 packet (protocols/network/ip_packet.h). A computer hands it to its network stamped when its
/// interface takes it; the network hands it on stamped when it arrives.
struct Packet {
    Time start = 0;     ///< from a computer: when it was handed over; to one: when its transmission began
    Time duration = 0;  ///< to a computer: of that transmission
    Octets octets;      ///< header and payload, 20 to 1500

    friend bool operator==(const Packet&, const Packet&) = default;
};
inline constexpr std::size_t kFewestPacketOctets = 20, kMostPacketOctets = 1500;

using Payload = std::variant<UartFrame, I2cPhase, Signal, RadioFrame, CanMessage, Packet>;
// Messages are copied byte by byte in every grant: keep them small and plain.
static_assert(std::is_trivially_copyable_v<Payload> && sizeof(Payload) == 40);

/// `port` is the sender's port in an outbox and the receiver's port in an inbox.
struct Message {
    Time time = 0;
    PortIndex port = 0;
    Payload payload;

    friend bool operator==(const Message&, const Message&) = default;
};

}  // namespace puckloop::cosim
