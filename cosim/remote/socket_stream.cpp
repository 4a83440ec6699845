#include "cosim/remote/socket_stream.h"

#include "cosim/remote/protocol.h"

#include <sys/socket.h>
#include <sys/time.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

namespace puckloop::cosim {

namespace {
constexpr std::size_t kInitialBuffer = 64 * 1024;
}

SocketStream::~SocketStream() {
    if (descriptor_ >= 0) close(descriptor_);
}

void SocketStream::set_timeout(std::chrono::milliseconds timeout) {
    timeval value{};
    value.tv_sec = timeout.count() / 1000;
    value.tv_usec = static_cast<suseconds_t>(timeout.count() % 1000) * 1000;
    setsockopt(descriptor_, SOL_SOCKET, SO_RCVTIMEO, &value, sizeof value);
    setsockopt(descriptor_, SOL_SOCKET, SO_SNDTIMEO, &value, sizeof value);
}

bool SocketStream::take_message() {
    const std::size_t available = filled_ - consumed_;
    if (available < protocol::kLengthBytes) return false;
    const std::uint32_t length =
        ByteReader(std::span(buffer_).subspan(consumed_, protocol::kLengthBytes)).u32();
    if (length == 0 || length > protocol::kLongest) throw CodecError("a message of impossible length");
    const std::size_t whole = protocol::kLengthBytes + length;
    if (available < whole) {
        if (buffer_.size() - consumed_ < whole) buffer_.resize(consumed_ + whole);
        return false;
    }
    body_ = std::span<const std::uint8_t>(buffer_).subspan(consumed_ + protocol::kLengthBytes, length);
    consumed_ += whole;
    return true;
}

SocketStream::Status SocketStream::receive(bool wait) {
    if (consumed_ == filled_) consumed_ = filled_ = 0;
    if (buffer_.empty()) buffer_.resize(kInitialBuffer);
    while (!take_message()) {
        if (filled_ == buffer_.size()) {
            // Only messages already taken stand before `consumed_`.
            std::memmove(buffer_.data(), buffer_.data() + consumed_, filled_ - consumed_);
            filled_ -= consumed_;
            consumed_ = 0;
            if (filled_ == buffer_.size()) buffer_.resize(2 * buffer_.size());
        }
        const ssize_t got =
            recv(descriptor_, buffer_.data() + filled_, buffer_.size() - filled_, wait ? 0 : MSG_DONTWAIT);
        if (got == 0) return Status::Closed;
        if (got > 0) {
            filled_ += static_cast<std::size_t>(got);
        } else if (errno == EAGAIN || errno == EWOULDBLOCK || errno == EINTR) {
            return Status::Partial;
        } else {
            return Status::Closed;
        }
    }
    return Status::Whole;
}

bool SocketStream::send(const Bytes& bytes, std::optional<std::chrono::steady_clock::time_point> deadline) {
    std::size_t sent = 0;
    while (sent < bytes.size()) {
        const ssize_t put = ::send(descriptor_, bytes.data() + sent, bytes.size() - sent, MSG_NOSIGNAL);
        if (put > 0) {
            sent += static_cast<std::size_t>(put);
        } else if (errno != EAGAIN && errno != EWOULDBLOCK && errno != EINTR) {
            return false;
        } else if (deadline && std::chrono::steady_clock::now() > *deadline) {
            throw CodecError("does not take what is sent to it");
        }
    }
    return true;
}

}  // namespace puckloop::cosim
