// Octets of messages: by value, and in bounded memory however many there are.

#include "cosim/core/octets.h"

#include <catch2/catch.hpp>

#include <sys/wait.h>
#include <unistd.h>

#include <cstring>
#include <fstream>
#include <random>
#include <string>
#include <vector>

using puckloop::cosim::Octets;

namespace {

/// Octets that follow from a number.
std::vector<std::uint8_t> made(std::uint64_t number, std::size_t size) {
    std::vector<std::uint8_t> octets(size);
    for (std::size_t i = 0; i < size; ++i)
        octets[i] = static_cast<std::uint8_t>(number * 31 + i * 7);
    std::memcpy(octets.data(), &number, std::min(size, sizeof number));
    return octets;
}

bool is_made(const Octets& octets, std::uint64_t number, std::size_t size) {
    const auto expected = made(number, size);
    return std::equal(octets.view().begin(), octets.view().end(), expected.begin(), expected.end());
}

/// MB of this process that are in memory and in no file (RssAnon).
double anonymous_memory() {
    std::ifstream status("/proc/self/status");
    for (std::string line; std::getline(status, line);)
        if (line.starts_with("RssAnon:")) return std::stod(line.substr(8)) / 1024;
    return 0;
}

}  // namespace

TEST_CASE("octets are compared by content", "[octets]") {
    const std::vector<std::uint8_t> one{1, 2, 3}, other{1, 2, 4};
    CHECK(Octets(one) == Octets(one));
    CHECK_FALSE(Octets(one) == Octets(other));
    CHECK(Octets() == Octets(std::vector<std::uint8_t>{}));
    CHECK_FALSE(Octets() == Octets(one));
    CHECK(Octets().view().empty());
    CHECK(Octets(one).size() == 3);
}

TEST_CASE("a flood of packets grows a file and not the memory, and all stay what they were", "[octets]") {
    constexpr std::size_t kPackets = 120'000, kSize = 1500;  // 180 MB
    std::vector<Octets> all;
    all.reserve(kPackets);
    const double before = anonymous_memory();
    for (std::size_t i = 0; i < kPackets; ++i)
        all.emplace_back(made(i, kSize));
    CHECK(anonymous_memory() - before < 40);
    std::mt19937 random(Catch::rngSeed());
    for (int i = 0; i < 1000; ++i) {
        const std::size_t one = random() % kPackets;
        REQUIRE(is_made(all[one], one, kSize));
    }
    // A process that is made by fork() has what was there, and a file of its own.
    const pid_t child = ::fork();
    if (child == 0) {
        bool same = is_made(all[7], 7, kSize);
        std::vector<Octets> more;
        for (std::size_t i = 0; i < 20'000; ++i)
            more.emplace_back(made(~i, kSize));
        same = same && is_made(more[3], ~std::uint64_t{3}, kSize) && is_made(all[8], 8, kSize);
        ::_exit(same ? 0 : 1);
    }
    int status = -1;
    REQUIRE(::waitpid(child, &status, 0) == child);
    CHECK(status == 0);
    for (std::size_t i = 0; i < kPackets; i += 97)
        REQUIRE(is_made(all[i], i, kSize));
}
