// How deep the stack went, what it left, what it ran into, and what was read before anything wrote it: of
// programs whose calls are drawn, and of the project's firmware, against what its instruction trace shows.

#include "base/json.h"
#include "base/random.h"
#include "emu/avr/assembler/assembler.h"
#include "emu/avr/devices/device.h"
#include "tests/crashes/crash_image.h"
#include "tests/debug/drawn_reads.h"
#include "tests/exec/command.h"

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <set>
#include <sstream>
#include <vector>

using namespace puckloop;
using exec::Workbench;

namespace {

/// A recursion of `depth` calls, each of which saves W5 `saved` times.
struct Recursion {
    std::uint32_t depth, saved;

    explicit Recursion(RandomStream& random)
        : depth(1 + static_cast<std::uint32_t>(random.below(40))),
          saved(1 + static_cast<std::uint32_t>(random.below(6))) {}
    std::string times(const std::string& line) const {
        std::string text;
        for (std::uint32_t i = 0; i < saved; ++i)
            text += line;
        return text;
    }
};

constexpr std::uint32_t kDspicLimit = 0x1400, kAvrTop = 0x40FF;

/// Then it reads `unread` words from 0x1800 on, of which it has written `written`.
std::string dspic_program(const Recursion& r, std::uint32_t stack, std::uint32_t unread,
                          std::uint32_t written) {
    std::string reads;
    for (std::uint32_t i = 0; i < written; ++i)
        reads += fmt::format("        mov     w5, {:#x}\n", 0x1800 + 2 * i);
    for (std::uint32_t i = 0; i < unread; ++i)
        reads += fmt::format("        mov     {:#x}, w1\n", 0x1800 + 2 * i);
    return fmt::format(R"(
        goto    main
        .org    0x100
main:   mov     #{:#x}, w15
        mov     #{:#x}, w0
        mov     w0, SPLIM
        mov     #{}, w5
        rcall   deeper
{}
stop:   bra     stop
deeper:
{}
        dec     w5, w5
        bra     z, bottom
        rcall   deeper
bottom:
{}
        return
)",
                       stack, kDspicLimit, r.depth, reads, r.times("        push w5\n"),
                       r.times("        pop w5\n"));
}

std::string avr_program(const Recursion& r) {
    return fmt::format(R"(
        jmp     main
        .org    0x100
main:   ldi     r16, 0xFF
        out     SPL, r16
        ldi     r16, 0x40
        out     SPH, r16
        ldi     r20, {}
        call    deeper
stop:   rjmp    stop
deeper:
{}
        dec     r20
        breq    bottom
        rcall   deeper
bottom:
{}
        ret
)",
                       r.depth, r.times("        push r20\n"), r.times("        pop r20\n"));
}

std::string avr_image(const Recursion& r, const tests::VariablesByName& variables) {
    const avr::Program program = avr::assemble(avr_program(r), {"source", &avr::atmega1284p()});
    return tests::avr_elf(program.bytes,
                          {{"main", program.symbols.at("main")}, {"deeper", program.symbols.at("deeper")}},
                          variables);
}

nlohmann::json stats_of(const Workbench& bench, const std::string& arguments, int status = 0) {
    const auto run = bench.run(arguments + " --stats --json");
    INFO(run.out << run.err);
    REQUIRE(run.status == status);
    return nlohmann::json::parse(run.out).at("stats");
}

}  // namespace

TEST_CASE("a dsPIC's deepest stack, its distance to SPLIM, and unwritten reads are what the program does") {
    const Workbench bench;
    RandomStream random(Catch::rngSeed(), "stacks");
    for (int i = 0; i < 5; ++i) {
        const Recursion r(random);
        const auto stack = 0x900 + 2 * static_cast<std::uint32_t>(random.below(0x100));
        const auto unread = static_cast<std::uint32_t>(random.below(8));
        const auto written = static_cast<std::uint32_t>(random.below(8));
        const auto program = exec::assembled(dspic_program(r, stack, unread, written));
        const auto stats =
            stats_of(bench, "--mcu dspic30f6014a " + bench.image("deep.hex", program) + " --seconds 0.001");
        const std::uint32_t bytes = r.depth * (4 + 2 * r.saved);
        INFO(stats.dump());
        CHECK(stats.at("stack").at("bytes") == bytes);
        CHECK(stats.at("stack").at("base") == stack);
        CHECK(stats.at("stack").at("left") == kDspicLimit - stack - bytes);
        CHECK(stats.at("stack").at("over_variables") == 0);
        CHECK(stats.at("unwritten_reads") == 2 * (unread > written ? unread - written : 0));
    }
}

TEST_CASE("a dsPIC's stack that begins below variables and grows over them is reported") {
    const Workbench bench;
    RandomStream random(Catch::rngSeed(), "stacks over variables");
    const Recursion r(random);
    const auto program = exec::assembled(dspic_program(r, 0x900, 0, 0));
    const std::uint32_t bytes = r.depth * (4 + 2 * r.saved);
    const auto meets = static_cast<std::uint32_t>(1 + random.below(bytes));  // of `last`
    const std::string image = bench.file(
        "over.elf", tests::dspic_elf(program.words, {{"deeper", program.symbol("deeper")}},
                                     {{"below", {0x8F0, 16}}, {"last", {0x900 + bytes - meets, 2 * meets}}}));
    const auto stats = stats_of(bench, "--mcu dspic30f6014a " + image + " --seconds 0.001 --strict", 1);
    INFO(stats.dump());
    CHECK(stats.at("stack").at("over_variables") == meets);
    CHECK(stats.at("stack").at("variables") == nlohmann::json{"last"});
}

