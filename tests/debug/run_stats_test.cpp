// `run --stats NODE`: what `exec --stats` reports of a board alone, of boards in a whole run; which is the
// run without it.

#include "base/random.h"
#include "emu/dspic/devices/device.h"
#include "tests/debug/drawn_reads.h"
#include "tests/end_to_end/kit/same_run.h"
#include "tests/end_to_end/kit/workbench.h"

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <tuple>

using namespace puckloop;
using namespace puckloop::tests;
using Catch::Contains;

namespace {

std::string robot(const std::string& name, int x_cm, const std::string& pic, const std::string& rab = {}) {
    return fmt::format("[[robot]]\nname = \"{}\"\nposition = [\"{} cm\", \"0 cm\"]\n[robot.pic]\nfirmware = "
                       "\"{}\"\n{}",
                       name, x_cm, pic, rab.empty() ? "" : "[robot.rab]\nfirmware = \"" + rab + "\"\n");
}

std::string tam(const std::string& name, int x_cm, const std::string& firmware) {
    return fmt::format("[[tam]]\nname = \"{}\"\nposition = [\"{} cm\", \"20 cm\"]\nfirmware = \"{}\"\n", name,
                       x_cm, firmware);
}

const std::string kArena =
    "[run]\nduration = \"0.3 s\"\nallow = [\"hung\"]\n[arena]\nsize = [\"1 m\", \"1 m\"]\n";

nlohmann::json exec_stats(const Workbench& bench, const std::string& board, const std::string& image) {
    const Ended ended =
        bench.puckloop({"exec", "--board", board, image, "--seconds", "0.3", "--stats", "--json"});
    INFO(ended.err);
    REQUIRE(ended.status == 0);
    return nlohmann::json::parse(ended.out).at("stats");
}

}  // namespace

TEST_CASE("boards of a run have the marks that their programs set, in every placement") {
    const Workbench bench;
    RandomStream random(Catch::rngSeed(), "stats of a run");
    const DrawnReads pic = draw_dspic_reads(random, dspic::dspic30f6014a());
    const DrawnReads rab = draw_dspic_reads(random, dspic::dspic33fj256gp710());
    const DrawnReads avr = draw_avr_reads(random);
    const std::string pic_elf = bench.file("pic.elf", pic.elf), rab_elf = bench.file("rab.elf", rab.elf),
                      avr_elf = bench.file("avr.elf", avr.elf);
    const std::string scenario =
        bench.file("drawn.toml", kArena + robot("one", -20, pic_elf, rab_elf) + robot("two", 20, pic_elf) +
                                     tam("tam0", 0, avr_elf) + "start = \"0.1 s\"\n");
    REQUIRE(bench.run("plain", {scenario, "--in-process", "--no-cache"}).status == 0);
    for (const Words& placement : {Words{}, Words{"--in-process"}, Words{"--in-process", "--threads", "3"}}) {
        Words words{scenario, "--no-cache", "--stats", "one.pic", "--stats", "rab", "--stats", "tam0.avr"};
        words.insert(words.end(), placement.begin(), placement.end());
        const Ended ended = bench.run("stats", words);
        INFO(ended.out << ended.err);
        REQUIRE(ended.status == 0);
        const auto nodes = bench.report("stats")["nodes"];
        pic.check(nodes.at("one.pic").at("stats"));
        rab.check(nodes.at("one.rab").at("stats"));
        avr.check(nodes.at("tam0.avr").at("stats"));
        CHECK_FALSE(nodes.at("two.pic").contains("stats"));
        check_same_run(bench, "plain", "stats");
        CHECK_THAT(ended.out, Contains("\none.pic: stack ") && Contains("\ntam0.avr: ") &&
                                  !Contains("\ntwo.pic: stack"));
        // As alone on the bench, stack included.
        for (const auto& [board, node, image] : {std::tuple{"pic", "one.pic", pic_elf},
                                                 {"rab", "one.rab", rab_elf},
                                                 {"tam", "tam0.avr", avr_elf}}) {
            const auto alone = exec_stats(bench, board, image), here = nodes.at(node).at("stats");
            CHECK(alone.contains("stack") == here.contains("stack"));
            if (alone.contains("stack")) CHECK(alone["stack"] == here["stack"]);
            CHECK(alone["unwritten"] == here["unwritten"]);
        }
    }
    REQUIRE(bench.run("all", {scenario, "--no-cache", "--stats", "all"}).status == 0);
    const auto nodes = bench.report("all")["nodes"];
    for (const char* board : {"one.pic", "two.pic", "one.rab", "tam0.avr"})
        CHECK(nodes.at(board).contains("stats"));
    check_same_run(bench, "plain", "all");
}

