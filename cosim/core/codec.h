#pragma once
// Explicit little-endian bytes for everything that crosses a process border or is hashed. Reading checks
// every length and every enumerator: damaged input throws CodecError and does nothing else.

#include "cosim/core/message.h"

#include <cstdint>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace puckloop::cosim {

using Bytes = std::vector<std::uint8_t>;

class CodecError : public std::runtime_error {
  public:
    using std::runtime_error::runtime_error;
};

/// Appends to a buffer that its owner may reuse.
class ByteWriter {
  public:
    explicit ByteWriter(Bytes& bytes) : bytes_(bytes) {}

    void u8(std::uint8_t value) { bytes_.push_back(value); }
    void u16(std::uint16_t value) { little_endian(value, 2); }
    void u32(std::uint32_t value) { little_endian(value, 4); }
    void u64(std::uint64_t value) { little_endian(value, 8); }
    void time(Time value) { u64(static_cast<std::uint64_t>(value)); }
    void f64(double value);
    /// Length (32 bit) and bytes.
    void text(std::string_view value);
    void payload(const Payload& payload);
    void message(const Message& message);

  private:
    void little_endian(std::uint64_t value, int count) {
        for (int i = 0; i < count; ++i)
            bytes_.push_back(static_cast<std::uint8_t>(value >> (8 * i)));
    }

    Bytes& bytes_;
};

class ByteReader {
  public:
    explicit ByteReader(std::span<const std::uint8_t> bytes) : bytes_(bytes) {}

    std::uint8_t u8() { return static_cast<std::uint8_t>(little_endian(1)); }
    std::uint16_t u16() { return static_cast<std::uint16_t>(little_endian(2)); }
    std::uint32_t u32() { return static_cast<std::uint32_t>(little_endian(4)); }
    std::uint64_t u64() { return little_endian(8); }
    Time time() { return static_cast<Time>(u64()); }
    double f64();
    bool boolean();
    /// A value of an enumeration whose last enumerator is `last`.
    template <typename Enum>
    Enum enumerator(Enum last) {
        const std::uint8_t value = u8();
        if (value > static_cast<std::uint8_t>(last)) fail("value out of range");
        return static_cast<Enum>(value);
    }
    std::string text();
    Payload payload();
    Message message();
    /// A number of items that take at least `smallest` bytes each in what is left.
    std::size_t count(std::size_t smallest);

    std::size_t left() const { return bytes_.size() - position_; }
    /// Throws unless everything was read.
    void end() const;

  private:
    [[noreturn]] void fail(const char* what) const;
    std::uint64_t little_endian(std::size_t count);

    std::span<const std::uint8_t> bytes_;
    std::size_t position_ = 0;
};

}  // namespace puckloop::cosim
