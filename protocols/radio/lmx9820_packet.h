#pragma once
// Packets between a Bluetooth module LMX9820A and its host: 02, type, opcode, data length (16 bits, low octet
// first), check (low octet of the sum of the four octets before), data, 03.
// Sources: LMX9820A data sheet, section 12.1; opcodes and error codes as the LMX98xx software user's guides
// list them (AN-1699 for the LMX9838, the sibling with the same command set).

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace puckloop::protocols {

using LmxBytes = std::vector<std::uint8_t>;

inline constexpr std::uint8_t kLmxStart = 0x02, kLmxEnd = 0x03;
inline constexpr std::size_t kMostLmxData = 333;  ///< data octets of a packet
inline constexpr std::size_t kLmxFrame = 7;       ///< octets of a packet without data

// Packet types.
inline constexpr std::uint8_t kLmxRequest = 0x52, kLmxConfirm = 0x43, kLmxIndication = 0x69,
                              kLmxResponse = 0x72;

struct LmxPacket {
    std::uint8_t type = kLmxRequest;
    std::uint8_t opcode = 0;
    LmxBytes data{};

    friend bool operator==(const LmxPacket&, const LmxPacket&) = default;
};

/// Data beyond kMostLmxData is cut off.
LmxBytes encode_lmx(const LmxPacket& packet);

/// The first thing wrong with a packet.
enum class LmxFault : std::uint8_t { None, Check, Type, Length, End };
std::string_view to_text(LmxFault fault);

struct LmxReading {
    LmxPacket packet;
    LmxFault fault = LmxFault::None;
    bool ok() const { return fault == LmxFault::None; }
};

/// Reads packets octet by octet. Octets between packets are ignored; behind a packet that is wrong the
/// next 02 begins a new one, the octet that showed it included.
class LmxReader {
  public:
    /// A packet that this octet ends, whole or wrong.
    std::optional<LmxReading> take(std::uint8_t octet);
    /// Nothing of a packet has come.
    bool idle() const { return octets_.empty(); }
    void clear() { octets_.clear(); }

  private:
    LmxReading give(LmxFault fault, std::uint8_t octet);
    LmxBytes octets_;
};

/// "GAP_INQUIRY"; "0x7f" for an opcode that is in no list.
std::string lmx_opcode_name(std::uint8_t opcode);
/// "NAME_TOO_LONG"; "0x7f" for a code that is in no list.
std::string lmx_error_name(std::uint8_t error);
/// "REQ GAP_INQUIRY length=5 responses=10 mode=0": a line for people.
std::string to_text(const LmxPacket& packet);
/// "08:00:17:2C:00:01" of six octets, the low one first.
std::string lmx_address_text(std::span<const std::uint8_t> address);

}  // namespace puckloop::protocols
