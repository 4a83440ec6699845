// Firmware that goes wrong in a function at a place drawn at random: trap, reset or nothing as on silicon,
// and the report states what, with the program counter and the function.

#include "base/random.h"
#include "emu/avr/assembler/assembler.h"
#include "emu/avr/devices/device.h"
#include "emu/dspic/assembler/assembler.h"
#include "emu/dspic/devices/device.h"
#include "emu/image/image.h"
#include "emu/image/image_file.h"
#include "emu/image/line_table.h"
#include "tests/crashes/crash_image.h"
#include "tests/kit/scratch.h"
#include "tests/tools/shell.h"

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <sstream>
#include <vector>

using namespace puckloop;
using puckloop::tests::run_puckloop;

namespace {

/// `body` is a function named guilty at `place`; traps end in loops.
std::string dspic_image(const dspic::DeviceInfo& device, std::uint32_t place, const std::string& body) {
    dspic::AssembleOptions options;
    for (const dspic::RegisterInfo& info : device.registers)
        options.predefined[std::string(info.name)] = info.address;
    const dspic::Program program =
        dspic::assemble(fmt::format(R"(
        goto    start
        .org    0x04
        .pword  handler, handler, handler, handler, handler
        .org    0x200
start:  mov     #{:#x}, w15
        mov     #{:#x}, w0
        mov     w0, SPLIM
        nop
        mov     #0x1234, w1
        call    guilty
handler: bra    handler
        .org    {:#x}
guilty: nop
{}
)",
                                    device.ram_start + 0x100, device.ram_start + 0x400, place, body),
                        options);
    std::map<std::string, std::uint32_t> labels;
    for (const char* name : {"start", "handler", "guilty"})
        labels[name] = program.symbol(name);
    return tests::dspic_elf(program.words, labels);
}

std::string avr_image(std::uint32_t place, const std::string& body) {
    const avr::Program program = avr::assemble(fmt::format(R"(
        jmp     start
        .org    0x100
start:  ldi     r16, 0xFF
        out     SPL, r16
        ldi     r16, 0x40
        out     SPH, r16
        call    guilty
last:   rjmp    last
        .org    {:#x}
guilty: nop
{}
)",
                                                           place, body),
                                               {"source", &avr::atmega1284p()});
    std::map<std::string, std::uint32_t> labels;
    for (const char* name : {"start", "last", "guilty"})
        labels[name] = program.symbols.at(name);
    return tests::avr_elf(program.bytes, labels);
}

/// A line of `text` states `what`, at a place in guilty that is near its beginning.
void check_named(const std::string& text, const std::string& what, std::uint32_t place) {
    INFO(what << " near " << fmt::format("{:#x}", place) << "\n" << text);
    const std::size_t at = text.find(what);
    REQUIRE(at != std::string::npos);
    const std::string line = text.substr(at, text.find('\n', at) - at);
    std::smatch found;
    REQUIRE(std::regex_search(line, found, std::regex("pc 0x([0-9a-f]+) in guilty")));
    const auto pc = static_cast<std::uint32_t>(std::stoul(found[1], nullptr, 16));
    CHECK(pc >= place);
    CHECK(pc <= place + 0x40);
}

struct Kind {
    const char* body;
    const char* said;
    const char* reset;  ///< cause in the list of resets, or null
};

const Kind kDspicKinds[] = {
    {"        .pword 0x3fffff\n", "crashed into a reset (IOPUWR)", "reset: IOPUWR"},
    {"        mov [w9], w2\n", "crashed into a reset (IOPUWR)", "reset: IOPUWR"},  // never written
    {"again:  rcall again\n", "took the StackError trap once", nullptr},
    {"        clr w3\n        mov #7, w2\n        repeat #17\n        div.u w2, w3\n        nop\n        "
     "return\n",
     "took the MathError trap once", nullptr},
    {"        mov #0x0901, w1\n        mov [w1], w2\n        nop\n        return\n",
     "took the AddressError trap once", nullptr},
    {"        mov #0x4001, w2\n        mov w2, NVMCON\n        bset NVMCON, #15\n        nop\n        nop\n  "
     "      return\n",
     "set NVMCON<WR> without the unlock sequence", nullptr},
};

const Kind kAvrKinds[] = {
    {"        .word 0x0001\n        ret\n", "undefined word 0x0001 executed as NOP", nullptr},
    {"again:  rcall again\n", "the stack has grown below the RAM", nullptr},
    {"        lds r16, 0x5000\n        ret\n", "read of data address 0x5000, past the RAM", nullptr},
    {"        ldi r16, 1\n        out 0x37, r16\n        spm\n        ret\n",
     "SPM writes nothing: it is outside the boot section", nullptr},
    {"        ldi r16, 0x18\n        sts 0x60, r16\n        ldi r16, 0x08\n        sts 0x60, r16\nhere:   "
     "rjmp here\n",
     "was reset by the watchdog", "reset: watchdog"},
};

}  // namespace

TEST_CASE("a dsPIC's firmware that goes wrong is named with place and function") {
    RandomStream random(Catch::rngSeed(), "crashes");
    for (const auto& [board, device] :
         {std::pair{"pic", &dspic::dspic30f6014a()}, {"rab", &dspic::dspic33fj256gp710()}})
        for (const Kind& kind : kDspicKinds) {
            const std::uint32_t place = 0x1000 + 2 * static_cast<std::uint32_t>(random.next() % 0x8000);
            const tests::ImageFile image("crash", dspic_image(*device, place, kind.body));
            const auto result =
                run_puckloop(fmt::format("exec --board {} {} --seconds 0.02 --strict", board, image.path));
            INFO(board);
            CHECK(result.status == 1);
            check_named(result.output, kind.said, place);
            if (kind.reset) CHECK(result.output.find(kind.reset) != std::string::npos);
        }
}

