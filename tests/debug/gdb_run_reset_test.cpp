// `monitor reset` at a board of a run: the reset is where the chip stands, to the cycle. A run whose scenario
// presses the button at that instant leaves the same trace.

#include "emu/avr/assembler/assembler.h"
#include "emu/avr/devices/device.h"
#include "emu/image/intel_hex.h"
#include "tests/crashes/crash_image.h"
#include "tests/debug/counting_program.h"
#include "tests/debug/gdb_client.h"
#include "tests/end_to_end/kit/same_run.h"
#include "tests/end_to_end/kit/workbench.h"
#include "tests/exec/command.h"

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include <random>

using namespace puckloop;
using namespace puckloop::tests;
using Catch::Matchers::Contains;
using Catch::Matchers::StartsWith;

namespace {

/// "1234 cycles, 567 instructions"
std::uint64_t cycles(GdbClient& gdb) {
    return std::stoull(gdb.monitor("cycles"));
}

/// A turn takes 205 cycles for each of `turns`.
std::string dspic_source(unsigned turns) {
    return counting_program(fmt::format(R"(
        mov     #{}, w5
wait:   repeat  #200
        nop
        dec     w5, w5
        bra     nz, wait
        bra     loop
)",
                                        turns));
}

/// Switches a line to the radio module, busy all the time or asleep between two interrupts.
std::string avr_source(bool sleeps, unsigned turns) {
    return fmt::format(R"(
        jmp     main
        .org    0x48
        jmp     overflow
        .org    0x100
main:   ldi     r16, 4
        out     DDRC, r16
        ldi     r17, {}
        cpi     r17, 0
        breq    busy
        out     TCCR0B, r17
        ldi     r17, 1
        sts     TIMSK0, r17
        out     SMCR, r17
        sei
rest:   sleep
        rjmp    rest
busy:   ldi     r18, {}
turn:   dec     r18
        brne    turn
        out     PINC, r16
        rjmp    busy
overflow:
        out     PINC, r16
        reti
)",
                       sleeps ? 2 : 0, turns);
}

const std::string kArena = "[run]\nduration = \"0.2 s\"\n[arena]\nsize = [\"1 m\", \"1 m\"]\n[coordinator]\n";

std::string robot(const std::string& image, const std::string& more = {}) {
    return fmt::format("[[robot]]\nname = \"robot0\"\nposition = [\"20 cm\", \"0 m\"]\n[robot.pic]\nfirmware "
                       "= \"{}\"\n{}\n",
                       image, more);
}
std::string tam(const std::string& image, const std::string& more = {}) {
    return fmt::format("[[tam]]\nname = \"tam0\"\nposition = [\"0 m\", \"0 m\"]\nfirmware = \"{}\"\n{}\n",
                       image, more);
}
std::string at(std::uint64_t picoseconds) {
    return fmt::format("reset = [\"0.{:012} s\"]\n", picoseconds);
}

std::unique_ptr<GdbServer> debugged(const Workbench& bench, const std::string& scenario,
                                    const std::string& node, const std::string& more) {
    return std::make_unique<GdbServer>(bench.folder(),
                                       fmt::format("run {} --out {} --no-cache {} --gdb {}=unix:{{}}",
                                                   scenario, bench.out("debugged").string(), more, node),
                                       GdbServer::Whole{});
}

/// The traces of both runs, which have something to show.
void check_same_trace(const Workbench& bench, const std::string& a, const std::string& b,
                      const std::string& node) {
    const std::string one = text_of(bench.out(a) / "trace.csv"), other = text_of(bench.out(b) / "trace.csv");
    CHECK_THAT(one, Contains("," + node + ","));
    const bool same = one == other;
    CHECK(same);
    CHECK(bench.report(a)["trace_sha256"] == bench.report(b)["trace_sha256"]);
}

void run_plain(const Workbench& bench, const std::string& name, const std::string& text) {
    const Ended ended = bench.run(name, {bench.file(name + ".toml", text), "--no-cache"});
    INFO(ended.err);
    REQUIRE(ended.status == 0);
}

}  // namespace

