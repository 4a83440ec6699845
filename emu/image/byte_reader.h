#pragma once
// Little-endian reads from a file in memory that cannot leave it: one past the end is an InputError with the
// offset.

#include <cstdint>
#include <string>
#include <string_view>

namespace puckloop::image {

class ByteReader {
  public:
    ByteReader(std::string_view bytes, std::string_view file) : bytes_(bytes), file_(file) {}

    std::uint64_t size() const { return bytes_.size(); }
    std::uint8_t u8(std::uint64_t offset, std::string_view what) const;
    std::uint16_t u16(std::uint64_t offset, std::string_view what) const;
    std::uint32_t u32(std::uint64_t offset, std::string_view what) const;
    /// `length` bytes; `what` names them in the message.
    std::string_view slice(std::uint64_t offset, std::uint64_t length, std::string_view what) const;
    /// The zero-ended text at `offset`, which must end before `end`.
    std::string_view text(std::uint64_t offset, std::uint64_t end, std::string_view what) const;
    [[noreturn]] void fail(std::uint64_t offset, std::string_view problem, std::string_view expected) const;

  private:
    std::string_view bytes_;
    std::string_view file_;
};

}  // namespace puckloop::image
