// The results folder: one run at a time, and nothing left of the run before.

#include "tests/end_to_end/kit/one_line.h"

#include <catch2/catch.hpp>

#include <fmt/format.h>

#include <sys/stat.h>

#include <chrono>
#include <csignal>
#include <filesystem>
#include <thread>

using namespace puckloop::tests;
namespace fs = std::filesystem;

namespace {

const std::string kHello = PUCKLOOP_SOURCE "/scenarios/hello.toml";
const std::string kPair = PUCKLOOP_SOURCE "/scenarios/rab_pair.toml";

}  // namespace

TEST_CASE("a second run into the same folder is refused and names the first") {
    const Workbench bench;
    const auto first =
        bench.start({"run", kHello, "--realtime", "--duration", "600", "--out", bench.out("o")});
    const double begun = wall_seconds();
    while (text_of(bench.out("o") / "trajectory.csv").size() < 200 && wall_seconds() - begun < 60)
        std::this_thread::sleep_for(std::chrono::milliseconds(20));
    const Ended second = bench.run("o", {kHello, "--duration", "1"});
    check_one_line(second, 2, {"o: process " + std::to_string(first->id()), "--out"});
    first->signal(SIGINT);
    CHECK(first->wait().status == 128 + SIGINT);
    CHECK(bench.report("o")["duration_s"] != 1);  // the first run's
    CHECK(bench.csv("o", "trajectory.csv").size() > 1);

    SECTION("the folder is free when the first has ended") {
        CHECK(bench.run("o", {kHello, "--duration", "1"}).status == 0);
    }
    SECTION("or was killed") {
        const auto third =
            bench.start({"run", kHello, "--realtime", "--duration", "600", "--out", bench.out("o")});
        while (!fs::exists(bench.out("o") / "trajectory.csv") && wall_seconds() - begun < 120)
            std::this_thread::sleep_for(std::chrono::milliseconds(20));
        third->signal(SIGKILL);
        third->wait();
        CHECK(bench.run("o", {kHello, "--duration", "1"}).status == 0);
    }
}

TEST_CASE("a folder's name is shown without what a terminal obeys") {
    const Workbench bench;
    const Ended ended = bench.run("o\x1b[31m", {kHello, "--duration", "0.1"});
    CHECK(ended.status == 0);
    CHECK(ended.out.find('\x1b') == std::string::npos);
    CHECK_THAT(ended.out, Catch::Contains("o\\x1b[31m"));
}

TEST_CASE("files of an earlier, larger run go, a user's own stay") {
    const Workbench bench;
    REQUIRE(bench.run("o", {kPair, "--duration", "0.2"}).status == 0);
    const fs::path out = bench.out("o");
    REQUIRE(fs::exists(out / "follower.rab.log"));
    REQUIRE(fs::exists(out / "ir.csv"));
    for (const char* own : {"o/notes.txt", "o/leader.mine.log", "o/robot7.pic.log"})
        bench.file(own, "mine\n");
    fs::create_directories(out / "world.received");  // a folder under the name of a file
    REQUIRE(bench.run("o", {kHello, "--duration", "0.2"}).status == 0);
    CHECK_FALSE(fs::exists(out / "follower.rab.log"));
    CHECK_FALSE(fs::exists(out / "leader.linux.log"));
    CHECK_FALSE(fs::exists(out / "ir.csv"));
    CHECK(fs::exists(out / "robot0.pic.log"));
    for (const char* own : {"notes.txt", "leader.mine.log", "robot7.pic.log"})
        CHECK(text_of(out / own) == "mine\n");
    CHECK(fs::is_directory(out / "world.received"));
}

TEST_CASE("a damaged list of files removes nothing outside of the folder") {
    const Workbench bench;
    REQUIRE(bench.run("o", {kHello, "--duration", "0.1"}).status == 0);
    bench.file("beside.txt", "mine\n");
    const std::string list = text_of(bench.out("o") / ".puckloop");
    bench.file("o/.puckloop",
               "../beside.txt\n/etc/hostname\n.\n..\n\n" + std::string(5000, 'x') + "\n" + list);
    CHECK(bench.run("o", {kHello, "--duration", "0.1"}).status == 0);
    CHECK(text_of(bench.folder() / "beside.txt") == "mine\n");
}

