// A board of a run goes back by its debugger, and the whole run with it: the same registers at the same
// instants, and in the end the same files as of a run that nobody disturbed.

#include "tests/debug/counting_program.h"
#include "tests/debug/gdb_client.h"
#include "tests/end_to_end/kit/same_run.h"
#include "tests/end_to_end/kit/workbench.h"
#include "tests/exec/command.h"

#include "emu/image/intel_hex.h"

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include <filesystem>
#include <random>

using namespace puckloop;
using namespace puckloop::tests;
using Catch::Matchers::Contains;
using Catch::Matchers::StartsWith;

namespace {

constexpr unsigned kPc = 16;

/// Counts at 0x0A00 and switches an LED every `turns` x 1.1 ms; a function doubles the count.
std::string program_source(unsigned turns) {
    return counting_program(fmt::format(R"(
        rcall   twice
        mov     #{}, w5
wait:   mov     #5460, w6
inner:  dec     w6, w6
        bra     nz, inner
        dec     w5, w5
        bra     nz, wait
        bra     loop
twice:  add     w2, w2, w3
        inc     w4, w4
        return
)",
                                        turns));
}

/// Two robots: one with that program, one with a Linux program that drives it about.
struct TwoRobots {
    Workbench bench;
    std::string scenario;

    explicit TwoRobots(unsigned turns, const std::string& more = {}) {
        const std::string image =
            bench.file("count.hex", image::write_dspic_hex(exec::assembled(program_source(turns)).words));
        scenario = bench.hello(fmt::format(R"(
[[robot]]
name = "counter"
position = ["30 cm", "-25 cm"]
[robot.pic]
firmware = "{}"
{})",
                                           image, more));
    }
    /// With a debugger at the counter; the results are in out(`name`).
    std::unique_ptr<GdbServer> debugged(const std::string& name, const std::string& options) const {
        return std::make_unique<GdbServer>(
            bench.folder(),
            fmt::format("run {} --out {} --no-cache {} --gdb counter.pic=unix:{{}}", scenario,
                        bench.out(name).string(), options),
            GdbServer::Whole{});
    }
    void undisturbed(const std::string& options) const {
        Words words{scenario, "--no-cache"};
        std::istringstream more(options);
        for (std::string word; more >> word;)
            words.push_back(word);
        const Ended ended = bench.run("plain", words);
        INFO(ended.err);
        REQUIRE(ended.status == 0);
    }
};

std::string little(unsigned value) {
    return fmt::format("{:02x}{:02x}", value & 0xFF, value >> 8 & 0xFF);
}

/// All that the debugger can see of where the board stands.
std::string sight(GdbClient& gdb) {
    return gdb.ask("g") + " " + gdb.monitor("cycles") + gdb.ask("m800a00,2") + " " + gdb.monitor("sfr LATA");
}

}  // namespace