TEST_CASE("firmware at work: stack and reads of a whole run, with faults, cameras and Linux programs") {
    const Workbench bench;
    const std::string scenario = bench.hello();
    const Words words{"--duration", "2", "--no-cache", "--fault", "drop link=robot0.uart at=1.5s"};
    Words plain{scenario}, stats{scenario, "--stats", "all"};
    plain.insert(plain.end(), words.begin(), words.end());
    stats.insert(stats.end(), words.begin(), words.end());
    REQUIRE(bench.run("plain", plain).status == 0);
    const Ended ended = bench.run("stats", stats);
    INFO(ended.out << ended.err);
    REQUIRE(ended.status == 0);
    check_same_run(bench, "plain", "stats");
    const auto before = bench.report("plain")["nodes"]["robot0.pic"];
    auto after = bench.report("stats")["nodes"]["robot0.pic"];
    const auto found = after["stats"];
    after.erase("stats");
    CHECK(after == before);
    std::uint64_t cycles = 0;
    for (const auto& function : found.at("functions"))
        cycles += function.at("cycles").get<std::uint64_t>();
    CHECK(cycles == before.at("cycles"));
    CHECK(found.at("stack").at("bytes") > 10);
    CHECK(found.at("unwritten_reads") == 0);
}

TEST_CASE("a stack that meets variables is a warning of the run, and fails one that is strict") {
    const Workbench bench;
    // The program's calls write where the stack begins, at the end of RAM.
    RandomStream random(Catch::rngSeed(), "stack over variables in a run");
    const DrawnReads avr = draw_avr_reads(random, {{"last", {0x40F0, 0x10}}});
    const std::string scenario =
        bench.file("over.toml", kArena + tam("tam0", 0, bench.file("over.elf", avr.elf)));
    const Ended ended = bench.run("over", {scenario, "--stats", "tam", "--strict"});
    INFO(ended.out << ended.err);
    CHECK(ended.status == 1);
    CHECK_THAT(ended.err, Contains("tam0.avr: the stack has grown over ") && Contains(" (last)"));
    CHECK(bench.run("silent", {scenario, "--strict"}).status == 0);
}

TEST_CASE("run: --stats names what it cannot do") {
    const Workbench bench;
    const std::string scenario = bench.hello(), snapshot = bench.folder() / "one.snap";
    REQUIRE(
        bench.run("saved", {scenario, "--duration", "0.2", "--save", snapshot, "--save-at", "0.1"}).status ==
        0);
    const std::vector<std::pair<Words, std::string>> wrong{
        {{scenario, "--stats", "robot7.pic"}, "robot0.pic"},
        {{scenario, "--stats", "tam"}, "names no board"},
        {{scenario, "--stats", "all", "--gdb", "robot0.pic=:0"}, "debugger"},
        {{scenario, "--stats", "all", "--save-state", "s", "--at", "1"}, "--save-state"},
        {{"--from", snapshot, "--stats", "all"}, "snapshot"}};
    for (const auto& [words, named] : wrong) {
        const Ended ended = bench.run("wrong", words);
        INFO(ended.err);
        CHECK(ended.status == 2);
        CHECK_THAT(ended.err, Contains(named) && Contains("--stats"));
        CHECK(std::count(ended.err.begin(), ended.err.end(), '\n') == 1);
    }
}
