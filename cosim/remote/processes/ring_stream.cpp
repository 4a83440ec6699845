#include "cosim/remote/processes/ring_stream.h"

#include "cosim/remote/protocol.h"

namespace puckloop::cosim {

namespace {
// What was read and used is moved out of the way when it is so much.
constexpr std::size_t kKept = RingState::kCapacity;
}  // namespace

bool RingStream::take_message() {
    const std::size_t available = buffer_.size() - consumed_;
    if (available < protocol::kLengthBytes) return false;
    const std::uint32_t length =
        ByteReader(std::span(buffer_).subspan(consumed_, protocol::kLengthBytes)).u32();
    if (length == 0 || length > protocol::kLongest) throw CodecError("a message of impossible length");
    const std::size_t whole = protocol::kLengthBytes + length;
    if (available < whole) return false;
    body_ = std::span<const std::uint8_t>(buffer_).subspan(consumed_ + protocol::kLengthBytes, length);
    consumed_ += whole;
    return true;
}

bool RingStream::receive(std::chrono::nanoseconds limit) {
    if (consumed_ == buffer_.size() || consumed_ > kKept) {
        buffer_.erase(buffer_.begin(), buffer_.begin() + static_cast<std::ptrdiff_t>(consumed_));
        consumed_ = 0;
    }
    for (bool waited = limit.count() == 0;; waited = true) {
        const std::uint32_t seen = mine_.rings();
        if (take_message()) return true;
        const bool more = reader_.read(buffer_) != 0;
        if (more && reader_.was_full()) theirs_.ring(true);
        if (take_message()) return true;
        if (waited && !more) return false;
        if (!more) mine_.wait(seen, 1, limit);
    }
}

bool RingStream::send(std::span<const std::uint8_t> bytes, std::chrono::nanoseconds limit) {
    for (bool waited = false;; waited = true) {
        const std::uint32_t seen = mine_.rings();
        const std::size_t more = writer_.write(bytes.subspan(sent_));
        sent_ += more;
        if (sent_ == bytes.size()) break;
        if (more != 0) theirs_.ring(true);  // to make space
        if (waited && more == 0) return false;
        if (writer_.ask_for_space()) mine_.wait(seen, 1, limit);
    }
    sent_ = 0;
    theirs_.ring();
    return true;
}

}  // namespace puckloop::cosim
