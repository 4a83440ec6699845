#pragma once
// Whole messages over a stream socket, with deadlines in wall time. Used by both sides.

#include "cosim/core/codec.h"

#include <chrono>
#include <optional>
#include <span>

namespace puckloop::cosim {

class SocketStream {
  public:
    /// Takes over `descriptor`.
    explicit SocketStream(int descriptor) : descriptor_(descriptor) {}
    ~SocketStream();
    SocketStream(const SocketStream&) = delete;
    SocketStream& operator=(const SocketStream&) = delete;

    int descriptor() const { return descriptor_; }

    /// Longest wait of receive(true) and of each piece of send(); 0 waits for ever.
    void set_timeout(std::chrono::milliseconds timeout);

    enum class Status { Whole, Partial, Closed };
    /// Reads what is there (or, with `wait`, what comes within the timeout). Whole: body() is one message.
    /// Throws CodecError when the length cannot be true.
    Status receive(bool wait);
    /// Body of the message that receive() completed, valid until the next receive().
    std::span<const std::uint8_t> body() const { return body_; }

    /// False when the other side has closed. Throws CodecError when nothing could be sent until `deadline`.
    bool send(const Bytes& bytes, std::optional<std::chrono::steady_clock::time_point> deadline = {});

  private:
    bool take_message();

    int descriptor_;
    Bytes buffer_;
    std::size_t filled_ = 0;
    std::size_t consumed_ = 0;
    std::span<const std::uint8_t> body_;
};

}  // namespace puckloop::cosim
