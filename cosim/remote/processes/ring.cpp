#include "cosim/remote/processes/ring.h"

#include <algorithm>
#include <cstring>

namespace puckloop::cosim {

namespace {
static_assert(std::atomic<std::uint64_t>::is_always_lock_free);

std::size_t offset(std::uint64_t position) {
    return static_cast<std::size_t>(position % RingState::kCapacity);
}
}  // namespace

std::size_t RingWriter::space() const {
    const std::uint64_t used = written_ - state_.read.load(std::memory_order_seq_cst);
    if (used > RingState::kCapacity) throw CodecError("a ring's read position of impossible length");
    return RingState::kCapacity - static_cast<std::size_t>(used);
}

std::size_t RingWriter::write(std::span<const std::uint8_t> bytes) {
    const std::size_t count = std::min(space(), bytes.size());
    if (count == 0) return 0;
    const std::size_t at = offset(written_);
    const std::size_t before_wrap = std::min(count, RingState::kCapacity - at);
    std::memcpy(state_.bytes + at, bytes.data(), before_wrap);
    std::memcpy(state_.bytes, bytes.data() + before_wrap, count - before_wrap);
    written_ += count;
    state_.written.store(written_, std::memory_order_release);
    return count;
}

bool RingWriter::ask_for_space() {
    state_.full.store(1, std::memory_order_seq_cst);
    return space() == 0;
}

std::size_t RingReader::read(Bytes& bytes) {
    const std::uint64_t there = state_.written.load(std::memory_order_acquire) - read_;
    if (there > RingState::kCapacity) throw CodecError("a message of impossible length");
    const auto count = static_cast<std::size_t>(there);
    if (count == 0) return 0;
    const std::size_t at = offset(read_);
    const std::size_t before_wrap = std::min(count, RingState::kCapacity - at);
    bytes.insert(bytes.end(), state_.bytes + at, state_.bytes + at + before_wrap);
    bytes.insert(bytes.end(), state_.bytes, state_.bytes + count - before_wrap);
    read_ += count;
    state_.read.store(read_, std::memory_order_seq_cst);
    return count;
}

bool RingReader::was_full() {
    return state_.full.load(std::memory_order_seq_cst) != 0 &&
           state_.full.exchange(0, std::memory_order_seq_cst) != 0;
}

}  // namespace puckloop::cosim
