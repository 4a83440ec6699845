// Finding out where in a packet the boot loader is, against a boot loader that is somewhere.

#include "base/random.h"
#include "bench/upload/boot_place.h"

#include <catch2/catch.hpp>

#include <numeric>

using namespace puckloop;
using namespace puckloop::tools;

namespace {

/// Takes 101 octets for a packet, whatever they are.
struct Loader {
    BootPacket have{};
    std::vector<bool> right{};  ///< of each packet, whether its sum is

    /// How many packets these octets complete.
    std::size_t take(std::span<const std::uint8_t> octets) {
        const std::size_t before = right.size();
        for (const std::uint8_t octet : octets) {
            have.push_back(octet);
            if (have.size() < BootPlace::kPacket) continue;
            right.push_back(std::accumulate(have.begin(), have.end(), 0U) % 256 == 0);
            have.clear();
        }
        return right.size() - before;
    }
};

BootPacket drawn_row(RandomStream& random) {
    BootPacket row;
    unsigned sum = 0;
    while (row.size() < BootPlace::kPacket - 1) {
        // Fourth octet as of a row; long runs of one value make shifted sums right as often as can be.
        row.push_back(
            row.size() == 3 ? 0x60 : static_cast<std::uint8_t>(random.below(4) == 0 ? random.below(256) : 0));
        sum += row.back();
    }
    row.push_back(static_cast<std::uint8_t>(0x100 - sum % 256));
    return row;
}

/// Probes until a packet begins; how many probes it took.
int align(BootPlace& place, Loader& loader) {
    int probes = 0;
    for (; !place.aligned(); ++probes) {
        REQUIRE(probes < 12);
        const bool certain = place.known();
        const std::size_t answers = loader.take(place.probe());
        REQUIRE(answers <= 1);
        if (certain) REQUIRE(answers == 1);
        place.answered(answers == 1);
    }
    CHECK(loader.have.empty());
    return probes;
}

}  // namespace

TEST_CASE("after hellos too many the boot loader's place is found, and nothing is taken for a row",
          "[bluetooth]") {
    for (std::size_t surplus = 0; surplus <= 100; ++surplus) {
        CAPTURE(surplus);
        for (const std::size_t most : {surplus, std::size_t{100}}) {
            BootPlace place;
            Loader loader;
            const BootPacket hellos(surplus, kBootHello), first(1, kBootHello);
            place.sent(first);
            place.sent(hellos);
            loader.take(hellos);
            place.lost(most);
            const int probes = align(place, loader);
            CHECK(probes <= (surplus == 0 ? 2 : 9));
            for (const bool right : loader.right)
                CHECK_FALSE(right);
        }
    }
}

TEST_CASE("wherever the boot loader is after a row, its place is found, and nothing more is taken for a row",
          "[bluetooth]") {
    RandomStream random(Catch::rngSeed(), "boot place");
    for (int round = 0; round < 2000; ++round) {
        BootPlace place;
        Loader loader;
        const BootPacket row = drawn_row(random);
        // It missed the first of the row's octets, or was in the middle of a packet when the row came.
        const std::size_t missed = random.below(BootPlace::kPacket);
        place.sent(row);
        loader.take(std::span(row).subspan(missed));
        const std::size_t before = loader.right.size();
        place.lost(100);
        align(place, loader);
        for (std::size_t i = before; i < loader.right.size(); ++i)
            CHECK_FALSE(loader.right[i]);
        // The row that follows is taken as it is.
        place.sent(row);
        CHECK(loader.take(row) == 1);
        CHECK(loader.right.back());
        CHECK(loader.have.empty());
    }
}
