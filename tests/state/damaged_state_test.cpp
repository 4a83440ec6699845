// A damaged state is refused with one line, or loads and runs on: it never leads out of the model.

#include "tests/state/board_runs.h"

#include <catch2/catch.hpp>

using namespace puckloop;
using namespace puckloop::tests;

namespace {

struct Seen {
    int refused = 0;
    int went_on = 0;
};

Seen mutate(const MakeBoard& make, cosim::Time at, int mutations, const std::string& name) {
    RandomStream random(11, name);
    const auto board = make();
    std::vector<cosim::Message> outbox;
    board->advance(at, {}, outbox);
    const auto good = saved(*board);
    Seen seen;
    for (int i = 0; i < mutations; ++i) {
        auto bytes = good;
        // Program and RAM fill most of it: half the changes go to the front and the end, where the rest is.
        constexpr std::uint64_t kDense = 5000;
        for (std::uint64_t change = 1 + random.below(4); change > 0; --change) {
            const std::uint64_t place = random.below(2) ? random.below(kDense) : random.below(bytes.size());
            const std::uint64_t byte = random.below(2) ? place : bytes.size() - 1 - place;
            bytes[byte] = static_cast<std::uint8_t>(random.below(256));
        }
        if (random.below(20) == 0) bytes.resize(random.below(bytes.size()));
        try {
            const auto copy = loaded(make, bytes);
            ++seen.went_on;
            outbox.clear();
            copy->advance(at + cosim::kMillisecond, {}, outbox);
            copy->finish();
        } catch (const StateError& error) {
            ++seen.refused;
            const std::string line = error.what();
            REQUIRE(!line.empty());
            REQUIRE(line.find('\n') == std::string::npos);
        }
    }
    return seen;
}

}  // namespace

TEST_CASE("damaged states of boards are refused or go on") {
    const Seen pic = mutate(pic_board(own_pic_image()), 30 * cosim::kMillisecond, 700, "pic");
    CHECK(pic.refused > 50);
    CHECK(pic.went_on > 50);
    const Seen rab = mutate(rab_board(own_rab_image()), 30 * cosim::kMillisecond, 400, "rab");
    CHECK(rab.refused > 30);
    CHECK(rab.went_on > 30);
}

TEST_CASE("a state of another chip is refused") {
    const auto pic = pic_board(own_pic_image());
    const auto rab = rab_board(own_rab_image());
    CHECK_THROWS_AS(loaded(rab, saved(*pic())), StateError);
    CHECK_THROWS_AS(loaded(pic, saved(*rab())), StateError);
}
