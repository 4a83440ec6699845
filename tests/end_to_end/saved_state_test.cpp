// --save-state and --from-state: a run from a state is the same run; a state that does not fit is refused.

#include "tests/end_to_end/kit/one_line.h"
#include "tests/end_to_end/kit/same_run.h"
#include "tests/end_to_end/kit/workbench.h"

#include <catch2/catch.hpp>

#include <fstream>

using namespace puckloop::tests;
namespace fs = std::filesystem;

namespace {

const std::string kTwoRobots = R"(
[[robot]]
name = "robot1"
position = ["20 cm", "-20 cm"]
heading = "100 deg"

[robot.pic]
firmware = ")" PUCKLOOP_SOURCE R"(/firmware/epuck/epuck.hex"
)";

const std::string kBoards = R"(
[robot.rab]
firmware = ")" PUCKLOOP_SOURCE R"(/firmware/rab/rab.hex"
)";

/// A state of hello() at 0.8 s.
fs::path saved(const Workbench& bench, const std::string& more = {}) {
    const fs::path state = bench.folder() / "ready.state";
    const Ended ended =
        bench.run("save", {bench.hello(more), "--save-state", state, "--at", "800 ms", "--duration", "0.8"});
    INFO(ended.err);
    REQUIRE(ended.status == 0);
    CHECK_THAT(ended.out, Catch::Contains("state of the boards at 0.8 s in " + state.string()));
    return state;
}

}  // namespace

TEST_CASE("a run from a state is the same run") {
    const Workbench bench;
    // Both kinds of board.
    const fs::path state = saved(bench, kBoards);
    const Words words{bench.hello(kBoards), "--duration", "3"};
    REQUIRE(bench.run("plain", words).status == 0);
    for (const bool in_process : {true, false}) {
        Words from = words;
        from.insert(from.end(), {"--from-state", state});
        if (in_process) from.push_back("--in-process");
        const Ended ended = bench.run("from", from);
        INFO(ended.err);
        REQUIRE(ended.status == 0);
        CHECK_THAT(ended.out, Catch::Contains("robot0.pic: from its state at 0.8 s"));
        CHECK_THAT(ended.out, Catch::Contains("robot0.rab: from its state at 0.8 s"));
        check_same_run(bench, "plain", "from");
        CHECK(bench.report("from")["warnings"].empty());
        for (const char* log : {"robot0.pic.log", "robot0.rab.log"})
            CHECK(text_of(bench.out("from") / log) == text_of(bench.out("plain") / log));
    }
    // No parts are left behind.
    CHECK(std::distance(fs::directory_iterator(bench.folder()), fs::directory_iterator()) >= 3);
    for (const auto& entry : fs::directory_iterator(bench.folder()))
        CHECK(entry.path().string().find(".part") == std::string::npos);
}

TEST_CASE("a state can be saved from a run that began with one") {
    const Workbench bench;
    const fs::path state = saved(bench);
    const fs::path later = bench.folder() / "later.state";
    const Ended ended = bench.run("second", {bench.hello(), "--from-state", state, "--save-state", later,
                                             "--at", "2", "--duration", "3"});
    INFO(ended.err);
    REQUIRE(ended.status == 0);
    // A program runs by then.
    CHECK_THAT(ended.out, Catch::Contains("robot0.linux: runs already at 2 s and is not part of the state"));
    REQUIRE(bench.run("plain", {bench.hello(), "--duration", "3"}).status == 0);
    REQUIRE(bench.run("third", {bench.hello(), "--from-state", later, "--duration", "3"}).status == 0);
    check_same_run(bench, "plain", "second");
    check_same_run(bench, "plain", "third");
}

TEST_CASE("a state is loaded in another world, and the run prints where it does not fit") {
    const Workbench bench;
    const fs::path state = saved(bench);
    std::string text = text_of(bench.hello());
    text.replace(text.find("\"-10 cm\", \"0 cm\""), 16, "\"17 cm\", \"15 cm\"");
    const Ended ended = bench.run(
        "moved", {bench.file("moved.toml", text), "--from-state", state, "--seed", "77", "--duration", "5"});
    INFO(ended.err);
    CHECK(ended.status == 0);
    CHECK_THAT(ended.out,
               Catch::Contains("robot0.pic: did not live through the first 0.800 s of this run: it "));
    CHECK_THAT(ended.out, Catch::Contains("on port world at 0.00"));
    CHECK_THAT(ended.out, Catch::Contains("its state was saved with another seed"));
    CHECK(bench.report("moved")["nodes"]["robot0.pic"]["uart2"]["sent"] > 1000);
}

