#pragma once
// The API frame of XBee modules on a serial line: start delimiter 7E, length (two bytes, high first), frame
// data, check byte (FF minus the sum of the data). With API mode 2 every 7E, 7D, 11 and 13 behind the start
// delimiter, length and check included, is sent as 7D and the byte exclusive-or 20.
// Source: TAM fact sheet, section 6.

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace puckloop::protocols {

/// The module's parameter AP.
enum class XBeeApiMode : std::uint8_t { Plain = 1, Escaped = 2 };

inline constexpr std::uint8_t kXBeeStart = 0x7E;
inline constexpr std::uint8_t kXBeeEscape = 0x7D;

/// The bytes of a frame on the line. `data` begins with the frame type; at most 65535 bytes.
std::vector<std::uint8_t> encode_xbee(std::span<const std::uint8_t> data, XBeeApiMode mode);

/// What a receiver can object to.
enum class XBeeFault : std::uint8_t {
    None,
    Noise,    ///< bytes before a start delimiter
    Restart,  ///< mode 2: a start delimiter inside the frame; it begins a new one
    Length,   ///< 0, or more than the receiver holds
    Check,    ///< the sum of data and check is not FF
    Short     ///< the bytes end inside the frame
};

/// "none", "noise", "restart", "length", "check", "short".
std::string_view name_of(XBeeFault fault);

struct XBeeReading {
    XBeeFault fault = XBeeFault::None;
    std::vector<std::uint8_t> data;  ///< frame data, without escapes; as far as it came
    std::uint64_t at = 0;            ///< the byte on the line, from 0, at which the frame ended or failed
    std::uint16_t length = 0;        ///< as the frame states it
    std::uint8_t check = 0;          ///< as received; Check only

    bool ok() const { return fault == XBeeFault::None; }
};

/// One line about a reading: "ok", or what is wrong and where.
std::string explain(const XBeeReading& reading);

/// A receiver: takes the line byte by byte.
class XBeeReader {
  public:
    /// Frames with more than `most` bytes of data are refused. A module's buffer is not documented; an RF
    /// payload has at most 73 bytes (NP), so that 256 is generous.
    explicit XBeeReader(XBeeApiMode mode, std::size_t most = 256) : mode_(mode), most_(most) {}

    /// A frame, or a fault, once `byte` completes it.
    std::optional<XBeeReading> take(std::uint8_t byte);
    /// No frame is under way.
    bool idle() const { return state_ == State::Idle; }
    /// The line ends here: what is left of a frame, or noise, if anything is.
    std::optional<XBeeReading> end();

  private:
    enum class State : std::uint8_t { Idle, LengthHigh, LengthLow, Data, Check };

    void start();
    XBeeReading give(XBeeFault fault);

    XBeeApiMode mode_;
    std::size_t most_;
    State state_ = State::Idle;
    bool escaped_ = false;
    bool noise_ = false;
    std::uint64_t taken_ = 0;
    std::uint8_t sum_ = 0;
    XBeeReading now_;
};

}  // namespace puckloop::protocols
