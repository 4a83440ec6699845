#pragma once
// Frames and errors in and out of a CanMessage.

#include "cosim/core/message.h"
#include "protocols/can/can_frame.h"
#include "protocols/can/can_reader.h"

namespace puckloop::cosim {

inline void put_frame(CanMessage& message, const protocols::CanFrame& frame) {
    message.id = frame.id;
    message.length = frame.length;
    message.data = frame.data;
    message.flags = static_cast<std::uint8_t>(message.flags | (frame.extended ? kCanExtended : 0) |
                                              (frame.remote ? kCanRemote : 0));
}

inline protocols::CanFrame frame_in(const CanMessage& message) {
    return {message.id, (message.flags & kCanExtended) != 0, (message.flags & kCanRemote) != 0,
            message.length, message.data};
}

inline void put_error(CanMessage& message, protocols::CanError error) {
    message.flags = static_cast<std::uint8_t>(message.flags | static_cast<unsigned>(error) << kCanErrorShift);
}

inline protocols::CanError error_in(const CanMessage& message) {
    return static_cast<protocols::CanError>(message.flags >> kCanErrorShift);
}

/// The message is about a frame, and has it.
inline bool has_frame(const CanMessage& message) {
    return message.kind == CanKind::Offer || message.kind == CanKind::Sent ||
           message.kind == CanKind::Received ||
           (message.kind == CanKind::Error && (message.flags & kCanSender) != 0);
}

}  // namespace puckloop::cosim
