// The table of events: numbers, texts, search, what is left out when there are too many.

#include "view/events/event_table.h"

#include <catch2/catch.hpp>

#include <fmt/format.h>

#include <cstring>
#include <random>

using namespace puckloop::view;

namespace {

std::uint32_t number_at(const std::string& bytes, std::size_t index) {
    std::uint32_t value = 0;
    std::memcpy(&value, bytes.data() + 4 * index, sizeof value);
    return value;
}

}  // namespace

TEST_CASE("events come back as they were added, from any number on") {
    EventTable table;
    const auto first = table.track({"a", "epuck", "robot0"}), second = table.track({"b", "log", ""});
    CHECK(table.track({"a", "epuck", "robot0"}) == first);
    for (int i = 0; i < 1000; ++i)
        table.add(i % 2 == 0 ? first : second, 0.5 * i, 0.25, i % 10 == 0 ? kFailed : 0,
                  fmt::format("text {}", i));
    const std::string block = table.block(990, 5);
    CHECK(block.size() == 16 + 5 * 15);
    CHECK(number_at(block, 0) == 0);
    CHECK(number_at(block, 1) == 990);
    CHECK(number_at(block, 2) == 5);
    CHECK(number_at(block, 3) == 1000);
    double begin = 0;
    std::memcpy(&begin, block.data() + 16 + 8, sizeof begin);
    CHECK(begin == 495.5);
    CHECK(block.back() == 0);
    CHECK(block[block.size() - 5] == kFailed);
    CHECK(table.block(1000, 5).size() == 16);
    CHECK(table.block(~std::size_t{0}, 5).size() == 16);
    CHECK(table.texts({0, 999, 1000, 17}) == std::vector<std::string>{"text 0", "text 999", "", "text 17"});
}

TEST_CASE("texts are found in the file and in what is not written yet, whatever the case of letters") {
    EventTable table;
    const auto track = table.track({"a", "log", ""});
    const std::size_t count = 20'000;  // some buffers' worth
    for (std::size_t i = 0; i < count; ++i)
        table.add(track, 0, 0, kRare, fmt::format("{} Actuators LEFT {}", std::string(30, '.'), i));
    CHECK(table.find("left 19999", 10) == std::vector<std::uint32_t>{19'999});
    CHECK(table.find("ACTUATORS", 7).size() == 7);
    CHECK(table.find("left 1234", 1000).size() == 11);  // 1234, 12340 .. 12349
    CHECK(table.find("5 .", 1000).empty());             // of two neighbours
    CHECK(table.texts({12'345})[0].ends_with("LEFT 12345"));
}

TEST_CASE("too many plain events are thinned, and none of the others") {
    EventTable table(1000);
    const auto busy = table.track({"busy", "i2c", ""}), quiet = table.track({"quiet", "epuck", ""});
    std::size_t failed = 0, rare = 0;
    for (int i = 0; i < 50'000; ++i) {
        table.add(busy, i, 0, 0, "plain");
        if (i % 500 == 0) table.add(quiet, i, 0, 0, fmt::format("quiet {}", i));
        if (i % 100 == 0) table.add(busy, i, 0, kFailed, "broken"), ++failed;
        if (i % 1000 == 0) table.add(busy, i, 0, kRare, "rare"), ++rare;
    }
    const auto status = table.status();
    CHECK(table.find("broken", 10'000).size() == failed);
    CHECK(table.find("rare", 10'000).size() == rare);
    CHECK(status.events <= 1000 + failed + rare);
    CHECK(status.events + status.left_out == 50'000 + 100 + failed + rare);
    CHECK(status.generation > 0);
    CHECK(number_at(table.block(0, 1), 0) == status.generation);
    CHECK(table.find("quiet 0", 10).size() == 1);  // the first stays
    CHECK(table.find("quiet", 1000).size() > 1);
}

TEST_CASE("a text of any bytes and length is kept up to its limit") {
    EventTable table;
    const auto track = table.track({"a", "log", ""});
    table.add(track, 0, 0, 0, std::string(100'000, 'x'));
    table.add(track, 0, 0, 0, std::string("\0\xff\n", 3));
    CHECK(table.texts({0})[0].size() == EventTable::kLongestText);
    CHECK(table.texts({1})[0] == std::string("\0\xff\n", 3));
    CHECK(table.find(std::string("\xff", 1), 10) == std::vector<std::uint32_t>{1});
}
