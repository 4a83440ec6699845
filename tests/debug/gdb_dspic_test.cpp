// A debugger's packets at a dsPIC, through the built program: GDB does not know the chip, so the debugger is
// our own.

#include "debug/gdb/rsp_packet.h"
#include "emu/dspic/devices/device.h"
#include "tests/debug/gdb_client.h"
#include "tests/exec/command.h"

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include <filesystem>
#include <random>

using namespace puckloop;
using Catch::Matchers::Contains;
using Catch::Matchers::StartsWith;
using exec::Workbench;
using tests::GdbClient;
using tests::GdbServer;

namespace {

unsigned draw(std::mt19937& random, std::size_t below) {
    return static_cast<unsigned>(random() % below);
}

constexpr unsigned kW1 = 1, kW2 = 2, kW3 = 3, kW4 = 4, kPc = 16;

/// Writes `secret` to 0x0A00, then counts at 0x0A02, doubles by a function and toggles RD0.
std::string program_source(unsigned secret, const char* origin) {
    return fmt::format(R"(
        goto    main
        .org    {}
main:   mov     #0x0900, w15
        mov     #0x27f0, w0
        mov     w0, SPLIM
        clr     TRISD
        mov     #0x{:x}, w1
        mov     w1, 0x0A00
        clr     w2
        clr     w4
loop:   inc     w2, w2
        mov     w2, 0x0A02
        rcall   twice
        btg     LATD, #0
        bra     loop
twice:  add     w2, w2, w3
        repeat  #4
        inc     w4, w4
        return
)",
                       origin, secret);
}

struct Lamp {
    unsigned secret;
    dspic::Program program;
    std::string image;

    /// Programs begin behind the vectors.
    Lamp(const Workbench& bench, std::mt19937& random,
         const dspic::DeviceInfo& device = dspic::dspic30f6014a())
        : secret(draw(random, 0x10000)),
          program(exec::assembled(program_source(secret, device.family_33f ? "0x200" : "0x100"), device)),
          image(bench.image("lamp.hex", program)) {}
    std::uint32_t at(const char* label) const { return static_cast<std::uint32_t>(program.symbol(label)); }
};

std::string little(unsigned value) {
    return fmt::format("{:02x}{:02x}", value & 0xFF, value >> 8 & 0xFF);
}

}  // namespace

