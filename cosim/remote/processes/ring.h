#pragma once
// A stream of bytes from one process to another through shared memory. Neither side trusts what the other
// wrote: positions are checked, and bytes are copied out before anything is read from them.

#include "cosim/core/codec.h"

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <span>

namespace puckloop::cosim {

/// In shared memory; all zero at first. Positions count bytes since the beginning and never fall.
struct RingState {
    static constexpr std::size_t kCapacity = 32 * 1024;  ///< a power of two

    alignas(64) std::atomic<std::uint64_t> written;
    alignas(64) std::atomic<std::uint64_t> read;
    std::atomic<std::uint32_t> full;  ///< 1: the writer waits for space
    alignas(64) std::uint8_t bytes[kCapacity];
};

class RingWriter {
  public:
    explicit RingWriter(RingState& state) : state_(state) {}

    /// Writes as much of `bytes` as there is space for; how many. Throws CodecError if the reader's position
    /// cannot be true.
    std::size_t write(std::span<const std::uint8_t> bytes);
    /// Before the writer waits for space: the reader will ring. False if there is space meanwhile.
    bool ask_for_space();

  private:
    std::size_t space() const;

    RingState& state_;
    std::uint64_t written_ = 0;
};

class RingReader {
  public:
    explicit RingReader(RingState& state) : state_(state) {}

    /// Appends what is there to `bytes`; how much. Throws CodecError if the writer's position cannot be true.
    std::size_t read(Bytes& bytes);
    /// True once after the writer asked for space: it waits to be rung.
    bool was_full();

  private:
    RingState& state_;
    std::uint64_t read_ = 0;
};

}  // namespace puckloop::cosim
