// What the network manager makes of robots' lines, and whom a message reaches.

#include "linuxboard/netmanager/reach.h"

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
