#pragma once
// Packets of GDB's remote serial protocol: "$DATA#CC", with "+" and "-" between and 0x03 for Ctrl-C.
// Source: GDB manual, appendix E, "Overview" and "Packet Acknowledgment".

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace puckloop::debug {

/// "$DATA#CC": what must not stand in a packet is escaped.
std::string rsp_packet(std::string_view data);

struct RspEvent {
    enum class Kind : std::uint8_t { Packet, Damaged, Again, Interrupt };
    Kind kind = Kind::Packet;  ///< Damaged: a wrong checksum; Again: "-", the last packet is wanted again
    std::string data{};        ///< of a packet, escapes taken back
};

class RspReader {
  public:
    /// Longer packets are damaged ones.
    static constexpr std::size_t kLongest = 0x10000;

    void feed(std::span<const char> bytes);
    /// The next event of what was fed.
    std::optional<RspEvent> next();

  private:
    enum class State : std::uint8_t { Between, Data, Escaped, High, Low };
    void take(char byte);

    State state_ = State::Between;
    std::string data_;
    std::uint8_t sum_ = 0, high_ = 0;
    bool damaged_ = false;
    std::vector<RspEvent> events_;
    std::size_t taken_ = 0;
};

/// A hexadecimal number from the front of `text`, which loses it; nothing where none stands, or more than 16
/// digits.
std::optional<std::uint64_t> take_hex(std::string_view& text);
/// Takes `c` from the front.
bool take_char(std::string_view& text, char c);
std::string to_hex(std::span<const std::uint8_t> bytes);
std::string to_hex(std::string_view text);
/// Pairs of digits; nothing for anything else.
std::optional<std::vector<std::uint8_t>> from_hex(std::string_view text);

}  // namespace puckloop::debug