TEST_CASE("a debugger sees a dsPIC, stops it, and goes back") {
    const Workbench bench;
    std::mt19937 random(Catch::rngSeed() + 1);
    const Lamp lamp(bench, random);
    GdbServer server(bench.folder, "--mcu dspic30f6014a " + lamp.image);
    GdbClient gdb(server.socket());
    using std::filesystem::perms;
    CHECK((std::filesystem::status(server.socket()).permissions() & perms::all) ==
          (perms::owner_read | perms::owner_write));

    CHECK_THAT(gdb.ask("qSupported:swbreak+"), Contains("ReverseStep+") && Contains("qXfer:features:read+"));
    CHECK_THAT(gdb.ask("qXfer:features:read:target.xml:0,fff"),
               StartsWith("l<?xml") && Contains("<reg name=\"w15\" bitsize=\"16\" type=\"data_ptr\"/>") &&
                   Contains("name=\"acca\""));
    CHECK_THAT(gdb.ask("?"), StartsWith("T05"));
    CHECK(gdb.register_value(kPc) == 0);

    // Breakpoint, registers, data and program memory.
    CHECK(gdb.ask(fmt::format("Z0,{:x},2", lamp.at("loop"))) == "OK");
    CHECK_THAT(gdb.ask("c"), StartsWith("T05"));
    CHECK(gdb.register_value(kPc) == lamp.at("loop"));
    CHECK(gdb.register_value(kW1) == lamp.secret);
    CHECK(gdb.ask("m800a00,2") == little(lamp.secret));
    CHECK(gdb.ask("m800002,2") == little(lamp.secret));  // W1 in data space
    const std::uint32_t word = lamp.program.words.at(lamp.at("loop"));
    CHECK(gdb.ask(fmt::format("m{:x},4", 0x1000000 + 2 * lamp.at("loop"))) ==
          fmt::format("{:02x}{:02x}{:02x}00", word & 0xFF, word >> 8 & 0xFF, word >> 16));
    CHECK(gdb.ask(fmt::format("m{:x},2", lamp.at("loop"))) == little(word));
    CHECK(gdb.ask(fmt::format("z0,{:x},2", lamp.at("loop"))) == "OK");

    // Steps; the repeated instruction is one.
    const std::string cycles_at_loop = gdb.monitor("cycles");
    const std::uint32_t way[] = {lamp.at("loop") + 2, lamp.at("loop") + 4, lamp.at("twice"),
                                 lamp.at("twice") + 2, lamp.at("twice") + 4};
    for (const std::uint32_t pc : way) {
        CHECK_THAT(gdb.ask("s"), StartsWith("T05"));
        CHECK(gdb.register_value(kPc) == pc);
    }
    CHECK(gdb.register_value(kW3) == 2);
    CHECK(gdb.register_value(kW4) == 0);
    gdb.ask("s");
    CHECK(gdb.register_value(kW4) == 5);

    // Back the same way; the repeated instruction is one step again.
    CHECK_THAT(gdb.ask("bs"), StartsWith("T05"));
    CHECK(gdb.register_value(kW4) == 0);
    CHECK(gdb.register_value(kPc) == way[4]);
    CHECK(gdb.ask("P1=0000") == "E02");
    CHECK(gdb.ask("M800a00,2:0000") == "E02");
    for (const std::uint32_t pc : {way[3], way[2], way[1], way[0], lamp.at("loop")}) {
        gdb.ask("bs");
        CHECK(gdb.register_value(kPc) == pc);
    }
    CHECK(gdb.monitor("cycles") == cycles_at_loop);

    // Watchpoints, forward and back.
    const unsigned turns = 2 + draw(random, 5);
    CHECK(gdb.ask("Z2,800a02,2") == "OK");
    for (unsigned i = 0; i < turns; ++i)
        CHECK(gdb.ask("c") == "T05watch:800a02;");
    CHECK(gdb.register_value(kW2) == turns);
    CHECK(gdb.ask("m800a02,2") == little(turns));
    CHECK(gdb.ask("bc") == "T05watch:800a02;");  // before the last write
    CHECK(gdb.ask("m800a02,2") == little(turns - 1));
    CHECK(gdb.ask("z2,800a02,2") == "OK");
    CHECK(gdb.ask("Z3,800a02,2") == "OK");
    CHECK(gdb.ask("Z4,800a00,1") == "OK");
    CHECK(gdb.ask("bc") == "T05awatch:800a00;");  // nobody reads; the secret was written once
    CHECK(gdb.register_value(kPc) == lamp.at("loop") - 6);
    CHECK(gdb.ask("bc") == "T05replaylog:begin;");
    CHECK(gdb.register_value(kPc) == 0);
    CHECK(gdb.ask("z3,800a02,2") == "OK");
    CHECK(gdb.ask("z4,800a00,1") == "OK");

    // In the present the debugger may write, and going back shows what was before.
    CHECK(gdb.ask(fmt::format("Z1,{:x},2", lamp.at("twice"))) == "OK");
    for (unsigned i = 0; i < turns + 1; ++i)
        gdb.ask("c");
    CHECK(gdb.register_value(kW2) == turns + 1);
    CHECK(gdb.ask("P2=3412") == "OK");
    CHECK(gdb.ask("M800a00,2:ad0b") == "OK");
    gdb.ask("c");
    CHECK(gdb.register_value(kW2) == 0x1235);
    CHECK(gdb.ask("bc") == "T05");
    CHECK(gdb.ask("m800a00,2") == "ad0b");  // the same stop, and what was written there
    gdb.ask("bs");
    CHECK(gdb.ask("m800a00,2") == little(lamp.secret));
    gdb.ask("c");
    gdb.ask("c");
    CHECK(gdb.register_value(kW2) == 0x1235);

    // What monitor knows; a reset starts the program over.
    CHECK_THAT(gdb.monitor("sfr latd"), StartsWith("LATD (0x02d6) = 0x"));
    CHECK_THAT(gdb.monitor("sfr SR"), Contains(" RA=0"));
    CHECK_THAT(gdb.monitor("sfr NONE"), Contains("has no register NONE"));
    CHECK_THAT(gdb.monitor("frob"), Contains("no command 'frob'") && Contains("monitor help"));
    CHECK_THAT(gdb.monitor("stats"), Contains("reset: POR"));
    CHECK(gdb.monitor("reset") == "reset\n");
    gdb.ask("c");
    CHECK(gdb.register_value(kW2) == 1);
    CHECK_THAT(gdb.monitor("stats"), Contains("reset: EXTR"));

    // Ctrl-C while nothing else stops it, then the end.
    CHECK(gdb.ask(fmt::format("z1,{:x},2", lamp.at("twice"))) == "OK");
    gdb.send("c");
    gdb.send_raw("\x03");
    CHECK(*gdb.receive() == "T02");
    gdb.send("k");
    CHECK(server.wait() == 1);
}

