// What the frame's redundancy finds, against counts derived from the format (protocols/infrared/rab_errors.h
// has the derivation in short; the counts are repeated here as formulas, the code under test does every error
// in turn).

#include "base/error.h"
#include "base/random.h"
#include "protocols/infrared/rab_errors.h"
#include "protocols/infrared/rab_frame.h"

#include <catch2/catch.hpp>

#include <bit>

using namespace puckloop;
using namespace puckloop::protocols;

namespace {

constexpr int kPreamble = 6;

int pairs_of(int n) {
    return n * (n - 1) / 2;
}

/// One inverted chip. In the preamble: that chip is off. In a bit: its two chips become equal.
RabErrorCount one_inverted(int n) {
    RabErrorCount count;
    count.preamble = kPreamble;
    count.manchester = 2 * n;
    return count;
}

/// Two inverted chips. Any of the preamble: 15 pairs within, 6 * 2n with one outside. Both among the 2n
/// others: n pairs are the two chips of one bit, which becomes the other bit, well formed: the sum of ones
/// and check is off by 1 (payload) or 1, 2, 4, 8 (check), none a multiple of 16, so the check finds all n.
/// The rest leave a bit with equal chips.
RabErrorCount two_inverted(int n) {
    RabErrorCount count;
    count.preamble = pairs_of(kPreamble) + kPreamble * 2 * n;
    count.manchester = pairs_of(2 * n) - n;
    count.check = n;
    return count;
}

/// Two flipped bits. Payload and payload: the sum keeps if one goes up and one down: a set and a clear bit.
/// Payload and check: the payload bit counts 1, so only the check's lowest bit can make up for it, in the
/// opposite direction: clear payload bits if it is set (odd check), set ones if it is clear. Check and check:
/// differences of 1, 2, 4, 8 never cancel (nor add up to 16, the largest is 12). The check finds the rest.
RabErrorCount two_bits(int size, std::uint32_t payload) {
    const int ones = std::popcount(payload);
    const int zeros = size - ones;
    RabErrorCount count;
    count.missed_swap = ones * zeros;
    count.missed_followed = ones % 2 == 1 ? zeros : ones;  // -ones mod 16 is odd when ones is
    count.check = pairs_of(size + kRabCheckBits) - count.missed();
    return count;
}

bool as_derived(int size, std::uint32_t payload) {
    const int n = size + kRabCheckBits;
    const int chips = kPreamble + 2 * n;
    const RabErrorCount lost = count_rab_errors(RabError::OneLost, size, payload);
    const RabErrorCount added = count_rab_errors(RabError::OneAdded, size, payload);
    return count_rab_errors(RabError::OneInverted, size, payload) == one_inverted(n) &&
           count_rab_errors(RabError::TwoInverted, size, payload) == two_inverted(n) &&
           count_rab_errors(RabError::TwoBits, size, payload) == two_bits(size, payload) &&
           lost.all() == chips && lost.missed() == 0 && lost.check == 0 &&  //
           added.all() == 2 * (chips + 1) && added.missed() == 0 && added.check == 0;
}

}  // namespace

TEST_CASE("no error of one or two chips passes, and those of two bits do as derived") {
    for (std::uint32_t payload = 0; payload < 256; ++payload) {
        CAPTURE(payload);
        CHECK(as_derived(8, payload));
    }
    RandomStream random(5, "rab_errors");
    for (const int size : {16, 24, 32}) {
        for (int round = 0; round < 60; ++round) {
            const auto payload = static_cast<std::uint32_t>(random.next() >> (64 - size));
            CAPTURE(size, payload);
            CHECK(as_derived(size, payload));
        }
        CHECK(as_derived(size, 0));
        CHECK(as_derived(size, 0xFFFFFFFFu >> (32 - size)));
    }
}

TEST_CASE("the classification of frame 1234 in figures") {
    // n = 20 bits, 46 chips, 5 ones, 11 zeros, check B (odd).
    const RabErrorCount one = count_rab_errors(RabError::OneInverted, 16, 0x1234);
    CHECK(one == RabErrorCount{.preamble = 6, .manchester = 40});
    const RabErrorCount two = count_rab_errors(RabError::TwoInverted, 16, 0x1234);
    // 15 + 6 * 40 = 255; 40 * 39 / 2 - 20 = 760; 20: together 46 * 45 / 2 = 1035.
    CHECK(two == RabErrorCount{.preamble = 255, .manchester = 760, .check = 20});
    CHECK(two.all() == 1035);
    const RabErrorCount bits = count_rab_errors(RabError::TwoBits, 16, 0x1234);
    // 20 * 19 / 2 = 190 pairs; 5 * 11 = 55 swaps; 11 clear bits rise as the check falls from B to A.
    CHECK(bits == RabErrorCount{.check = 124, .missed_swap = 55, .missed_followed = 11});
}

TEST_CASE("lost and added chips of an all-zero frame are found where the format has it") {
    // After the preamble 111111 come n times 01.
    // Lost, of the preamble (6): a 0 moves to chip 5. Lost, the 0 of a bit (n): what follows reads 10 10 ...
    // and ends one chip early. Lost, the 1 of a bit: the bit reads 00 with its successor's 0 (n - 1), or is
    // the last. Added 1, anywhere (6 + 2n + 1): what follows reads 10 10 ..., one chip remains over. Added 0,
    // before one of the preamble's chips (6): that chip; before the first bit, inside a bit or between two (1
    // + n + n - 1): a bit reads 00; after the last (1): one chip over.
    for (const int size : kRabSizes) {
        const int n = size + kRabCheckBits;
        CHECK(count_rab_errors(RabError::OneLost, size, 0) ==
              RabErrorCount{.preamble = 6, .manchester = n - 1, .length = n + 1});
        CHECK(count_rab_errors(RabError::OneAdded, size, 0) ==
              RabErrorCount{.preamble = 6, .manchester = 2 * n, .length = 2 * n + 7 + 1});
    }
}

TEST_CASE("errors can be done to frames only") {
    CHECK_THROWS_AS(count_rab_errors(RabError::OneLost, 12, 0), InputError);
    CHECK_THROWS_AS(count_rab_errors(RabError::OneLost, 8, 0x100), InputError);
}
