#pragma once
// Which infra-red frames became messages, and why the others did not.
//
// The medium's ir.csv lists which frames were on the air and how each board could hear them; the register
// traffic in trace.csv lists which messages the hosts fetched. A message belongs to the earliest frame that
// could be heard, carried its bytes and ended within the time that the firmware needs before the poll. For a
// frame without a message the conditions it met are counted; the first of the list that applies is its cause.

#include "traces/rab_losses/messages.h"

#include <array>
#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace puckloop::tools {

enum class Cause : std::uint8_t {
    BelowThreshold,   ///< no receiver saw enough carrier
    QueueFull,        ///< ten messages waited: the receiver's host polled too slowly
    Collision,        ///< another board's frame overlapped it at the receiver
    ReceiverPeaks,    ///< the receiver still read the peak detectors after the frame before
    ReceiverI2c,      ///< the receiver's processor served the I2C bus meanwhile
    SenderI2c,        ///< the sender's did: chips came late
    ReceiverSending,  ///< the receiver sent meanwhile
    AfterError,       ///< the frame before was spoilt: the decoder may have been left in the middle of it
    Other,            ///< samples at the edges of chips, clocks that differ
};
inline constexpr std::size_t kCauses = 9;
/// "below_threshold", ...
std::string_view name_of(Cause cause);

/// One frame as one board could hear it: a row of ir.csv.
struct HeardFrame {
    cosim::Time start = 0, end = 0;
    std::string sender, receiver;
    double distance = 0.0;  ///< m
    bool heard = false, overlapped = false, receiver_sending = false;
};

/// What became of a frame.
struct Fate {
    HeardFrame frame;
    bool delivered = false;
    cosim::Time fetched = 0;          ///< by the host, if delivered
    Cause cause = Cause::Other;       ///< of a loss
    std::array<bool, kCauses> met{};  ///< conditions, whatever became of the frame
};

/// The traffic of one board.
struct BoardTraffic {
    std::vector<Busy> busy;
    std::vector<Send> sends;
    std::vector<Poll> polls;
};

struct Losses {
    std::vector<Fate> fates;
    /// Messages that belong to no frame, by receiver.
    std::map<std::string, std::uint64_t> unexplained;
};

/// `boards` by robot. Frames whose messages may not have been fetched yet at `end` are left out.
Losses explain(const std::vector<HeardFrame>& frames, const std::map<std::string, BoardTraffic>& boards,
               cosim::Time end);

}  // namespace puckloop::tools