TEST_CASE("a run of other noise may end before its state's time") {
    const Workbench bench;
    const fs::path state = bench.folder() / "late.state";
    REQUIRE(
        bench.run("late", {bench.hello(), "--save-state", state, "--at", "2s", "--duration", "2"}).status ==
        0);
    const Ended ended =
        bench.run("early", {bench.hello(), "--from-state", state, "--seed", "77", "--duration", "1.5"});
    INFO(ended.err);
    CHECK(ended.status == 0);
    CHECK_THAT(ended.out, Catch::Contains("robot0.pic: from its state at 2 s"));
}

TEST_CASE("one saved board serves all robots with its firmware") {
    const Workbench bench;
    const fs::path state = saved(bench);
    const Ended ended = bench.run("two", {bench.hello(kTwoRobots), "--from-state", state, "--duration", "2"});
    INFO(ended.err);
    CHECK(ended.status == 0);
    CHECK_THAT(ended.out, Catch::Contains("robot0.pic: from its state at 0.8 s"));
    CHECK_THAT(ended.out, Catch::Contains("robot1.pic: from its state at 0.8 s"));
    // Of two saved boards none is the one for a third robot.
    const fs::path two = bench.folder() / "two.state";
    REQUIRE(
        bench.run("two", {bench.hello(kTwoRobots), "--save-state", two, "--at", "0.5s", "--duration", "1"})
            .status == 0);
    std::string third = kTwoRobots;
    third.replace(third.find("robot1"), 6, "robot2");
    check_one_line(bench.run("x", {bench.hello(third), "--from-state", two}), 2,
                   {two.string(), "robot2.pic", "robot0.pic, robot1.pic"});
}

TEST_CASE("states that do not fit are refused with one line") {
    const Workbench bench;
    const fs::path state = saved(bench);
    const fs::path hello = bench.hello();
    const auto refused = [&](Words words, const Words& expected) {
        words.insert(words.begin(), hello);
        check_one_line(bench.run("x", words), 2, expected);
        CHECK(!fs::exists(bench.out("x")));  // nothing of it has begun
    };
    refused({"--from-state", "/nonexistent.state"}, {"/nonexistent.state", "cannot be read"});
    refused({"--from-state", hello}, {"is no state file"});
    const std::string whole = text_of(state);
    refused({"--from-state", bench.file("cut.state", whole.substr(0, 1000))}, {"cut.state", "checksum"});
    std::string other = whole;
    other[25] = static_cast<char>(other[25] + 1);
    refused({"--from-state", bench.file("version.state", other)}, {"version.state", "format"});
    other = whole;
    other[whole.size() / 2] ^= 1;
    refused({"--from-state", bench.file("bit.state", other)}, {"bit.state", "damaged"});
    // The same program in a file that differs by a comment is other firmware.
    const std::string image = text_of(PUCKLOOP_SOURCE "/firmware/epuck/epuck.hex");
    refused(
        {"--from-state", state, "--firmware", "robot0.pic=" + bench.file("other.hex", image + "\n").string()},
        {"ready.state", "robot0.pic", "other firmware"});
    refused({"--from-state", state, "--save-state", bench.folder() / "y", "--at", "0.5"}, {"--at", "0.8"});
    refused({"--save-state", bench.folder() / "y"}, {"--save-state", "--at"});
    refused({"--at", "3s"}, {"--at"});
    refused({"--save-state", bench.folder() / "y", "--at", "soon"}, {"--at", "soon"});
    refused({"--save-state", bench.folder() / "y", "--at", "9s", "--duration", "5"},
            {"--at", "after the end"});
    refused({"--save-state", bench.folder(), "--at", "1s"}, {"is a folder"});
    refused({"--save-state", "/proc/x.state", "--at", "1s"}, {"/proc/x.state"});
    CHECK(text_of(state) == whole);
}

TEST_CASE("a run that ends before the state is due has failed") {
    const Workbench bench;
    const fs::path state = saved(bench);
    const std::string whole = text_of(state);
    const Ended ended =
        bench.run("short", {bench.hello(), "--save-state", state, "--at", "30s", "--linux",
                            "puckloop-control", "--", "--duration", "1", "--behaviour", "wander"});
    INFO(ended.err);
    CHECK(ended.status == 1);
    CHECK_THAT(ended.err, Catch::Contains("no state saved: the run ended at "));
    const bool as_it_was = text_of(state) == whole;
    CHECK(as_it_was);
}