TEST_CASE("a main board of a run is reset before the instruction at which it stands", "[reset]") {
    std::mt19937 random(Catch::rngSeed() + 21);
    const Workbench bench;
    const dspic::Program program = exec::assembled(dspic_source(draw(random, 5, 40)));
    const std::string image = bench.file("count.hex", image::write_dspic_hex(program.words));
    const std::string scenario = bench.file("debugged.toml", kArena + robot(image));
    constexpr double kHertz = 7372800.0 * 8 / 4;
    constexpr unsigned kPc = 16;
    for (const char* placement : {"", "--in-process --threads 2"}) {
        const auto server = debugged(bench, scenario, "robot0.pic", placement);
        GdbClient gdb(server->socket());
        CHECK(gdb.ask("Z2,800a00,2") == "OK");
        for (unsigned i = draw(random, 5, 60); i > 0; --i)
            CHECK(gdb.ask("c") == "T05watch:800a00;");
        for (unsigned i = draw(random, 0, 9); i > 0; --i)
            CHECK_THAT(gdb.ask("s"), StartsWith("T05"));
        CHECK(gdb.ask("z2,800a00,2") == "OK");
        const std::uint64_t stood = cycles(gdb);
        CHECK(gdb.register_value(kPc) != 0);
        CHECK(gdb.monitor("reset") == "reset\n");
        // At once, and nothing was executed.
        CHECK(gdb.register_value(kPc) == 0);
        CHECK(cycles(gdb) == stood);
        CHECK_THAT(gdb.monitor("sfr RCON"), Contains("EXTR=1"));
        CHECK_THAT(gdb.monitor("sfr TRISA"), Contains("= 0xf6c0"));
        CHECK_THAT(gdb.ask("s"), StartsWith("T05"));
        CHECK(gdb.register_value(kPc) == program.symbol("main"));
        CHECK(cycles(gdb) == stood + 2);  // the GOTO
        CHECK(gdb.ask("D") == "OK");
        INFO(server->err());
        CHECK(server->wait() == 0);
        // After the instruction before has begun, and not behind that one.
        const auto instant = static_cast<std::uint64_t>(static_cast<double>(stood) / kHertz * 1e12) - 1000;
        run_plain(bench, "pressed", kArena + robot(image, at(instant)));
        check_same_trace(bench, "pressed", "debugged", "robot0.pic");
        const auto node = bench.report("debugged")["nodes"]["robot0.pic"];
        CHECK(node.at("resets") == bench.report("pressed")["nodes"]["robot0.pic"]["resets"]);
        CHECK(node.at("resets").size() == 2);
    }
}

TEST_CASE("a TAM of a run is reset where it stands, awake or asleep", "[reset]") {
    std::mt19937 random(Catch::rngSeed() + 22);
    const Workbench bench;
    constexpr std::uint64_t kPicoseconds = 62'500;
    constexpr unsigned kPc = 34;
    const bool sleeps = GENERATE(false, true);
    CAPTURE(sleeps);
    const avr::Program program =
        avr::assemble(avr_source(sleeps, draw(random, 50, 250)), {"source", &avr::atmega1284p()});
    const std::string image =
        bench.file("line.elf", avr_elf(program.bytes, {{"main", program.symbol("main")}}));
    const std::string scenario = bench.file("debugged.toml", kArena + tam(image));
    for (const char* placement : {"", "--in-process --threads 2"}) {
        const auto server = debugged(bench, scenario, "tam0.avr", placement);
        GdbClient gdb(server->socket());
        const std::string stop = fmt::format("Z0,{:x},2", program.symbol(sleeps ? "overflow" : "busy"));
        CHECK(gdb.ask(stop) == "OK");
        for (unsigned i = draw(random, 5, 60); i > 0; --i)
            CHECK_THAT(gdb.ask("c"), StartsWith("T05"));
        CHECK(gdb.ask("z" + stop.substr(1)) == "OK");
        if (sleeps)  // the instruction behind SLEEP is next when an interrupt has woken it: SLEEP again
            for (int i = 0; i < 4; ++i)
                CHECK_THAT(gdb.ask("s"), StartsWith("T05"));
        else
            for (unsigned i = draw(random, 0, 9); i > 0; --i)
                CHECK_THAT(gdb.ask("s"), StartsWith("T05"));
        const std::uint64_t stood = cycles(gdb);
        CHECK(gdb.monitor("reset") == "reset\n");
        CHECK(gdb.register_value(kPc) == 0);
        CHECK(cycles(gdb) == stood);
        CHECK_THAT(gdb.monitor("sfr DDRC"), Contains("= 0x00"));
        CHECK(gdb.ask("D") == "OK");
        INFO(server->err());
        CHECK(server->wait() == 0);
        run_plain(bench, "pressed", kArena + tam(image, at(stood * kPicoseconds)));
        check_same_trace(bench, "pressed", "debugged", "tam0.avr");
    }
}

TEST_CASE("a TAM that sleeps is reset at the instant where the debugger stopped the run", "[reset]") {
    std::mt19937 random(Catch::rngSeed() + 23);
    const Workbench bench;
    constexpr std::uint64_t kPicoseconds = 62'500;
    const avr::Program program = avr::assemble(avr_source(true, 1), {"source", &avr::atmega1284p()});
    const std::string image =
        bench.file("line.elf", avr_elf(program.bytes, {{"main", program.symbol("main")}}));
    const std::string scenario = bench.file("debugged.toml", kArena + tam(image));
    const auto server = debugged(bench, scenario, "tam0.avr", "--duration 30");
    GdbClient gdb(server->socket());
    gdb.send("c");
    gdb.send_raw("\x03");
    CHECK_THAT(*gdb.receive(), StartsWith("T02"));
    const std::uint64_t stood = cycles(gdb);
    CHECK(gdb.monitor("reset") == "reset\n");
    CHECK(cycles(gdb) == stood);
    CHECK(gdb.ask("D") == "OK");
    INFO(server->err());
    CHECK(server->wait() == 0);
    const auto resets = bench.report("debugged")["nodes"]["tam0.avr"]["resets"];
    REQUIRE(resets.size() == 2);
    if (stood > 0) {
        const Ended ended =
            bench.run("pressed", {bench.file("pressed.toml", kArena + tam(image, at(stood * kPicoseconds))),
                                  "--no-cache", "--duration", "30"});
        INFO(ended.err);
        REQUIRE(ended.status == 0);
        check_same_trace(bench, "pressed", "debugged", "tam0.avr");
    }
}

