#include "emu/image/byte_reader.h"

#include "base/error.h"

#include <fmt/format.h>

namespace puckloop::image {

void ByteReader::fail(std::uint64_t offset, std::string_view problem, std::string_view expected) const {
    throw InputError(file_, fmt::format("offset 0x{:X}", offset), problem, expected);
}

std::string_view ByteReader::slice(std::uint64_t offset, std::uint64_t length, std::string_view what) const {
    if (offset > bytes_.size() || length > bytes_.size() - offset)
        fail(offset, fmt::format("{} of {} bytes runs past the end of the file", what, length),
             fmt::format("it to end within {} bytes: is the file cut short?", bytes_.size()));
    return bytes_.substr(offset, length);
}

std::uint8_t ByteReader::u8(std::uint64_t offset, std::string_view what) const {
    return static_cast<std::uint8_t>(slice(offset, 1, what)[0]);
}

std::uint16_t ByteReader::u16(std::uint64_t offset, std::string_view what) const {
    const std::string_view bytes = slice(offset, 2, what);
    return static_cast<std::uint16_t>(static_cast<std::uint8_t>(bytes[0]) |
                                      static_cast<std::uint8_t>(bytes[1]) << 8);
}

std::uint32_t ByteReader::u32(std::uint64_t offset, std::string_view what) const {
    return static_cast<std::uint32_t>(u16(offset, what)) | static_cast<std::uint32_t>(u16(offset + 2, what))
                                                               << 16;
}

std::string_view ByteReader::text(std::uint64_t offset, std::uint64_t end, std::string_view what) const {
    if (end > bytes_.size() || offset >= end)
        fail(offset, fmt::format("{} lies outside the string table", what), "an offset inside it");
    const std::string_view rest = bytes_.substr(offset, end - offset);
    const std::size_t length = rest.find('\0');
    if (length == std::string_view::npos) fail(offset, fmt::format("{} does not end", what), "a zero byte");
    return rest.substr(0, length);
}

}  // namespace puckloop::image
