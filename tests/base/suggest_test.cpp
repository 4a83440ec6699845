#include "base/suggest.h"

#include <catch2/catch.hpp>

using namespace puckloop;

TEST_CASE("Edit distance counts single changes and ignores case") {
    CHECK(edit_distance("", "") == 0);
    CHECK(edit_distance("abc", "ABC") == 0);
    CHECK(edit_distance("kitten", "sitting") == 3);
    CHECK(edit_distance("", "four") == 4);
    CHECK(edit_distance("mvo", "mov") == 1);
}

TEST_CASE("The nearest name is near, or there is none") {
    const std::vector<std::string_view> known{"seed", "speed", "world"};
    CHECK(nearest_name("sped", known) == "seed");
    CHECK(nearest_name("wrold", known) == "world");
    CHECK(nearest_name("banana", known).empty());
    CHECK(nearest_name("se", known).empty());
}