TEST_CASE("a reset inside an instruction comes again whenever the run goes back over it",
          "[reset][reverse]") {
    std::mt19937 random(Catch::rngSeed() + 24);
    const Workbench bench;
    const dspic::Program program = exec::assembled(dspic_source(draw(random, 5, 40)));
    const std::string image = bench.file("count.hex", image::write_dspic_hex(program.words));
    const std::string scenario = bench.file("debugged.toml", kArena + robot(image));
    const auto server = debugged(bench, scenario, "robot0.pic", "--in-process");
    GdbClient gdb(server->socket());
    const auto sight = [&gdb] { return gdb.ask("g") + gdb.monitor("cycles") + gdb.monitor("sfr LATA"); };
    CHECK(gdb.ask("Z2,800a00,2") == "OK");
    for (unsigned i = draw(random, 5, 60); i > 0; --i)
        CHECK(gdb.ask("c") == "T05watch:800a00;");
    CHECK(gdb.ask("z2,800a00,2") == "OK");
    std::vector<std::string> seen{sight()};
    CHECK_THAT(gdb.ask("s"), StartsWith("T05"));
    seen.push_back(sight());
    const std::uint64_t stood = cycles(gdb);
    CHECK(gdb.monitor("reset") == "reset\n");
    CHECK(gdb.ask("P3=3412") == "OK");  // what is changed behind it is changed behind it again
    const unsigned steps = draw(random, 3, 9);
    for (unsigned i = 0; i < steps; ++i) {
        seen.push_back(sight());
        CHECK_THAT(gdb.ask("s"), StartsWith("T05"));
    }
    // Before the reset and behind it are two places, though no time lies between.
    for (unsigned i = 0; i <= steps + 1; ++i) {
        CHECK_THAT(gdb.ask("bs"), StartsWith("T05"));
        CHECK(sight() == seen[steps + 1 - i]);
    }
    for (unsigned i = 1; i <= steps + 1; ++i) {
        CHECK_THAT(gdb.ask("s"), StartsWith("T05"));
        CHECK(sight() == seen[i]);
    }
    CHECK(gdb.ask("bc") == "T05replaylog:begin;");
    CHECK(gdb.ask("D") == "OK");
    INFO(server->err());
    CHECK(server->wait() == 0);
    constexpr double kHertz = 7372800.0 * 8 / 4;
    const auto instant = static_cast<std::uint64_t>(static_cast<double>(stood) / kHertz * 1e12) - 1000;
    run_plain(bench, "pressed", kArena + robot(image, at(instant)));
    check_same_trace(bench, "pressed", "debugged", "robot0.pic");
}

TEST_CASE("boards in the midst of a transfer are reset, and two such runs are one", "[reset]") {
    std::mt19937 random(Catch::rngSeed() + 25);
    const Workbench bench;
    const std::string scenario = PUCKLOOP_SOURCE "/scenarios/rab_pair.toml";
    for (const std::string node : {"leader.rab", "leader.pic"}) {
        CAPTURE(node);
        const unsigned writes = draw(random, 10, 40), steps = draw(random, 0, 50);
        std::string stood, trace;
        for (int i = 0; i < 2; ++i) {
            const auto server = debugged(bench, scenario, node, "--duration 1.3");
            GdbClient gdb(server->socket());
            // I2C1TRN, U2TXREG: a byte is on its way.
            const std::string watch = node == "leader.rab" ? "Z2,800202,2" : "Z2,80021a,2";
            CHECK(gdb.ask(watch) == "OK");
            for (unsigned w = 0; w < writes; ++w)
                CHECK_THAT(gdb.ask("c"), StartsWith("T05watch"));
            for (unsigned s = 0; s < steps; ++s)
                CHECK_THAT(gdb.ask("s"), StartsWith("T05"));
            CHECK(gdb.monitor("reset") == "reset\n");
            const std::string now = gdb.monitor("cycles");
            if (i > 0) CHECK(now == stood);
            stood = now;
            CHECK(gdb.ask("D") == "OK");
            INFO(server->err());
            CHECK(server->wait() == 0);
            const auto report = bench.report("debugged");
            CHECK(report["nodes"][node]["resets"].size() == 2);
            if (i > 0) CHECK(report["trace_sha256"] == trace);
            trace = report["trace_sha256"];
        }
    }
}