TEST_CASE("a dsPIC that jumps into erased flash is named with where it came in") {
    RandomStream random(Catch::rngSeed(), "erased");
    for (const auto& [board, device] :
         {std::pair{"pic", &dspic::dspic30f6014a()}, {"rab", &dspic::dspic33fj256gp710()}}) {
        const std::uint32_t place = 0x1000 + 2 * static_cast<std::uint32_t>(random.next() % 0x1000);
        const std::uint32_t target = 0x4000 + 2 * static_cast<std::uint32_t>(random.next() % 0x2000);
        const tests::ImageFile image(
            "crash",
            dspic_image(*device, place, fmt::format("        mov #{:#x}, w1\n        goto w1\n", target)));
        const auto result = run_puckloop(fmt::format("exec --board {} {} --seconds 0.1", board, image.path));
        INFO(board << "\n" << result.output);
        CHECK(result.output.find(fmt::format("runs into erased flash (pc 0x{:04x}", target)) !=
              std::string::npos);
        CHECK(result.output.find("took the AddressError trap once") != std::string::npos);
    }
}

TEST_CASE("an AVR's firmware that goes wrong is named with place and function") {
    RandomStream random(Catch::rngSeed(), "avr crashes");
    for (const Kind& kind : kAvrKinds) {
        const std::uint32_t place = 0x1000 + 2 * static_cast<std::uint32_t>(random.next() % 0x4000);
        const tests::ImageFile image("crash", avr_image(place, kind.body));
        const auto result = run_puckloop("exec --board tam " + image.path + " --seconds 0.05 --strict");
        CHECK(result.status == 1);
        check_named(result.output, kind.said, place);
        if (kind.reset) CHECK(result.output.find(kind.reset) != std::string::npos);
    }
    const std::uint32_t target = 0x9000 + 2 * static_cast<std::uint32_t>(random.next() % 0x2000);
    const tests::ImageFile image("crash", avr_image(0x1000, fmt::format("        jmp {:#x}\n", target)));
    const auto result = run_puckloop("exec --board tam " + image.path + " --seconds 0.05");
    INFO(result.output);
    CHECK(result.output.find("runs into erased flash") != std::string::npos);
    CHECK(result.output.find(fmt::format("pc 0x{:05x}", target)) != std::string::npos);
    CHECK(result.output.find("the program starts over at 0 without a reset") != std::string::npos);
}

TEST_CASE("where a compiler noted lines, a crash is named with its line") {
    const std::string path = std::string(PUCKLOOP_FIRMWARE) + "/epuck/epuck.elf";
    std::string bytes = image::read_image_file(path);
    const image::Image original = image::parse_image(bytes, path);
    const std::uint32_t main = original.find_code("main").value();
    std::string code;  // as in the file: four bytes a word, the highest 0
    constexpr std::uint32_t kWords = 12;
    for (std::uint32_t at = main; at < main + 2 * kWords; at += 2)
        for (int i = 0; i < 4; ++i)
            code += static_cast<char>(original.program.at(at) >> 8 * i & 0xFF);
    const std::size_t at = bytes.find(code);
    REQUIRE(at != std::string::npos);
    REQUIRE(bytes.find(code, at + 1) == std::string::npos);
    bytes.replace(at, 3, "\x11\x11\x3f", 3);  // illegal
    const tests::ImageFile image("crash", bytes);
    const auto result = run_puckloop("exec --board pic " + image.path + " --seconds 0.2");
    INFO(result.output);
    const std::string place =
        fmt::format("pc 0x{:04x} in _main ({})", main, image::source_lines(path).at(main));
    CHECK(result.output.find("crashed into a reset (IOPUWR)") != std::string::npos);
    CHECK(result.output.find("first at " + place) != std::string::npos);
    CHECK(place.find("main.c:") != std::string::npos);
}

TEST_CASE("a crash within a run is in its report, with place and function") {
    RandomStream random(Catch::rngSeed(), "crashes in runs");
    const std::uint32_t place = 0x1000 + 2 * static_cast<std::uint32_t>(random.next() % 0x4000);
    const std::filesystem::path folder = tests::scratch_path("crash_run");
    const auto check_run = [&](const std::string& scenario, const std::string& node,
                               const std::string& content, const Kind& kind) {
        const tests::ImageFile image("crash", content);
        const auto result =
            run_puckloop(fmt::format("run {}/{} --firmware {}={} --duration 0.3 --in-process --out {}",
                                     PUCKLOOP_SCENARIOS, scenario, node, image.path, folder.string()));
        std::ostringstream report;
        report << std::ifstream(folder / "report.json").rdbuf();
        std::filesystem::remove_all(folder);
        INFO(scenario);
        check_named(result.output, kind.said, place);  // what is printed
        check_named(report.str(), kind.said, place);
    };
    for (const Kind& kind : {kDspicKinds[0], kDspicKinds[3]})
        check_run("hello.toml", "robot0.pic", dspic_image(dspic::dspic30f6014a(), place, kind.body), kind);
    check_run("rab_pair.toml", "leader.rab",
              dspic_image(dspic::dspic33fj256gp710(), place, kDspicKinds[4].body), kDspicKinds[4]);
#ifdef PUCKLOOP_TAM_IMAGE  // the other seventeen run it
    check_run("tams18.toml", "tam0", avr_image(place, kAvrKinds[2].body), kAvrKinds[2]);
#endif
}
