// The range-and-bearing frame: the real board's waveforms, round trips, and what a reader reports of bad
// ones.

#include "base/error.h"
#include "base/random.h"
#include "protocols/infrared/rab_frame.h"

#include <catch2/catch.hpp>

#include <bit>

using namespace puckloop;
using namespace puckloop::protocols;

namespace {

struct Vector {
    int size;
    std::uint32_t payload;
    int ones;
    int check;
    std::string_view chips;
};

constexpr Vector kVectors[] = {
#include "tests/protocols/rab_vectors.inc"
};

std::string message_of(const auto& action) {
    try {
        action();
    } catch (const InputError& error) {
        return error.what();
    }
    return "no error";
}

/// Encodes, reads back by length and by size; plain ifs, because it runs 65 000 times.
bool returns_unchanged(int size, std::uint32_t payload) {
    const std::string chips = encode_rab(size, payload);
    if (static_cast<int>(chips.size()) != rab_frame_chips(size)) return false;
    for (const int asked : {0, size}) {
        const RabFrameReading reading = decode_rab(chips, asked);
        if (!reading.ok() || reading.size != size || reading.payload != payload) return false;
        if ((std::popcount(payload) + reading.check) % 16 != 0) return false;
    }
    return true;
}

}  // namespace

TEST_CASE("frames are the waveforms measured at the board's emitters") {
    for (const Vector& vector : kVectors) {
        CAPTURE(vector.size, vector.payload);
        CHECK(encode_rab(vector.size, vector.payload) == vector.chips);
        CHECK(rab_check(vector.payload) == vector.check);
        CHECK(std::popcount(vector.payload) == vector.ones);
        const RabFrameReading reading = decode_rab(vector.chips);
        CHECK(reading.ok());
        CHECK(reading.size == vector.size);
        CHECK(reading.payload == vector.payload);
        CHECK(reading.check == vector.check);
    }
}

TEST_CASE("every 8- and 16-bit payload and seeded 24- and 32-bit ones return unchanged") {
    int failures = 0;
    for (const int size : {8, 16})
        for (std::uint32_t payload = 0; payload < 1u << size; ++payload)
            failures += returns_unchanged(size, payload) ? 0 : 1;
    RandomStream random(3, "rab_frame");
    for (const int size : {24, 32})
        for (int round = 0; round < 20000; ++round)
            failures +=
                returns_unchanged(size, static_cast<std::uint32_t>(random.next() >> (64 - size))) ? 0 : 1;
    CHECK(failures == 0);
}

TEST_CASE("a frame never rests for more than two chips after its first") {
    // The board takes three chips off for the end of a frame.
    for (std::uint32_t payload = 0; payload < 256; ++payload)
        CHECK(encode_rab(8, payload).find("000") == std::string::npos);
}

TEST_CASE("of the 2^12 well-formed 8-bit frames one a payload passes its check") {
    int accepted = 0;
    int refused = 0;
    for (unsigned bits = 0; bits < 1u << 12; ++bits) {
        std::string chips = "111111";
        for (int bit = 0; bit < 12; ++bit)
            chips += bits >> bit & 1u ? "10" : "01";
        const RabFrameReading reading = decode_rab(chips);
        CHECK(reading.payload == (bits & 0xFF));
        accepted += reading.ok() ? 1 : 0;
        refused += reading.fault == RabFault::Check ? 1 : 0;
    }
    CHECK(accepted == 256);
    CHECK(refused == 4096 - 256);
}

TEST_CASE("a reader names the first wrong chip") {
    const std::string good = encode_rab(16, 0x1234);
    const auto with = [&](std::size_t at, char chip) {
        std::string chips = good;
        chips[at] = chip;
        return decode_rab(chips);
    };
    CHECK(explain(decode_rab(good)) == "ok");
    CHECK(explain(with(3, '0')) == "preamble: chip 3 is off");
    CHECK(explain(with(6, '1')) == "manchester: chips 6 and 7 are equal");
    CHECK(explain(with(45, '1')) == "manchester: chips 44 and 45 are equal");
    CHECK(with(45, '1').chip == 44);
    CHECK(explain(decode_rab(good.substr(0, 45))) == "length: 45 chips, and frames have 30, 46, 62 or 78");
    CHECK(explain(decode_rab(good, 8)) == "length: 46 chips, and a frame of 8 bits has 30");
    CHECK(decode_rab(good, 8).chip == 30);
    CHECK(explain(decode_rab(good, 24)) == "length: 46 chips, and a frame of 24 bits has 62");
    CHECK(decode_rab(good, 24).chip == 46);
    CHECK(explain(decode_rab("11111")) == "length: 5 chips, and frames have 30, 46, 62 or 78");
    CHECK(explain(decode_rab("0")) == "preamble: chip 0 is off");

    std::string flipped = good;  // payload bit 0 set: six ones need A, B was sent
    flipped[6] = '1', flipped[7] = '0';
    CHECK(explain(decode_rab(flipped)) == "check: B from chip 38 on, and payload 1235 needs A");
    CHECK(decode_rab(flipped).fault == RabFault::Check);
    CHECK(decode_rab(flipped).payload == 0x1235);
}

TEST_CASE("what cannot be a frame is bad input, named with its place") {
    CHECK(message_of([] { encode_rab(7, 1); }) ==
          "payload size: 7 bits cannot be sent (expected 8, 16, 24 or 32)");
    CHECK(message_of([] { encode_rab(8, 0x100); }) ==
          "payload: 100 is too large for 8 bits (expected at most FF)");
    CHECK(message_of([] { encode_rab(24, 0x1000000); }) ==
          "payload: 1000000 is too large for 24 bits (expected at most FFFFFF)");
    CHECK(message_of([] { encode_rab(32, 0xFFFFFFFF); }) == "no error");
    CHECK(message_of([] { decode_rab("1", -8); }) ==
          "payload size: -8 bits cannot be sent (expected 8, 16, 24 or 32)");
    CHECK(message_of([] { decode_rab(""); }) == "chips: nothing to read (expected a frame as 0 and 1)");
    CHECK(message_of([] { decode_rab("1112"); }) == "chip 3: '2' is no chip (expected 0 or 1)");
    CHECK(message_of([] { decode_rab("11\n", 0, "line 4"); }) ==
          "line 4: chip 2: byte 0x0a is no chip (expected 0 or 1)");
}