TEST_CASE("a run goes back step by step, and forward again to the same end", "[reverse]") {
    std::mt19937 random(Catch::rngSeed() + 11);
    const TwoRobots robots(draw(random, 3, 9));
    const std::string options = "--duration 1.5";
    robots.undisturbed(options);
    for (const char* placement : {" --in-process", " --in-process --threads 3", ""}) {
        INFO(placement);
        const auto server = robots.debugged("back", options + placement);
        GdbClient gdb(server->socket());
        CHECK_THAT(gdb.ask("qSupported"), Contains("ReverseStep+;ReverseContinue+"));
        CHECK(gdb.ask("Z2,800a00,2") == "OK");
        // The Linux program runs from 1 s on: it goes back, too.
        unsigned turns = 0;
        for (const double until = 1.05 + 0.01 * draw(random, 0, 20); std::stod(gdb.monitor("time")) < until;
             ++turns)
            REQUIRE(gdb.ask("c") == "T05watch:800a00;");
        CHECK(gdb.ask("z2,800a00,2") == "OK");

        // Steps, and the same back.
        const unsigned steps = draw(random, 4, 9), back = draw(random, 2, 4);
        std::vector<std::string> seen{sight(gdb)};
        for (unsigned i = 0; i < steps; ++i) {
            CHECK_THAT(gdb.ask("s"), StartsWith("T05"));
            seen.push_back(sight(gdb));
        }
        CHECK(gdb.ask("P1=0000") == "OK");  // the present may be changed; w1 is nobody's
        unsigned at = steps;
        for (unsigned i = 0; i < back; ++i) {
            CHECK_THAT(gdb.ask("bs"), StartsWith("T05"));
            CHECK(sight(gdb) == seen[--at]);
            CHECK(gdb.ask("P1=0100") == "E02");  // the past may not
        }
        for (; at < steps; ++at) {
            CHECK_THAT(gdb.ask("s"), StartsWith("T05"));
            CHECK(sight(gdb) == seen[at + 1]);
        }

        // By a watchpoint, further than a snapshot or two, and as often forward.
        CHECK(gdb.ask("Z2,800a00,2") == "OK");
        const unsigned times = draw(random, 2, 3);
        for (unsigned i = 0; i < times; ++i) {
            CHECK(gdb.ask("bc") == "T05watch:800a00;");
            CHECK(gdb.ask("m800a00,2") == little(turns - 1 - i));  // before the write
        }
        for (unsigned i = times; i > 0; --i) {
            CHECK(gdb.ask("c") == "T05watch:800a00;");
            CHECK(gdb.ask("m800a00,2") == little(turns + 1 - i));
        }
        CHECK(sight(gdb) == seen.front());
        CHECK(gdb.ask("z2,800a00,2") == "OK");

        // To the very beginning, and once more to where something was.
        CHECK(gdb.ask("bc") == "T05replaylog:begin;");
        CHECK(gdb.register_value(kPc) == 0);
        CHECK(gdb.ask("bs") == "T05replaylog:begin;");
        CHECK(gdb.ask("Z2,800a00,2") == "OK");
        for (unsigned i = 0; i < turns; ++i)
            CHECK(gdb.ask("c") == "T05watch:800a00;");
        CHECK(sight(gdb) == seen.front());
        CHECK(gdb.ask("D") == "OK");
        INFO(server->err());
        CHECK(server->wait() == 0);
        check_same_run(robots.bench, "plain", "back");
    }
}

TEST_CASE("a run that goes back takes its record along, and every file is that of an undisturbed run",
          "[reverse]") {
    std::mt19937 random(Catch::rngSeed() + 16);
    const TwoRobots robots(draw(random, 3, 9));
    const std::string options =
        "--duration 1.3 --in-process --record --trace-format vcd --trace-format pcapng --trace-format sr";
    robots.undisturbed(options);
    const auto server = robots.debugged("back", options);
    GdbClient gdb(server->socket());
    CHECK(gdb.ask("Z2,800a00,2") == "OK");
    const auto forward_to = [&gdb](double until) {
        while (std::stod(gdb.monitor("time")) < until)
            REQUIRE(gdb.ask("c") == "T05watch:800a00;");
    };
    // Near a snapshot and far behind it, twice over the same stretch, and once to the very beginning.
    forward_to(1.0 + 0.01 * draw(random, 1, 9));
    for (unsigned i = draw(random, 1, 4); i > 0; --i)
        CHECK(gdb.ask("bc") == "T05watch:800a00;");
    forward_to(1.1 + 0.01 * draw(random, 1, 9));
    for (unsigned i = draw(random, 10, 25); i > 0; --i)
        CHECK(gdb.ask("bc") == "T05watch:800a00;");
    forward_to(0.01 * draw(random, 105, 115));
    if (random() % 2) {
        CHECK(gdb.ask("z2,800a00,2") == "OK");
        CHECK(gdb.ask("bc") == "T05replaylog:begin;");
    }
    CHECK(gdb.ask("D") == "OK");
    INFO(server->err());
    CHECK(server->wait() == 0);
    check_same_run(robots.bench, "plain", "back");
    unsigned compared = 0;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(robots.bench.out("plain"))) {
        const std::string name = std::filesystem::relative(entry.path(), robots.bench.out("plain"));
        if (!entry.is_regular_file() || name == "report.json" || name == ".puckloop") continue;
        INFO(name);
        const bool same = text_of(entry.path()) == text_of(robots.bench.out("back") / name);
        CHECK(same);
        ++compared;
    }
    CHECK(compared >= 8);
    CHECK(std::filesystem::file_size(robots.bench.out("back") / "record.csv") > 10'000);
    // What was recorded can be replayed.
    const Ended replayed =
        robots.bench.puckloop({"replay", robots.scenario, robots.bench.out("back"), "--node", "counter.pic"});
    INFO(replayed.err);
    CHECK(replayed.status == 0);
}

