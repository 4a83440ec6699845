#include "bench/upload/boot_packets.h"

#include "base/error.h"

#include <fmt/format.h>

namespace puckloop::tools {

namespace {

constexpr std::uint32_t kWordsOfRow = 32, kRow = 2 * kWordsOfRow, kErased = 0xFFFFFF;
constexpr std::uint8_t kCount = 0x60;
constexpr std::uint32_t kGoto = 0x040000;

/// The two words of `goto address`.
void put_goto(image::Words& words, std::uint32_t at, std::uint32_t address) {
    words[at] = kGoto | (address & 0xFFFE);
    words[at + 2] = address >> 16;
}

BootPacket packet_of(const image::Words& words, std::uint32_t row) {
    BootPacket packet{static_cast<std::uint8_t>(row), static_cast<std::uint8_t>(row >> 8),
                      static_cast<std::uint8_t>(row >> 16), kCount};
    for (std::uint32_t i = 0; i < kWordsOfRow; ++i) {
        const auto word = words.find(row + 2 * i);
        const std::uint32_t value = word == words.end() ? kErased : word->second;
        for (int shift = 0; shift < 24; shift += 8)
            packet.push_back(static_cast<std::uint8_t>(value >> shift));
    }
    unsigned sum = 0;
    for (const std::uint8_t octet : packet)
        sum += octet;
    packet.push_back(static_cast<std::uint8_t>(0x100 - (sum & 0xFF)));
    return packet;
}

}  // namespace

std::vector<BootPacket> boot_packets(const image::Image& image) {
    image::Words words;
    for (const auto& [address, word] : image.program) {
        if (address >= kBootEntry) {
            if (word == kErased) continue;
            throw InputError(image.file, fmt::format("0x{:05x}", address),
                             "the image has a word where the boot loader is",
                             "an image without a boot loader of its own");
        }
        words[address] = word;
    }
    if (!words.contains(0) || !words.contains(2) || (words[0] & 0xFF0000) != kGoto || words[2] > 0x7F)
        throw InputError(image.file, "0x00000", "the image's reset is no goto", "a dsPIC30F program");
    const std::uint32_t start = (words[0] & 0xFFFE) | words[2] << 16;
    put_goto(words, 0, kBootEntry);
    put_goto(words, kBootReturn, start == kBootEntry ? 0 : start);
    std::vector<BootPacket> packets;
    for (std::uint32_t row = kRow; row <= kBootRow; row += kRow) {
        const auto first = words.lower_bound(row);
        if (first != words.end() && first->first < row + kRow) packets.push_back(packet_of(words, row));
    }
    packets.push_back(packet_of(words, 0));
    return packets;
}

BootPacket boot_end(std::uint16_t ticks) {
    constexpr std::uint8_t kEnd = 0xFF;
    return {static_cast<std::uint8_t>(ticks), static_cast<std::uint8_t>(ticks >> 8), 0, kEnd};
}

}  // namespace puckloop::tools
