#include "emu/image/dspic_view.h"

#include "base/error.h"

#include <fmt/format.h>

#include <cctype>

namespace puckloop::image {

namespace {

constexpr std::uint64_t kBytesPerWord = 4;
constexpr std::uint64_t kByteAddressEnd = 0x2000000;  // 2 * 2^24
constexpr std::uint32_t kEepromEnd = 0x800000;
constexpr std::uint32_t kConfigStart = 0xF80000;
constexpr std::uint32_t kConfigEnd = 0xF90000;

Words& region(Image& image, std::uint32_t address) {
    if (address < kEepromStart) return image.program;
    if (address < kEepromEnd) return image.eeprom;
    if (address >= kConfigStart && address < kConfigEnd) return image.config;
    return image.other;
}

}  // namespace

void add_words(Image& image, const std::vector<ByteSegment>& segments) {
    for (const ByteSegment& segment : segments) {
        const auto place = [](std::uint64_t address) { return fmt::format("byte address 0x{:X}", address); };
        if (segment.address % kBytesPerWord != 0 || segment.end() % kBytesPerWord != 0)
            throw InputError(image.file,
                             place(segment.address % kBytesPerWord ? segment.address : segment.end()),
                             "data begins or ends inside a program word",
                             "whole words of four bytes: is this an image for another chip, an AVR say?");
        if (segment.end() > kByteAddressEnd)
            throw InputError(image.file, place(segment.end() - 1), "data beyond the 24-bit program space",
                             "byte addresses up to 0x1FFFFFF");
        for (std::size_t i = 0; i < segment.bytes.size(); i += kBytesPerWord) {
            const std::uint64_t byte_address = segment.address + i;
            if (segment.bytes[i + 3] != 0)
                throw InputError(image.file, place(byte_address + 3),
                                 fmt::format("phantom byte 0x{:02X}", segment.bytes[i + 3]),
                                 "0, as in every dsPIC image: is this one for another chip?");
            const std::uint32_t word = static_cast<std::uint32_t>(segment.bytes[i]) |
                                       static_cast<std::uint32_t>(segment.bytes[i + 1]) << 8 |
                                       static_cast<std::uint32_t>(segment.bytes[i + 2]) << 16;
            const std::uint32_t address = static_cast<std::uint32_t>(byte_address / 2);
            region(image, address).emplace(address, word);
        }
    }
}

std::string chip_from_symbol(std::string_view name) {
    for (const std::string_view family : {"__30F", "__33FJ"}) {
        if (name.substr(0, family.size()) != family || name.size() == family.size()) continue;
        std::string chip = "dspic";
        for (const char c : name.substr(2)) {
            if (!std::isalnum(static_cast<unsigned char>(c))) return {};
            chip += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
        }
        return chip;
    }
    return {};
}

}  // namespace puckloop::image