TEST_CASE("what a debugger changes is changed again when the run comes by", "[reverse]") {
    std::mt19937 random(Catch::rngSeed() + 12);
    const TwoRobots robots(draw(random, 3, 9));
    const std::string options = "--duration 1.2 --in-process";
    const unsigned before = draw(random, 8, 30), after = draw(random, 4, 10);
    const auto session = [&](const std::string& name, bool back) {
        const auto server = robots.debugged(name, options);
        GdbClient gdb(server->socket());
        CHECK(gdb.ask("Z2,800a00,2") == "OK");
        for (unsigned i = 0; i < before; ++i)
            CHECK(gdb.ask("c") == "T05watch:800a00;");
        CHECK(gdb.ask("P2=0010") == "OK");  // the count goes on from 4096
        // The LED is not switched this time.
        CHECK(gdb.ask(fmt::format("P10={}0000",
                                  little(static_cast<unsigned>(gdb.register_value(kPc)) + 2))) == "OK");
        for (unsigned i = 0; i < after; ++i)
            CHECK(gdb.ask("c") == "T05watch:800a00;");
        const std::string last = sight(gdb);
        CHECK(gdb.ask("m800a00,2") == little(0x1000 + after));
        if (back) {
            for (unsigned i = 0; i < after + 1; ++i)
                CHECK(gdb.ask("bc") == "T05watch:800a00;");
            CHECK(gdb.ask("m800a00,2") == little(before - 1));
            for (unsigned i = 0; i < after + 1; ++i)
                CHECK(gdb.ask("c") == "T05watch:800a00;");
            CHECK(sight(gdb) == last);
        }
        CHECK(gdb.ask("D") == "OK");
        INFO(server->err());
        CHECK(server->wait() == 0);
    };
    session("changed", false);
    session("back", true);
    check_same_run(robots.bench, "changed", "back");
    robots.undisturbed(options);
    CHECK(robots.bench.report("plain")["trace_sha256"] != robots.bench.report("back")["trace_sha256"]);
}

TEST_CASE("a reset by the debugger comes again at the instant where it came", "[reverse]") {
    std::mt19937 random(Catch::rngSeed() + 14);
    const TwoRobots robots(draw(random, 3, 9));
    const auto server = robots.debugged("reset", "--duration 1.2 --in-process");
    GdbClient gdb(server->socket());
    CHECK(gdb.ask("Z2,800a00,2") == "OK");
    const unsigned before = draw(random, 5, 40);
    for (unsigned i = 0; i < before; ++i)
        CHECK(gdb.ask("c") == "T05watch:800a00;");
    const std::string last = sight(gdb);
    CHECK(gdb.monitor("reset") == "reset\n");
    CHECK(gdb.ask("c") == "T05watch:800a00;");
    const std::string anew = sight(gdb);
    CHECK(gdb.ask("m800a00,2") == "0100");  // it has begun anew
    CHECK(gdb.ask("bc") == "T05watch:800a00;");
    CHECK(gdb.ask("bc") == "T05watch:800a00;");
    CHECK(gdb.ask("m800a00,2") == little(before - 1));
    CHECK(gdb.monitor("reset") == "the past cannot be changed: continue to the present first\n");
    CHECK(gdb.ask("c") == "T05watch:800a00;");
    CHECK(sight(gdb) == last);
    CHECK(gdb.ask("c") == "T05watch:800a00;");
    CHECK(sight(gdb) == anew);
    CHECK(gdb.ask("D") == "OK");
    INFO(server->err());
    CHECK(server->wait() == 0);
}

