// One error is one line, whatever the user's text holds.

#include "base/error.h"

#include <catch2/catch.hpp>

#include <string>

TEST_CASE("an error shows control characters and stays one line") {
    const puckloop::InputError error("a\nb.toml", "line 1", "unknown key 'x\x1b[2J\x7f'", "one\tword");
    CHECK(std::string(error.what()) ==
          "a\\nb.toml: line 1: unknown key 'x\\x1b[2J\\x7f' (expected one\\tword)");
    CHECK(error.file() == "a\nb.toml");
}

TEST_CASE("an error leaves text of other languages alone") {
    CHECK(std::string(puckloop::InputError("é.toml", "", "grün").what()) == "é.toml: grün");
}