TEST_CASE("a mark is looked into: what it does not list is a user's") {
    const Workbench bench;
    const fs::path mark = bench.out("o") / ".puckloop";
    const auto refused = [&](const char* name, const char* why) {
        check_one_line(bench.run("o", {kHello, "--duration", "0.1"}), 2, {name, why});
    };
    SECTION("an empty mark") {
        fs::create_directories(bench.out("o"));
        bench.file("o/.puckloop", "");
        bench.file("o/trace.csv", "mine\n");
        refused("trace.csv", "that does not list it");
        CHECK(text_of(bench.out("o") / "trace.csv") == "mine\n");
    }
    SECTION("another run's names") {
        REQUIRE(bench.run("o", {kHello, "--duration", "0.1"}).status == 0);
        bench.file("o/leader.pic.log", "mine\n");
        check_one_line(bench.run("o", {kPair, "--duration", "0.1"}), 2,
                       {"leader.pic.log", "that does not list it"});
        CHECK(text_of(bench.out("o") / "leader.pic.log") == "mine\n");
        CHECK(fs::exists(bench.out("o") / "robot0.pic.log"));  // the run before's are still there
    }
    SECTION("a hard link") {
        bench.file("victim.txt", "mine\n");
        fs::create_directories(bench.out("o"));
        fs::create_hard_link(bench.folder() / "victim.txt", mark);
        refused(".puckloop", "hard link");
        CHECK(text_of(bench.folder() / "victim.txt") == "mine\n");
        fs::remove(mark);
        REQUIRE(bench.run("o", {kHello, "--duration", "0.1"}).status == 0);
        fs::create_hard_link(bench.folder() / "victim.txt", bench.out("o") / "events.toml");
        refused("events.toml", "hard link");
        CHECK(text_of(bench.folder() / "victim.txt") == "mine\n");
    }
    SECTION("a link in the place of a program's folder") {
        fs::create_directories(bench.folder() / "elsewhere");
        fs::create_directories(bench.out("o"));
        fs::create_directory_symlink(bench.folder() / "elsewhere", bench.out("o") / "work");
        std::string scenario = text_of(kHello) + "\nfolder = \"work\"\n";
        const std::string place = "../firmware";
        scenario.replace(scenario.find(place), place.size(), PUCKLOOP_SOURCE "/firmware");
        bench.file("s.toml", scenario);
        check_one_line(bench.run("o", {(bench.folder() / "s.toml").string(), "--duration", "0.1"}), 2,
                       {"work", "is a link"});
    }
}

TEST_CASE("a lock that cannot be made is one line and leaves the results") {
    const Workbench bench;
    REQUIRE(bench.run("o", {kHello, "--duration", "0.1"}).status == 0);
    const std::string before = text_of(bench.out("o") / "report.json");
    fs::remove(bench.out("o") / ".puckloop");
    fs::create_directories(bench.out("o") / ".puckloop");
    check_one_line(bench.run("o", {kHello, "--duration", "0.1"}), 2, {".puckloop", "cannot be opened"});
    CHECK(text_of(bench.out("o") / "report.json") == before);
}

TEST_CASE("a folder that is not a run's keeps its files, and no link in it is followed") {
    const Workbench bench;
    bench.file("victim.txt", "mine\n");
    fs::create_directories(bench.out("o"));
    SECTION("a file under a name of the results") {
        for (const char* name : {"trace.csv", "report.json", "events.toml"}) {
            const fs::path file = bench.out("o") / name;
            bench.file(std::string("o/") + name, "mine\n");
            check_one_line(bench.run("o", {kHello, "--duration", "0.1"}), 2, {name, "no mark of puckloop"});
            CHECK(text_of(file) == "mine\n");
            CHECK_FALSE(fs::exists(bench.out("o") / ".puckloop"));
            fs::remove(file);
        }
    }
    SECTION("a link, with our mark or without") {
        for (const bool marked : {false, true}) {
            if (marked) REQUIRE(bench.run("o", {kHello, "--duration", "0.1"}).status == 0);
            for (const char* name : {"trace.csv", "robot0.pic.log", "report.json.part"}) {
                fs::remove(bench.out("o") / name);
                fs::create_symlink(bench.folder() / "victim.txt", bench.out("o") / name);
                check_one_line(bench.run("o", {kHello, "--duration", "0.1"}), 2, {name, "is a link"});
                CHECK(text_of(bench.folder() / "victim.txt") == "mine\n");
                fs::remove(bench.out("o") / name);
            }
        }
    }
    SECTION("a named pipe, which nobody reads, with our mark or without") {
        for (const bool marked : {false, true}) {
            if (marked) REQUIRE(bench.run("o", {kHello, "--duration", "0.1"}).status == 0);
            for (const char* name : {"trajectory.csv", "robot0.pic.log", "report.json"}) {
                fs::remove(bench.out("o") / name);
                REQUIRE(::mkfifo((bench.out("o") / name).c_str(), 0600) == 0);
                check_one_line(bench.run("o", {kHello, "--duration", "0.1"}), 2, {name, "is a pipe"});
                fs::remove(bench.out("o") / name);
            }
        }
    }
    SECTION("other files are in nobody's way") {
        bench.file("o/notes.txt", "mine\n");
        CHECK(bench.run("o", {kHello, "--duration", "0.1"}).status == 0);
        CHECK(text_of(bench.out("o") / "notes.txt") == "mine\n");
    }
}