TEST_CASE("random packets are answered, and damage nothing") {
    const Workbench bench;
    std::mt19937 random(Catch::rngSeed() + 2);
    const Lamp lamp(bench, random, dspic::dspic33fj256gp710());
    GdbServer server(bench.folder, "--mcu dspic33fj256gp710 " + lamp.image);
    GdbClient gdb(server.socket());
    const char* const starts[] = {"g",
                                  "G",
                                  "p",
                                  "P1=",
                                  "m",
                                  "M8008",
                                  "X8008",
                                  "Z0,",
                                  "Z2,8008",
                                  "z4",
                                  "qRcmd,",
                                  "qXfer:",
                                  "qXfer:features:read:target.xml:",
                                  "H",
                                  "?",
                                  "qSupported",
                                  "vCont?",
                                  "Z9",
                                  "!"};
    for (int i = 0; i < 1500; ++i) {
        std::string packet = starts[draw(random, std::size(starts))];
        for (unsigned more = draw(random, 12); more > 0; --more)
            packet += "0123456789abcdef,:;=-\xff$#}"[draw(random, 26)];
        gdb.ask(packet);
    }
    for (int i = 0; i < 50; ++i)  // damaged ones are refused
        gdb.send_raw("$m0,4#00");
    gdb.send_raw(std::string(200, '#'));
    gdb.ask("?");
    CHECK(gdb.ask("D") == "OK");
    // A new debugger may come; the program runs meanwhile.
    GdbClient again(server.socket());
    CHECK_THAT(again.ask("?"), StartsWith("T02"));
    again.send("k");
    CHECK(server.wait() == 1);
}

TEST_CASE("a run under a debugger is the run without one") {
    const Workbench bench;
    std::mt19937 random(Catch::rngSeed() + 3);
    const Lamp lamp(bench, random);
    const std::string what =
        "--mcu dspic30f6014a " + lamp.image + " --cycles 300000 --json --log " + bench.folder;
    CHECK(bench.run(what + "/plain").status == 0);
    const std::string plain = exec::text_of(bench.folder + "/plain/pins.csv");
    const std::string report = exec::text_of(bench.folder + "/stdout");
    REQUIRE(plain.size() > 10'000);
    GdbServer server(bench.folder, what + "/debugged");
    GdbClient gdb(server.socket());
    gdb.ask("Z2,800a02,1");
    for (int i = 0; i < 40; ++i) {
        const char* const ways[] = {"s", "s", "c", "c", "bs", "bc"};
        gdb.ask(ways[draw(random, std::size(ways))]);
    }
    gdb.ask("z2,800a02,1");
    CHECK(gdb.ask("c") == "W00");
    CHECK(server.wait() == 0);
    CHECK(exec::text_of(bench.folder + "/debugged/pins.csv") == plain);
    const auto numbers = [](const std::string& json) {
        const std::size_t from = json.find("\"cycles\""), to = json.find("\"wall_s\"");
        return json.substr(from, to - from);
    };
    CHECK(numbers(server.out()) == numbers(report));
}

TEST_CASE("a debugger that leaves without a word is reported, and another one finds the program running") {
    const Workbench bench;
    std::mt19937 random(Catch::rngSeed() + 5);
    const Lamp lamp(bench, random);
    GdbServer server(bench.folder, "--mcu dspic30f6014a " + lamp.image);
    const std::string line = fmt::format(
        "gdb: the debugger at {} has left; the program runs on, and another may connect\n", server.socket());
    {
        GdbClient gdb(server.socket());  // as GDB itself does, which does not know the chip
        CHECK_THAT(gdb.ask("qXfer:features:read:target.xml:0,1000"), Contains("<target"));
    }
    {
        GdbClient gdb(server.socket());
        CHECK(gdb.ask("?") == "T02");  // stopped for it: it was running
        CHECK_THAT(server.err(), Catch::EndsWith(line));
        CHECK(gdb.ask("D") == "OK");  // one that detaches is not
    }
    GdbClient gdb(server.socket());
    CHECK(gdb.ask("?") == "T02");
    gdb.send("k");
    CHECK(server.wait() == 1);
    const std::string err = server.err();
    CHECK(err.find(line) == err.rfind(line));
}

TEST_CASE("places where nobody can listen") {
    const Workbench bench;
    std::mt19937 random(4);
    const Lamp lamp(bench, random);
    for (const char* where : {"4242", ":", ":70000", ":12x", "unix:", "unix:/nowhere/at/all"}) {
        const auto run = bench.run(std::string("--mcu dspic30f6014a ") + lamp.image + " --gdb " + where);
        CHECK(run.status == 2);
        CHECK(exec::one_line(run.err));
        CHECK_THAT(run.err, Contains("--gdb"));
    }
}
