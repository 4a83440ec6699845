// Saved state: what goes in comes out, and nothing that is damaged gets in.

#include "base/states/archive.h"

#include "base/random.h"

#include <catch2/catch.hpp>

#include <limits>

using namespace puckloop;

namespace {

enum class Colour : std::uint8_t { Red, Green, Blue };

struct Inner {
    std::int16_t number = 0;
    std::vector<std::string> names{};

    template <class Archive>
    void state(Archive& archive) {
        archive(number, names);
    }
    friend bool operator==(const Inner&, const Inner&) = default;
};

struct Outer {
    Colour colour = Colour::Red;
    bool flag = false;
    double level = 0.0;
    std::array<std::uint16_t, 3> words{};
    std::optional<std::uint32_t> maybe{};
    std::vector<std::uint8_t> table = std::vector<std::uint8_t>(4);
    std::deque<std::pair<std::int64_t, Inner>> queue{};
    Inner inner{};

    template <class Archive>
    void state(Archive& archive) {
        archive.bounded(colour, Colour::Red, Colour::Blue);
        archive(flag);
        archive.bounded(level, -10.0, 10.0);
        archive(words, maybe);
        archive.fixed(table);
        archive(queue);
        archive.part("inner", inner);
    }
    friend bool operator==(const Outer&, const Outer&) = default;
};

Outer example() {
    Outer outer;
    outer.colour = Colour::Blue;
    outer.flag = true;
    outer.level = -0.125;
    outer.words = {1, 0xFFFF, 0x1234};
    outer.maybe = 7;
    outer.table = {9, 8, 7, 6};
    outer.queue.push_back({std::numeric_limits<std::int64_t>::min(), {-3, {"a", ""}}});
    outer.inner = {12, {"left", "right"}};
    return outer;
}

std::vector<std::uint8_t> bytes_of(const Outer& outer) {
    std::vector<std::uint8_t> bytes;
    StateWriter writer(bytes);
    writer.part("outer", outer);
    return bytes;
}

Outer read(const std::vector<std::uint8_t>& bytes) {
    Outer outer;
    StateReader reader(bytes);
    reader.part("outer", outer);
    reader.end();
    return outer;
}

std::string problem(const std::vector<std::uint8_t>& bytes) {
    try {
        read(bytes);
    } catch (const StateError& error) {
        return error.what();
    }
    return {};
}

}  // namespace

TEST_CASE("a state comes back as it was saved") {
    const Outer outer = example();
    const auto bytes = bytes_of(outer);
    CHECK(read(bytes) == outer);
    CHECK(bytes_of(read(bytes)) == bytes);
    CHECK(bytes[0] == 5);  // little-endian length of "outer"
    CHECK(bytes[1] == 0);
}

TEST_CASE("a state that does not fit is refused with its place") {
    auto bytes = bytes_of(example());
    bytes.resize(bytes.size() - 1);
    CHECK(problem(bytes) == "a length beyond the end (byte 13 of 104)");
    bytes = bytes_of(example());
    const std::size_t colour = 4 + 5 + 4;
    bytes[colour] = 3;
    CHECK(problem(bytes) == "outer: a number is out of range (byte 14 of 105)");
    bytes = bytes_of(example());
    bytes[colour + 1] = 2;
    CHECK(problem(bytes).find("a flag is neither 0 nor 1") != std::string::npos);
    Outer other = example();
    other.table.push_back(1);
    CHECK(problem(bytes_of(other)).find("outer: another size") != std::string::npos);
    other = example();
    other.level = std::numeric_limits<double>::quiet_NaN();
    CHECK(problem(bytes_of(other)).find("out of range") != std::string::npos);
    bytes = bytes_of(example());
    bytes[4] = 'i';
    CHECK(problem(bytes).find("part 'iuter' where 'outer' is expected") != std::string::npos);
}

TEST_CASE("damaged states are refused or read, never more") {
    RandomStream random(3, "archive");
    const auto good = bytes_of(example());
    int refused = 0;
    for (int i = 0; i < 20'000; ++i) {
        auto bytes = good;
        const auto changes = 1 + random.below(3);
        for (std::uint64_t change = 0; change < changes; ++change)
            bytes[random.below(bytes.size())] = static_cast<std::uint8_t>(random.below(256));
        if (random.below(4) == 0) bytes.resize(random.below(bytes.size()));
        if (!problem(bytes).empty()) ++refused;
    }
    CHECK(refused > 5'000);
    CHECK(refused < 20'000);
}
