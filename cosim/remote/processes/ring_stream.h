#pragma once
// Whole messages over a pair of rings, with limits in wall time. Used by both sides.

#include "cosim/core/codec.h"
#include "cosim/remote/processes/bell.h"
#include "cosim/remote/processes/ring.h"

#include <chrono>
#include <span>

namespace puckloop::cosim {

class RingStream {
  public:
    /// `mine` is the bell this side waits at, `theirs` the other side's.
    RingStream(RingState& incoming, RingState& outgoing, Bell& mine, Bell& theirs)
        : reader_(incoming), writer_(outgoing), mine_(mine), theirs_(theirs) {}

    /// True when body() is a whole message. Reads what is there; with a `limit` waits for more at most so
    /// long, or until a signal comes. Throws CodecError when the length cannot be true.
    bool receive(std::chrono::nanoseconds limit = {});
    /// Body of the message that receive() completed, valid until the next receive().
    std::span<const std::uint8_t> body() const { return body_; }

    /// Sends `bytes`, a whole message, or what is left of it; waits for space at most `limit`. True when all
    /// of it is out; otherwise it is to be called again for the same message.
    bool send(std::span<const std::uint8_t> bytes, std::chrono::nanoseconds limit);

  private:
    bool take_message();

    RingReader reader_;
    RingWriter writer_;
    Bell& mine_;
    Bell& theirs_;
    Bytes buffer_;
    std::size_t consumed_ = 0;
    std::size_t sent_ = 0;  ///< of the message that goes out
    std::span<const std::uint8_t> body_;
};

}  // namespace puckloop::cosim
