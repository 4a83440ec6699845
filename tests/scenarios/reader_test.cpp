#include "base/error.h"
#include "base/random.h"
#include "scenarios/values/reader.h"
#include "tests/scenarios/temporary_file.h"

#include <catch2/catch.hpp>

using namespace puckloop;
using namespace puckloop::scenarios;

namespace {

template <typename Action>
std::string message_of(Action action) {
    try {
        action();
    } catch (const InputError& error) {
        return error.what();
    }
    return "no error";
}

}  // namespace

TEST_CASE("a key that nobody knows is named with its line and the nearest known key") {
    const TemporaryFile file("[run]\n\nduraton = \"60 s\"\n");
    const TomlValue root = read_toml(file.path());
    Reader top("s.toml", "", root);
    Reader run("s.toml", "run", *top.table("run"));
    run.quantity("duration", Dimension::Time, 1.0);
    run.integer("seed", 1, 0, 100);
    CHECK(message_of([&] { run.finish(); }) ==
          "s.toml: line 3: run: unknown key 'duraton' (expected perhaps 'duration')");
}

TEST_CASE("a wrong unit is named with its line") {
    const TemporaryFile file("[run]\nduration = \"60 m\"\nstep = 5\n");
    const TomlValue root = read_toml(file.path());
    Reader top("s.toml", "", root);
    Reader run("s.toml", "run", *top.table("run"));
    CHECK(message_of([&] { run.quantity("duration", Dimension::Time); }) ==
          "s.toml: line 2: run: duration: '60 m' is a length (expected a time such as \"20 ms\")");
    CHECK(message_of([&] { run.quantity("step", Dimension::Time); }) ==
          "s.toml: line 3: run: step: 5 has no unit (expected a time such as \"20 ms\")");
    CHECK(message_of([&] { run.text("name"); }) == "s.toml: line 1: run: 'name' is missing");
}

TEST_CASE("lists, choices and ranges are checked") {
    const TemporaryFile file(
        "size = [\"1 m\", \"80 cm\"]\nkind = \"disk\"\nn = 12\nwords = [\"a\", \"b\"]\n");
    const TomlValue root = read_toml(file.path());
    Reader top("s.toml", "", root);
    CHECK(top.quantities("size", Dimension::Length, 2) == std::vector<double>{1.0, 0.8});
    CHECK(message_of([&] { top.quantities("size", Dimension::Length, 3); }).find("list of 3") !=
          std::string::npos);
    CHECK(message_of([&] {
              top.choice("kind", "disc", {"disc", "rectangle"});
          }) == "s.toml: line 2: kind: 'disk' is not known (expected one of disc, rectangle)");
    CHECK(message_of([&] { top.integer("n", 0, 0, 9); }) ==
          "s.toml: line 3: n is out of range (expected a whole number from 0 to 9)");
    CHECK(top.texts("words") == std::vector<std::string>{"a", "b"});
    CHECK_NOTHROW(top.finish());
}

TEST_CASE("files that are not TOML are refused with a line") {
    CHECK(message_of([] { read_toml("/nonexistent/x.toml"); }) ==
          "/nonexistent/x.toml: cannot be opened: No such file or directory (expected a TOML file)");
    const TemporaryFile file("[run]\nduration = \n");
    CHECK(message_of([&] { read_toml(file.path()); }).find(": line 2, column ") != std::string::npos);
}

TEST_CASE("no mutation of a scenario crashes the reader") {
    const std::string good =
        "[run]\nduration = \"60 s\"\nseed = 1\n[[box]]\ncentre = [\"1 m\", \"2 m\"]\nx = 1.5e3\n"
        "s = 'q'\nb = true\nt = { a = 1, b = [1, 2] }\n";
    RandomStream random(20261121, "toml fuzz");
    const std::string alphabet = "[]{}=\"'\\#\n.,-+eE0123456789abz \t\x01\xff";
    for (int round = 0; round < 400; ++round) {
        std::string text = good;
        for (auto edits = 1 + random.below(4); edits > 0; --edits) {
            const std::size_t at = random.below(text.size());
            switch (random.below(3)) {
            case 0:
                text[at] = alphabet[random.below(alphabet.size())];
                break;
            case 1:
                text.erase(at, 1 + random.below(5));
                break;
            default:
                text.insert(at, 1, alphabet[random.below(alphabet.size())]);
            }
            if (text.empty()) text = " ";
        }
        const TemporaryFile file(text);
        const std::string outcome = message_of([&] {
            const TomlValue root = read_toml(file.path());
            Reader top("s.toml", "", root);
            top.everything();
        });
        CAPTURE(text);
        CHECK((outcome == "no error" || outcome.find("line ") != std::string::npos ||
               outcome.find("valid TOML") != std::string::npos));
    }
}
