// What the network manager makes of robots' lines, and whom a message reaches.

#include "base/json.h"
#include "base/random.h"
#include "linuxboard/netmanager/traffic.h"

#include <catch2/catch.hpp>

using namespace puckloop::netmanager;

TEST_CASE("a line is a number, a place if it has one, and data", "[netmanager]") {
    CHECK(parse_message("12 hello there") == Message{12, {}, "hello there"});
    CHECK(parse_message("0012 hello") == Message{12, {}, "hello"});
    CHECK(parse_message("-1 to all") == Message{kEverybody, {}, "to all"});
    CHECK(parse_message("9999 to all") == Message{kEverybody, {}, "to all"});
    CHECK(parse_message("3 @0.5,-1.25 x y") == Message{3, Place{0.5, -1.25}, "x y"});
    CHECK(parse_message("3 @1,2") == Message{3, Place{1, 2}, ""});
    CHECK(parse_message("\n7 behind a line feed") == Message{7, {}, "behind a line feed"});
    CHECK(parse_message("5") == Message{5, {}, ""});
    for (const char* bad : {"", "x", " 1", "1x", "-2 x", "10000 x", "99999999999 x", "1 @", "1 @1", "1 @1,",
                            "1 @1,2x", "1 @nan,0 x", "1 @inf,0"})
        CHECK_FALSE(parse_message(bad));
    CHECK_FALSE(parse_message("1 " + std::string(kLongest, 'x')));
    CHECK(line_from(4, "answer") == "4 answer\r");
}

TEST_CASE("a message goes as far as distance and hops allow", "[netmanager]") {
    // In a row, a metre apart; robot 9 has not said where it is.
    const Places row{{1, Place{0, 0}}, {2, Place{1, 0}}, {3, Place{2, 0}}, {4, Place{3, 0}}};
    using Hops = std::map<int, int>;
    CHECK(reached(row, 1, {}) == Hops{{2, 1}, {3, 1}, {4, 1}});
    CHECK(reached(row, 1, {1.5, 1}) == Hops{{2, 1}});
    CHECK(reached(row, 2, {1.5, 1}) == Hops{{1, 1}, {3, 1}});
    CHECK(reached(row, 1, {1.5, 2}) == Hops{{2, 1}, {3, 2}});
    CHECK(reached(row, 1, {1.5, 9}) == Hops{{2, 1}, {3, 2}, {4, 3}});
    CHECK(reached(row, 1, {0.5, 9}).empty());
    CHECK(reached(row, 1, {1.0, 1}) == Hops{{2, 1}});  // the limit itself counts
    Places more = row;
    more[9] = {};
    CHECK(reached(more, 1, {1.5, 2}) == Hops{{2, 1}, {3, 2}, {4, 2}, {9, 1}});
    CHECK(reached(row, 7, {}).empty());
}

TEST_CASE("settings are changed by words, and wrong ones change nothing", "[netmanager]") {
    Settings settings;
    for (const char* words : {"range 1.5", "hops 3\r\n", " delay  0.25 ", "loss 0.5", "loss 1 2 7", "show"}) {
        INFO(words);
        CHECK(apply_words(words, settings).empty());
    }
    CHECK(settings.limits.range == 1.5);
    CHECK(settings.limits.hops == 3);
    CHECK(settings.hop_delay == std::chrono::milliseconds(250));
    CHECK(settings.loss_between(1, 2) == 0.5);
    CHECK(settings.loss_between(2, 7) == 1.0);
    CHECK(settings.loss_between(7, 2) == 0.5);
    CHECK(apply_words("range none", settings).empty());
    CHECK_FALSE(settings.limits.range);
    for (const char* words : {"", " ", "range", "range x", "range -1", "range 1 2", "hops 0", "hops 1.5",
                              "delay 61", "loss 1.1", "loss nan", "loss 1 2", "loss 1 2 3 4", "loss 1 -2 3",
                              "loss 1 2 9999", "show me", "shows", "range\t"}) {
        INFO(words);
        CHECK_FALSE(apply_words(words, settings).empty());
    }
    CHECK(settings.loss == 0.5);
    CHECK(apply_words("warp 9", settings) ==
          "'warp' (expected range M, hops N, delay S, loss P [FROM TO] or show)");
    CHECK(apply_words(std::string(2000, 'x'), settings).size() < 200);
}

