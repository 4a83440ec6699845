#pragma once
// The frames of a recorded trace by protocol, with what is wrong in them.
//
// Which protocol a UART speaks is read from the names of its ends: an XBee module ("tam0.xbee"), a robot's
// main board ("robot0.pic"); anything else is shown as bytes sent without a pause.

#include "base/json.h"
#include "traces/recorded_trace.h"

#include <array>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace puckloop::tools {

/// What DecodedFrame::protocol can be.
inline constexpr std::array<const char*, 11> kProtocols{"epuck", "xbee",  "bytes", "bluetooth", "i2c",  "can",
                                                        "rab",   "ircom", "mesh",  "ip",        "fault"};

struct DecodedFrame {
    cosim::Time begin = 0;  ///< first bit on the line or air
    cosim::Time end = 0;    ///< the last bit is there
    std::string link, from;
    std::string protocol;  ///< of kProtocols
    std::string text;
    std::vector<std::string> errors;  ///< what is wrong with it, and what faults did to it
    nlohmann::ordered_json fields = nlohmann::ordered_json::object();
};

using TakeFrame = std::function<void(const DecodedFrame&)>;

/// Who looks on while a trace is decoded, which is read twice: rows of the first reading, then those of the
/// second beside the frames. Either may be empty; what one throws ends the decoding.
struct DecodeWatch {
    std::function<void(const cosim::TraceRow&)> first, second;
};

/// Hands over frames in the order in which they were complete.
void decode_trace(const RecordedTrace& trace, const TakeFrame& take, const DecodeWatch& watch = {});

/// Frames may be made of this signal.
bool is_of_frames(std::string_view signal);

/// One line each, without the line end.
std::string to_text(const DecodedFrame& frame);
std::string to_json(const DecodedFrame& frame);

}  // namespace puckloop::tools
