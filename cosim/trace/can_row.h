#pragma once
// CAN messages in trace files: "123#0102ff" as candump writes frames ("123#R4" a remote frame, eight digits
// an extended identifier), and what happened as words: "sent tag 0 tec 0 rec 0", "error tag 0 tec 8 rec 0
// sender ack at 34". A controller that joins has "16/12/2" in place of a frame: quanta of a bit, before the
// sample, of a jump.

#include "cosim/core/message.h"

#include <optional>
#include <string>
#include <string_view>

namespace puckloop::cosim {

/// "123#0102ff"; empty where the message has none.
std::string can_data_text(const CanMessage& message);
std::string can_detail_text(const CanMessage& message);
/// The other way, without times; nullopt: neither text was written here.
std::optional<CanMessage> parse_can(std::string_view data, std::string_view detail);
/// "join", "sent", ...
std::string_view can_kind_name(CanKind kind);

}  // namespace puckloop::cosim