TEST_CASE("the status is JSON with links, rates and the last messages", "[netmanager]") {
    Settings settings;
    settings.limits = {1.5, 2};
    settings.loss_of_link[{1, 3}] = 0.25;
    const Places places{{1, Place{0, 0}}, {2, Place{1, 0}}, {3, Place{2, 0.5}}, {9, Place{9, 9}}};
    Traffic traffic;
    for (int i = 0; i < 12; ++i)
        traffic.add(i, 1, 2, 1, "hello " + std::to_string(i), i % 4 == 3 ? "lost" : "passed");
    traffic.add(12, 1, 9, 0, "\"a\\\x01\xff" + std::string(100, 'x'), "too_far");
    const auto status = nlohmann::json::parse(traffic.status(14.5, settings, places));
    CHECK(status["time_s"] == 14.5);
    CHECK(status["range_m"] == 1.5);
    CHECK(status["hops"] == 2);
    CHECK(status["robots"] == nlohmann::json::parse("[[1,0,0],[2,1,0],[3,2,0.5],[9,9,9]]"));
    REQUIRE(status["links"].size() == 12);
    // Of 12 at 0 to 11 s nine passed, five of them at 5 s and later.
    CHECK(status["links"][0] == nlohmann::json::parse("[1,2,1,9,3,0.5,0]"));
    CHECK(status["links"][1] == nlohmann::json::parse("[1,3,2,0,0,0,0.25]"));
    CHECK(status["links"][2] == nlohmann::json::parse("[1,9,0,0,1,0,0]"));
    REQUIRE(status["last"].size() == Traffic::kKept);
    CHECK(status["last"][0] == nlohmann::json::parse(R"([3,1,2,1,7,"lost","hello 3"])"));
    CHECK(status["last"].back()[4] == 105);
    CHECK(status["last"].back()[6].get<std::string>().size() == 41);  // 0xff is two octets of UTF-8
    settings.limits.range.reset();
    const auto open = nlohmann::json::parse(traffic.status(0.0, settings, {{1, {}}}));
    CHECK(open["range_m"].is_null());
    CHECK(open["robots"] == nlohmann::json::parse("[[1]]"));
    CHECK(open["links"].empty());
}

TEST_CASE("no words bring the manager down, and what is refused changes nothing (seeded)", "[netmanager]") {
    puckloop::RandomStream random(42, "netmanager words");
    const std::vector<std::string> pieces{"range", "hops", "delay", "loss", "show", "none", "0.5",
                                          "1",     "7",    "9999",  "-1",   "nan",  "inf",  "1e400",
                                          "0x1",   " ",    "\t",    "\r",   "\n",   "",     "loss 1"};
    int taken = 0;
    for (int i = 0; i < 20'000; ++i) {
        std::string words;
        for (auto n = random.below(6); n > 0; --n)
            words += pieces[random.below(pieces.size())] + (random.below(3) != 0 ? " " : "");
        if (random.below(10) == 0 && !words.empty())
            words[random.below(words.size())] = static_cast<char>(random.below(256));
        Settings settings, before;
        const std::string wrong = apply_words(words, settings);
        taken += wrong.empty() ? 1 : 0;
        CHECK(wrong.size() < 200);
        if (wrong.empty()) {
            CHECK(settings.limits.hops >= 1);
            CHECK((settings.loss >= 0 && settings.loss <= 1));
            continue;
        }
        CHECK(settings.limits.hops == before.limits.hops);
        CHECK(settings.limits.range == before.limits.range);
        CHECK(settings.hop_delay == before.hop_delay);
        CHECK(settings.loss == before.loss);
        CHECK(settings.loss_of_link.empty());
    }
    CHECK(taken > 500);
    CHECK(taken < 15'000);
}
