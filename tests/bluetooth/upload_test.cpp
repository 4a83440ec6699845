// What the boot loader is sent: rows whose octets add up, the program's words in them, and a reset that leads
// to the boot loader and from there to the program.

#include "base/error.h"
#include "base/random.h"
#include "bench/upload/boot_packets.h"

#include <catch2/catch.hpp>

#include <map>

using namespace puckloop;
using namespace puckloop::tools;

namespace {

image::Image program(std::uint32_t start) {
    image::Image image;
    image.file = "test.hex";
    image.program[0] = 0x040000 | start;
    image.program[2] = 0;
    return image;
}

/// The flash after an upload, as the boot loader writes it.
std::map<std::uint32_t, std::uint32_t> flash(const std::vector<BootPacket>& packets) {
    std::map<std::uint32_t, std::uint32_t> words;
    for (const BootPacket& packet : packets) {
        REQUIRE(packet.size() == 4 + 96 + 1);
        unsigned sum = 0;
        for (const std::uint8_t octet : packet)
            sum += octet;
        CHECK((sum & 0xff) == 0);
        const std::uint32_t row = packet[0] | packet[1] << 8 | packet[2] << 16;
        CHECK(row % 64 == 0);
        CHECK(packet[3] != 0xff);
        for (std::uint32_t i = 0; i < 32; ++i) {
            CHECK(!words.contains(row + 2 * i));
            words[row + 2 * i] = packet[4 + 3 * i] | packet[5 + 3 * i] << 8 |
                                 static_cast<std::uint32_t>(packet[6 + 3 * i]) << 16;
        }
    }
    return words;
}

}  // namespace

TEST_CASE("an upload holds the program, and the way to it", "[bluetooth]") {
    RandomStream random(60, "program");
    for (int round = 0; round < 20; ++round) {
        const auto start = static_cast<std::uint32_t>(0x100 + 2 * random.below(0x2000));
        image::Image image = program(start);
        for (std::uint64_t n = random.below(400); n > 0; --n)
            image.program[static_cast<std::uint32_t>(4 + 2 * random.below(0xBF00))] =
                static_cast<std::uint32_t>(random.below(0xFFFFFF));
        // Ones are what erased flash holds: an image may have them where the boot loader is.
        image.program[kBootEntry + 8] = 0xFFFFFF;
        const auto packets = boot_packets(image);
        const auto words = flash(packets);
        for (const auto& [address, word] : image.program) {
            if (address < 4 || (address >= kBootReturn && address < kBootEntry + 10)) continue;
            CHECK(words.at(address) == word);
        }
        // goto 0x17F40; there goto the program.
        CHECK(words.at(0) == 0x047F40);
        CHECK(words.at(2) == 0x000001);
        CHECK(words.at(kBootReturn) == (0x040000 | start));
        CHECK(words.at(kBootReturn + 2) == 0);
        // The row with the reset is last, and nothing touches the boot loader.
        CHECK((packets.back()[0] | packets.back()[1] | packets.back()[2]) == 0);
        CHECK(words.rbegin()->first < kBootEntry);
    }
    CHECK(boot_end(0x1234) == BootPacket{0x34, 0x12, 0, 0xff});
}

TEST_CASE("images that cannot be uploaded are refused", "[bluetooth]") {
    image::Image image = program(0x100);
    image.program[0x17F44] = 0x123456;
    CHECK_THROWS_AS(boot_packets(image), InputError);
    image = program(0x100);
    image.program[0] = 0x123456;
    CHECK_THROWS_AS(boot_packets(image), InputError);
    CHECK_THROWS_AS(boot_packets(image::Image{}), InputError);
}