TEST_CASE("an AVR's deepest stack and its distance to the variables are what the program does") {
    const Workbench bench;
    RandomStream random(Catch::rngSeed(), "AVR stacks");
    for (int i = 0; i < 5; ++i) {
        const Recursion r(random);
        const std::uint32_t bytes = r.depth * (2 + r.saved), lowest = kAvrTop + 1 - bytes;
        // The variable ends some bytes below or above the deepest stack.
        const auto over = static_cast<std::uint32_t>(random.below(bytes)), gap = over == 0 ? 5u : 0u;
        const std::uint32_t end = lowest + over - gap;
        const std::string image =
            bench.file("deep.elf", avr_image(r, {{"first", {0x100, 2}}, {"buffer", {end - 20, 20}}}));
        const std::string what = "--mcu atmega1284p " + image + " --seconds 0.002";
        const auto stats = stats_of(bench, what + " --strict", over > 0 ? 1 : 0);
        INFO(stats.dump());
        CHECK(stats.at("stack").at("bytes") == bytes);
        CHECK(stats.at("stack").at("left") == gap);
        CHECK(stats.at("stack").at("over_variables") == std::min(over, 20u));
        CHECK(stats.at("stack").at("variables").size() == (over > 0 ? 1 : 0));
        const std::string text = bench.run(what + " --stats").out;
        INFO(text);
        CHECK((text.find("warning: the stack has grown over") != std::string::npos) == (over > 0));
        CHECK((text.find("bytes of variables (buffer)") != std::string::npos) == (over > 0));
    }
}

TEST_CASE("reads of RAM that nothing had written are named, and no other, on every chip and board") {
    const Workbench bench;
    RandomStream random(Catch::rngSeed(), "unwritten reads");
    for (int i = 0; i < 8; ++i) {
        const tests::DrawnReads avr = tests::draw_avr_reads(random);
        const std::string image = bench.file("avr.elf", avr.elf);
        for (const char* where : {"--mcu atmega1284p ", "--board tam "})
            avr.check(stats_of(bench, where + image + " --seconds 0.002"));
        const auto of_dspic = [&](const dspic::DeviceInfo& device, const char* mcu, const char* board) {
            const tests::DrawnReads drawn = tests::draw_dspic_reads(random, device);
            const std::string elf = bench.file("dspic.elf", drawn.elf);
            for (const char* where : {mcu, board})
                drawn.check(stats_of(bench, where + elf + " --seconds 0.002"));
        };
        of_dspic(dspic::dspic30f6014a(), "--mcu dspic30f6014a ", "--board pic ");
        of_dspic(dspic::dspic33fj256gp710(), "--mcu dspic33fj256gp710 ", "--board rab ");
    }
    // For a person, too: place, variable and address.
    tests::DrawnReads drawn = tests::draw_avr_reads(random);
    while (drawn.reads.empty() || drawn.reads.front().variable.empty())
        drawn = tests::draw_avr_reads(random);
    const tests::DrawnReads::Read& first = drawn.reads.front();
    const std::string text =
        bench.run("--mcu atmega1284p " + bench.file("avr.elf", drawn.elf) + " --seconds 0.002 --stats").out;
    INFO(text);
    CHECK(text.find(fmt::format("  0x{:04x} ({}) at 0x{:06x} main", first.address, first.variable,
                                first.pc)) != std::string::npos);
}

TEST_CASE("the stack of the project's firmware is as deep as its instruction trace shows") {
    const Workbench bench;
    const struct {
        const char *board, *image, *options;
    } kFirmware[] = {{"pic", "epuck/epuck.elf", "--seconds 0.02"}, {"rab", "rab/rab.elf", "--seconds 0.02"}};
    for (const auto& firmware : kFirmware) {
        const std::string trace = bench.folder + "/trace.tsv";
        const auto stats =
            stats_of(bench, fmt::format("--board {} {}/firmware/{} {} --trace {}", firmware.board,
                                        PUCKLOOP_SOURCE, firmware.image, firmware.options, trace));
        INFO(firmware.image << "\n" << stats.dump().substr(0, 2000));
        // W15 after each instruction, from its first value on; calls and interrupts push and show it.
        std::ifstream lines(trace);
        std::uint32_t highest = 0;
        for (std::string line; std::getline(lines, line);) {
            const std::size_t at = line.find("w15=0x");
            if (at != std::string::npos)
                highest = std::max(
                    highest, static_cast<std::uint32_t>(std::stoul(line.substr(at + 6, 4), nullptr, 16)));
        }
        REQUIRE(highest > 0);
        CHECK(stats.at("stack").at("peak") == highest);
        CHECK(stats.at("stack").at("over_variables") == 0);
        CHECK(stats.at("unwritten_reads") == 0);
        REQUIRE(stats.at("stack").contains("left"));
        CHECK(stats.at("stack").at("left").get<int>() > 0);
    }
}
