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

TEST_CASE("of a long word in an error a part is shown, of a long sentence all") {
    const puckloop::InputError word("", "--board", "no board '" + std::string(100'000, 'x') + "' here",
                                    "pic");
    const std::string what = word.what();
    CHECK(what.size() < 200);
    CHECK(what.starts_with("--board: no board 'xxx"));
    CHECK(what.ends_with("xxx' here (expected pic)"));
    std::string sentence = "not one of";
    for (int i = 0; i < 100; ++i)
        sentence += " word" + std::to_string(i);
    CHECK(std::string(puckloop::InputError("", "", sentence).what()) == sentence);
}