TEST_CASE("a run from a snapshot goes back to it, and is saved again as it would have been", "[reverse]") {
    std::mt19937 random(Catch::rngSeed() + 15);
    const TwoRobots robots(draw(random, 3, 9));
    const std::string first = robots.bench.folder() / "first.snap",
                      second = robots.bench.folder() / "second.snap";
    const std::string at = fmt::format("0.{}", draw(random, 2, 3));
    robots.undisturbed("--duration 0.8 --save " + first + " --save-at " + at);
    GdbServer server(robots.bench.folder(),
                     fmt::format("run --from {} --in-process --out {} --save {} --save-at 0.5 --gdb "
                                 "counter.pic=unix:{{}}",
                                 first, robots.bench.out("from").string(), second),
                     GdbServer::Whole{});
    GdbClient gdb(server.socket());
    const std::string begin = gdb.monitor("time");
    CHECK_THAT(begin, StartsWith(at));
    CHECK(gdb.ask("Z2,800a00,2") == "OK");
    while (std::stod(gdb.monitor("time")) < 0.6)
        REQUIRE(gdb.ask("c") == "T05watch:800a00;");
    CHECK(gdb.ask("z2,800a00,2") == "OK");
    CHECK(gdb.ask("bc") == "T05replaylog:begin;");
    CHECK(gdb.monitor("time") == begin);
    CHECK(gdb.ask("D") == "OK");
    INFO(server.err());
    CHECK(server.wait() == 0);
    check_same_run(robots.bench, "plain", "from");
    const Ended again = robots.bench.run("again", {"--from", second});
    INFO(again.err);
    CHECK(again.status == 0);
    check_same_run(robots.bench, "plain", "again");
}

TEST_CASE("two debuggers: each is answered while the other one's board stands", "[reverse]") {
    std::mt19937 random(Catch::rngSeed() + 13);
    const TwoRobots robots(draw(random, 3, 9));
    robots.undisturbed("--duration 0.8");
    const std::string second = robots.bench.folder() / "second.sock";
    const auto server = robots.debugged("both", "--duration 0.8 --gdb robot0.pic=unix:" + second);
    GdbClient counter(server->socket()), robot0(second);
    CHECK(robot0.register_value(kPc) == 0);
    CHECK(counter.register_value(kPc) == 0);
    CHECK(counter.ask("Z2,800a00,2") == "OK");
    counter.send("c");
    CHECK_THAT(robot0.monitor("time"), StartsWith("0.0"));  // nothing moves until both let it
    robot0.send("c");
    CHECK(*counter.receive() == "T05watch:800a00;");
    const unsigned turns = draw(random, 20, 40);
    for (unsigned i = 1; i < turns; ++i)
        CHECK(counter.ask("c") == "T05watch:800a00;");
    // The other one is stopped beside it: then the run has no way back.
    robot0.send_raw("\x03");
    CHECK_THAT(*robot0.receive(), StartsWith("T02"));
    CHECK(counter.ask("bc") == "E.robot0.pic is stopped at a debugger of its own: let it go on first");
    const std::string cycles = robot0.monitor("cycles");
    robot0.send("c");
    // Whichever packet is looked at first.
    std::string back = counter.ask("bc");
    for (int i = 0; i < 1000 && back.starts_with("E."); ++i)
        back = counter.ask("bc");
    CHECK(back == "T05watch:800a00;");
    CHECK(counter.ask("bc") == "T05watch:800a00;");
    CHECK(counter.ask("bc") == "T05watch:800a00;");
    robot0.send_raw("\x03");
    CHECK_THAT(*robot0.receive(), StartsWith("T02"));
    CHECK(robot0.monitor("cycles") != cycles);  // it went along
    CHECK(robot0.ask("M800900,2:0000") == "E02");
    CHECK(robot0.ask("D") == "OK");
    CHECK(counter.ask("c") == "T05watch:800a00;");
    CHECK(counter.ask("m800a00,2") == fmt::format("{:02x}00", turns - 2));
    CHECK(counter.ask("D") == "OK");
    INFO(server->err());
    CHECK(server->wait() == 0);
    check_same_run(robots.bench, "plain", "both");
}

TEST_CASE("a run with a line to the outside has no way back, and names the line", "[reverse]") {
    const TwoRobots robots(5, "uart1 = \"tcp:0\"\n");
    const auto server = robots.debugged("line", "--duration 5 --paced --in-process");
    GdbClient gdb(server->socket());
    CHECK(gdb.ask("Z2,800a00,2") == "OK");
    CHECK(gdb.ask("c") == "T05watch:800a00;");
    CHECK(gdb.ask("bs") == "E.counter.uart1 is a line to the outside, which cannot go back");
    CHECK(gdb.ask("m800a00,2") == "0100");  // it stands where it stood
    CHECK(gdb.ask("vKill;1") == "OK");
    CHECK(server->wait() == 1);
}
